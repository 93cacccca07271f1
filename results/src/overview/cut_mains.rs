//! Main branches that a bound of the frequency cuts off while they rise.

use super::bounds::is_at_bound;
use super::level::{Level, named};

use crate::words::count;
use solver::settings::FrequencySettings;

/// That the largest responses of main branches lie at a bound that was given, beyond which they are not known, in short and in a sentence.
pub fn cut_mains(levels: &[Level], given: FrequencySettings) -> Option<(String, String)> {
    let is_cut = |level: &&Level| {
        level.main().is_some_and(|main| {
            !main.at_least().is_empty()
                && (is_at_bound(main.omega_at_max, given.min) || is_at_bound(main.omega_at_max, given.max))
        })
    };
    let cut: Vec<&Level> = levels.iter().filter(is_cut).collect();
    if cut.is_empty() {
        return None;
    }
    let at = |bound: Option<f64>| {
        cut.iter().any(|level| level.main().is_some_and(|main| is_at_bound(main.omega_at_max, bound)))
    };
    let bounds = match (at(given.min), at(given.max)) {
        (true, true) => "frequency.min or frequency.max",
        (true, false) => "frequency.min",
        (false, _) => "frequency.max",
    };
    let (mains, goes) = match cut.len() {
        1 => ("The main branch", "goes on, where it is"),
        _ => ("Main branches", "go on, where they are"),
    };
    let sentence = format!(
        "{mains} at {} {goes} largest, beyond {bounds}: how far is not known, and larger responses may lie there.",
        named(&cut)
    );
    Some((format!("{} cut by {bounds}", count(cut.len(), "main branch")), sentence))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::BranchRow;
    use solver::response::branch::{BranchKind, Standing};

    #[test]
    fn what_rises_up_to_a_bound_goes_on_beyond() {
        let given = FrequencySettings { min: None, max: Some(1.15) };
        let level = |name: &str, omega_at_max, peak_standing| {
            let kind = BranchKind::Main.name().into();
            let main = BranchRow { kind, omega_at_max, peak_standing: Some(peak_standing), ..BranchRow::default() };
            Level { amplitude: name.into(), branches: vec![main], ..Level::default() }
        };
        let levels = [
            level("1", 1.1, Standing::At),
            level("2", 1.15, Standing::AtLeast),
            level("3", 1.15, Standing::AtLeast),
            level("4", 1.05, Standing::AtLeast),
        ];
        assert_eq!(
            cut_mains(&levels, given).unwrap().1,
            "Main branches at A = 2 and 3 go on, where they are largest, beyond frequency.max: how far is not known, and larger responses may lie \
             there."
        );
        assert!(
            cut_mains(&levels[..2], given)
                .unwrap()
                .1
                .starts_with("The main branch at A = 2 goes on, where it is largest,")
        );
        assert_eq!(cut_mains(&levels, given).unwrap().0, "2 main branches cut by frequency.max");
        assert_eq!(cut_mains(&levels[..1], given), None);
        assert_eq!(cut_mains(&levels, FrequencySettings::default()), None);
    }
}
