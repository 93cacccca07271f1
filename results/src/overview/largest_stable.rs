//! The largest response that was found stable.

use super::level::{Level, highest};
use crate::store::BranchRow;

/// A response of a branch that was found stable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StableResponse<'l> {
    /// Its level.
    pub level: &'l Level,
    /// Its branch.
    pub branch: &'l BranchRow,
    /// Frequency, rad/s.
    pub omega: f64,
    /// Amplitude of the first monitored dof, m.
    pub amplitude: f64,
}

/// The largest one of the branches that are meant.
pub fn largest_stable(levels: &[Level], is_meant: impl Fn(&BranchRow) -> bool) -> Option<StableResponse<'_>> {
    let branches = levels.iter().flat_map(|level| level.branches.iter().map(move |branch| (level, branch)));
    let stable = branches.filter(|(_, branch)| is_meant(branch)).filter_map(|(level, branch)| {
        let (omega, amplitude) = branch.stability.as_ref()?.largest?;
        Some(StableResponse { level, branch, omega, amplitude })
    });
    stable.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude))
}

/// The largest one of all, where that is neither told of isolas nor the largest response itself. `length` and `frequency` write
/// these, of m and rad/s.
pub fn largest_stable_sentence(
    levels: &[Level],
    length: impl Fn(f64) -> String,
    frequency: impl Fn(f64) -> String,
) -> Option<String> {
    let largest = largest_stable(levels, |_| true).filter(|found| !found.branch.is_isola())?;
    let peak = highest(levels.iter().filter_map(Level::peak))?.stability.as_ref();
    if peak.and_then(|stability| stability.peak.as_ref()).is_some_and(|peak| peak.verdict == "stable") {
        return None;
    }
    let (size, at) = (length(largest.amplitude), frequency(largest.omega));
    let on = super::in_words(largest.branch);
    // What was not looked at may be stable as well, and larger.
    let mut branches = levels.iter().flat_map(|level| &level.branches);
    let among = if branches.all(is_whole) { "" } else { ", of the points that were marched" };
    // A marched orbit has no truncation, and may be larger than what has.
    let is_larger = largest.amplitude > largest.branch.amplitude_max;
    let truncated = if is_larger { " (as marched, without truncation)" } else { "" };
    Some(format!(
        "Largest periodic response found stable{among}: {size}{truncated}, on {on} at A = {} and {at}.",
        largest.level.amplitude
    ))
}

/// That open branches on which nothing stays go up farther than the largest response told.
pub fn passed_over_sentence(levels: &[Level], length: impl Fn(f64) -> String) -> Option<String> {
    let told = highest(levels.iter().filter_map(Level::peak))?.amplitude_max;
    let is_larger = |row: &&BranchRow| row.is_passed_over() && row.amplitude_max > told;
    let rows: Vec<&BranchRow> = levels.iter().flat_map(|level| &level.branches).filter(is_larger).collect();
    let largest = highest(rows.iter().copied())?;
    let what = match &rows[..] {
        [_] => "Larger is an open branch, which is",
        _ => "Larger are open branches alone, which are",
    };
    let size = length(largest.amplitude_max);
    Some(format!("{what} unstable wherever time marching could tell: up to {}{size}.", largest.at_least()))
}

/// Whether all of a branch was marched.
fn is_whole(row: &BranchRow) -> bool {
    row.stability.as_ref().is_some_and(|known| known.is_whole && known.sampled.is_none())
}

/// What an engineer can take from it that the largest response is unstable: `None` if it is not known to be. `is_marched_on`: motions
/// that unstable ones turn into are told.
pub fn unstable_peak_sentence(levels: &[Level], is_marched_on: bool) -> Option<String> {
    let peak = highest(levels.iter().filter_map(Level::peak))?.stability.as_ref()?.peak.as_ref()?;
    if peak.verdict != "unstable" {
        return None;
    }
    let mut known = levels.iter().flat_map(|level| &level.branches).filter_map(|branch| branch.stability.as_ref());
    // Runs of earlier programs know where it is stable without knowing the largest.
    let is_any = known.any(|known| known.stable > 0.0 || known.largest.is_some());
    let none = if is_any { "" } else { "No periodic response was found stable. " };
    // Where all of all branches was marched that has been asked for.
    let is_asked = is_marched_on || levels.iter().flat_map(|level| &level.branches).all(is_whole);
    let how = if is_asked { "" } else { "; isola verify RUN marches on from unstable ones" };
    Some(format!(
        "{none}An unstable motion does not last: what does is a stable one, or a motion that is not periodic or has a longer period, which \
         may be as large or larger{how}."
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{PeakOrbit, Stability};

    fn level(amplitude: &str, rows: &[(&str, f64, f64)], peak: &str) -> Level {
        let row = |&(kind, top, stable): &(&str, f64, f64)| BranchRow {
            kind: kind.into(),
            number: 1,
            closed: kind == "isola",
            amplitude_max: top,
            stability: Some(Stability {
                is_whole: true,
                stable: 0.5,
                unstable: 0.5,
                peak: Some(PeakOrbit { verdict: peak.into(), at: None }),
                largest: (stable > 0.0).then_some((7.0, stable)),
                ..Stability::default()
            }),
            ..BranchRow::default()
        };
        Level { amplitude: amplitude.into(), branches: rows.iter().map(row).collect(), ..Level::default() }
    }

    fn told(levels: &[Level]) -> Option<String> {
        largest_stable_sentence(levels, |x| format!("{x} m"), |omega| format!("{omega} rad/s"))
    }

    #[test]
    fn it_is_told_wherever_it_is() {
        let rows = [("main", 2.1, 1.4), ("isola", 21.2, 8.7), ("branched", 20.1, 20.1)];
        let levels = [level("10", &rows[..2], "unstable"), level("14", &rows, "unstable")];
        let expected = "Largest periodic response found stable: 20.1 m, on branched 1 at A = 14 and 7 rad/s.";
        assert_eq!(told(&levels).unwrap(), expected);
        // What was not marched may be stable too.
        let mut sampled = levels.clone();
        sampled[0].branches[0].stability.as_mut().unwrap().sampled = Some(30);
        assert_eq!(told(&sampled).unwrap(), expected.replace("stable:", "stable, of the points that were marched:"));
        // On an isola it is told with these, and where the largest response itself is stable there is no larger one.
        assert_eq!(told(&levels[..1]), None);
        assert_eq!(told(&[level("14", &rows, "stable")]), None);
        let main = told(&[level("14", &[("main", 2.1, 1.4), ("isola", 21.2, 0.0)], "unstable")]).unwrap();
        assert!(main.contains("1.4 m, on the main branch at A = 14"), "{main}");
        assert_eq!(told(&[level("14", &[("isola", 21.2, 0.0)], "unstable")]), None);
        // A marched orbit that is larger than anything computed is no contradiction.
        let main = told(&[level("14", &[("main", 2.1, 2.2)], "unstable")]).unwrap();
        assert!(main.contains("stable: 2.2 m (as marched, without truncation), on the main branch"), "{main}");
    }

    #[test]
    fn what_lasts_where_the_largest_response_does_not() {
        let said = |stable: f64, verdict, is_marched_on| {
            let mut level = level("14", &[("isola", 21.2, stable)], verdict);
            level.branches[0].stability.as_mut().unwrap().is_whole = is_marched_on;
            unstable_peak_sentence(&[level], is_marched_on)
        };
        let expected = "An unstable motion does not last: what does is a stable one, or a motion that is not periodic or has a longer period, \
                        which may be as large or larger";
        let how = "; isola verify RUN marches on from unstable ones.";
        assert_eq!(said(8.0, "unstable", false).unwrap(), format!("{expected}{how}"));
        assert_eq!(said(8.0, "unstable", true).unwrap(), format!("{expected}."));
        // All that can be asked for has been marched, and nothing came of it.
        let whole = level("14", &[("isola", 21.2, 8.0)], "unstable");
        assert_eq!(unstable_peak_sentence(&[whole], false).unwrap(), format!("{expected}."));
        let mut none = level("14", &[("isola", 21.2, 0.0)], "unstable");
        none.branches[0].stability.as_mut().unwrap().stable = 0.0;
        let none = unstable_peak_sentence(&[none], true).unwrap();
        assert_eq!(none, format!("No periodic response was found stable. {expected}."));
        for verdict in ["stable", "marginal", "none", "not_comparable"] {
            assert_eq!(said(8.0, verdict, false), None);
        }
    }
}
