//! Where main branches turn back, so that they have several responses at one frequency.

use crate::curves::Curve;
use crate::overview::Level;
use crate::summary_table::FrequencyUnit;
use crate::told::range_first_in;
use crate::words::count;
use solver::response::branch::{BranchKind, SpecialKind};

/// Levels that the sentence names.
const NAMED: usize = 3;

/// A level whose main branches turn back.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Folded {
    /// Forcing amplitude, as typed.
    amplitude: String,
    /// Frequencies of the widest piece that runs backwards, rad/s.
    widest: (f64, f64),
    /// How many more pieces do.
    others: usize,
}

/// The levels whose main branches are among these curves and turn back.
pub(super) fn folded(curves: &[Curve], levels: &[Level]) -> Vec<Folded> {
    let of_level = |(index, level): (usize, &Level)| {
        let mains = curves.iter().filter(|curve| curve.level == index && curve.kind == BranchKind::Main.name());
        let mut ranges: Vec<(f64, f64)> = mains.flat_map(backwards).collect();
        ranges.sort_by(|a, b| (b.1 - b.0).total_cmp(&(a.1 - a.0)));
        let (&widest, others) = ranges.split_first()?;
        Some(Folded { amplitude: level.amplitude.clone(), widest, others: others.len() })
    };
    levels.iter().enumerate().filter_map(of_level).collect()
}

/// Frequencies of the pieces of a curve from one fold to the next that run the other way than the whole of it does.
fn backwards(curve: &Curve) -> Vec<(f64, f64)> {
    let omega = &curve.omega.values;
    let folds = curve.special.iter().filter(|special| special.kind == SpecialKind::Fold);
    let folds: Vec<f64> = folds.filter_map(|fold| omega.get(fold.index).copied()).collect();
    let (Some(first), Some(last)) = (omega.first(), omega.last()) else { return Vec::new() };
    let runs_back = |pair: &&[f64]| (pair[1] - pair[0]) * (last - first) < 0.0;
    folds.windows(2).filter(runs_back).map(|pair| (pair[0].min(pair[1]), pair[0].max(pair[1]))).collect()
}

/// Between which frequencies main branches have several responses, in this unit first: a sentence.
pub(super) fn folded_sentence(levels: &[Folded], first: FrequencyUnit) -> Option<String> {
    let told = |folded: &Folded| {
        let range = range_first_in(folded.widest, first);
        let others = match folded.others {
            0 => String::new(),
            others => format!(", and in {}", count(others, "narrower range")),
        };
        format!("at A = {} between {range}{others}", folded.amplitude)
    };
    let named: Vec<String> = levels.iter().take(NAMED).map(told).collect();
    let more = match levels.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!("; and at {}", count(more, "more level")),
    };
    (!named.is_empty()).then(|| {
        format!(
            "The main branch turns back and has several responses, between which the structure may jump, {}{more}.",
            named.join("; ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Study;
    use crate::report::{Report, Selection};
    use crate::store::Reader;

    #[test]
    fn pieces_that_run_backwards() {
        let dir = tempfile::tempdir().unwrap();
        drop(Study::new("duffing", 3, &["0.05"]).finished(dir.path()));
        let report = Report::read(&Reader::open(dir.path()).unwrap(), &Selection::All).unwrap();
        let main = report.branches.iter().find(|branch| branch.kind == "main").unwrap();
        let folds = main.special.iter().filter(|special| special.kind == SpecialKind::Fold);
        let folds: Vec<f64> = folds.map(|fold| main.omega.values[fold.index]).collect();
        let [upper, lower] = folds[..] else { panic!("{folds:?}") };
        let found = folded(&report.branches, &report.overview.levels);
        assert_eq!(found, [Folded { amplitude: "0.05".into(), widest: (lower, upper), others: 0 }]);
        let told = "The main branch turns back and has several responses, between which the structure may jump, at A = 0.05 between ";
        assert!(report.verdict[0].whole().contains(told), "{}", report.verdict[0].whole());
        // Walked the other way the same piece is the one that runs backwards.
        let mut mirrored = main.clone();
        mirrored.omega.values.reverse();
        mirrored.special.iter_mut().for_each(|special| special.index = main.size - 1 - special.index);
        mirrored.special.reverse();
        assert_eq!(backwards(&mirrored), [(lower, upper)]);
    }
}
