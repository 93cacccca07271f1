//! Matrices of studies are compared by their numbers: where these were read from says nothing of them.

use crate::report::Report;
use crate::resolved_study::{Difference, settings};
use protocol::array::Array;
use protocol::model::ModelMessage;

/// Keys of matrices, with what runs have of them.
const MASS: Matrix = ("matrices.mass", |model| &model.mass);
const STIFFNESS: Matrix = ("matrices.stiffness", |model| &model.stiffness);
/// In modal coordinates: it says something of the matrix only where the other two are the same.
const DAMPING: Matrix = ("matrices.damping", |model| &model.damping);

/// Of the largest entry of a matrix, the share up to which entries are the same.
const ALIKE: f64 = 1e-9;

type Matrix = (&'static str, fn(&ModelMessage) -> &Array);

/// Changes between the studies of two runs, without those of matrices with the same numbers, and with those of matrices with others that
/// are given by the same name of a file.
pub(super) fn by_numbers(mut changes: Vec<Difference>, runs: [&Report; 2]) -> Vec<Difference> {
    let [Some(first), Some(other)] = runs.map(|run| run.overview.model.as_ref()) else { return changes };
    let is_same = |(key, of): Matrix| {
        let numbers = |model| of(model).values(key, &of(model).shape).unwrap_or_default();
        of(first).shape == of(other).shape && are_alike(&numbers(first), &numbers(other))
    };
    let damping = (is_same(MASS) && is_same(STIFFNESS)).then_some(DAMPING);
    for matrix in [MASS, STIFFNESS].into_iter().chain(damping) {
        let key = matrix.0;
        let [Some(old), Some(new)] = runs.map(|run| value(run, key)) else { continue };
        if is_same(matrix) {
            changes.retain(|change| change.key != key);
        } else if changes.iter().all(|change| change.key != key) {
            changes.push(Difference { key: key.into(), old, new: format!("{new} with other numbers") });
        }
    }
    changes
}

/// Whether numbers are the same up to what another processor makes of those that are computed, as modal ones are.
fn are_alike(first: &[f64], other: &[f64]) -> bool {
    let largest = first.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    first.len() == other.len() && first.iter().zip(other).all(|(a, b)| (a - b).abs() <= ALIKE * largest)
}

/// What the study of a run gives for a key.
fn value(run: &Report, key: &str) -> Option<String> {
    settings(&run.account.study).into_iter().find(|(known, _)| known == key).map(|(_, value)| value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Study;
    use crate::report::Selection;
    use crate::resolved_study::differences;
    use tempfile::tempdir;

    #[test]
    fn where_numbers_were_read_from_is_no_difference() {
        let dir = tempdir().unwrap();
        let (store, _) = Study::damper().finished(dir.path());
        let report = Report::read(&store, &Selection::NoBranches).unwrap();
        let run = |matrices: &str, change: fn(&mut ModelMessage)| {
            let mut run = report.clone();
            run.account.study = format!("[matrices]\n{matrices}\n");
            change(run.overview.model.as_mut().unwrap());
            run
        };
        let told = |runs: [&Report; 2]| -> Vec<String> {
            let [old, new] = runs.map(|run| run.account.study.as_str());
            by_numbers(differences(old, new), runs).iter().map(ToString::to_string).collect()
        };
        let stiffer = |model: &mut ModelMessage| model.stiffness = Array::new(vec![1, 1], [2.0]);
        let damped = |model: &mut ModelMessage| model.damping = Array::new(vec![1], [0.5]);
        let inline = run("mass = [[1]]\nstiffness = [[1]]", |_| {});
        let file = run("mass = 'M.mtx'\nstiffness = 'K.mtx'", |_| {});
        assert_eq!(told([&inline, &file]), Vec::<String>::new());
        // The same name, and other numbers.
        let edited = run("mass = 'M.mtx'\nstiffness = 'K.mtx'", stiffer);
        assert_eq!(told([&file, &edited]), ["matrices.stiffness: \"K.mtx\" → \"K.mtx\" with other numbers"]);
        assert_eq!(told([&inline, &edited]), ["matrices.stiffness: [[1]] → \"K.mtx\""]);
        // A damping that is given in another way is another one by its key.
        let full = run("mass = [[1]]\nstiffness = [[1]]\ndamping = 'D.mtx'", damped);
        assert_eq!(told([&inline, &full]), ["matrices.damping: not given → \"D.mtx\""]);
        let same = run("mass = [[1]]\nstiffness = [[1]]\ndamping = [[0.5]]", damped);
        assert_eq!(told([&full, &same]), Vec::<String>::new());
    }
}
