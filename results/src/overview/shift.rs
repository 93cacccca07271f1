//! How the frequency of the largest response goes over the forcing.

use super::in_words;
use super::level::Level;
use solver::response::certificate::Standing;

/// A relative change of a frequency that is not worth numbers.
const NEGLIGIBLE: f64 = 1e-3;

/// How far the peak moves in frequency from one level to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Shift {
    /// Lower forcing amplitude and the next one, as typed.
    pub amplitudes: (String, String),
    /// Frequencies of the points of largest amplitude over all branches, rad/s.
    pub omega: (f64, f64),
    /// The branches that these are of, `None` where both are main, or of one family as far as that is known.
    pub branches: Option<(String, String)>,
}

impl Shift {
    /// By how much the frequency changes, rad/s.
    pub fn size(&self) -> f64 {
        (self.omega.1 - self.omega.0).abs()
    }
}

/// The largest change in frequency of the peak between neighbouring levels of which all is known, and the peak to be one, up or down; `None`
/// if there are no such levels.
pub fn shift(levels: &[Level]) -> Option<Shift> {
    let shifts = levels.windows(2).filter(|pair| pair.iter().all(has_known_peak)).filter_map(|pair| {
        let (a, b) = (pair[0].peak()?, pair[1].peak()?);
        let is_one = a.is_main() && b.is_main() || a.family.is_some() && a.family == b.family;
        Some(Shift {
            amplitudes: (pair[0].amplitude.clone(), pair[1].amplitude.clone()),
            omega: (a.omega_at_max, b.omega_at_max),
            branches: (!is_one).then(|| (in_words(a), in_words(b))),
        })
    });
    shifts.max_by(|a, b| a.size().total_cmp(&b.size()))
}

/// Whether the largest response of a level is known, and no larger one beyond where it is.
fn has_known_peak(level: &Level) -> bool {
    level.is_known() && level.peak().is_none_or(|peak| peak.peak_standing != Some(Standing::AtLeast))
}

/// The same in a sentence, as far as levels of which all is known tell; `frequency` writes one, of rad/s.
pub fn shift_sentence(levels: &[Level], frequency: impl Fn(f64) -> String) -> Option<String> {
    let shift = shift(levels)?;
    let Shift { amplitudes: (from, to), omega: (before, after), branches } = &shift;
    // Where a level is not known to its end the frequency there may be another one.
    let of = if levels.iter().all(has_known_peak) { "" } else { ", of levels that are known to their ends," };
    if shift.size() < NEGLIGIBLE * after {
        let percent = 100.0 * NEGLIGIBLE;
        // Of some of the levels that says nothing.
        return of.is_empty().then(|| {
            format!(
                "From one level to the next the frequency of the largest computed response changes by less than {percent} %."
            )
        });
    }
    let goes = if after > before { "rises" } else { "falls" };
    let (size, at) = (frequency(shift.size()), frequency(*after));
    let how = match branches {
        None => format!("it {goes} by {size}, to {at}"),
        Some((one, other)) => {
            let other = if one == other { format!("{other} there, which may be another one") } else { other.clone() };
            format!("from {one} to {other}, by {size}, to {at}")
        }
    };
    Some(format!("The frequency of the largest computed response{of} changes most from A = {from} to {to}: {how}."))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::BranchRow;

    #[test]
    fn where_it_changes_most() {
        let level = |amplitude: &str, kind: &str, omega| {
            let kind = kind.to_string();
            let row = BranchRow { kind, number: 1, amplitude_max: 1.0, omega_at_max: omega, ..BranchRow::default() };
            let main = BranchRow { kind: "main".into(), number: 1, ..BranchRow::default() };
            Level { amplitude: amplitude.into(), branches: vec![main, row], ..Level::default() }
        };
        let said = |levels: &[Level]| shift_sentence(levels, |omega| format!("{omega} rad/s"));
        let levels = [level("1", "main", 2.0), level("2", "main", 2.25), level("3", "isola", 1.75)];
        let begins = "The frequency of the largest computed response changes most from A = ";
        let expected = format!("{begins}2 to 3: from the main branch to isola 1, by 0.5 rad/s, to 1.75 rad/s.");
        assert_eq!(said(&levels).unwrap(), expected);
        let expected = format!("{begins}1 to 2: it rises by 0.25 rad/s, to 2.25 rad/s.");
        assert_eq!(said(&levels[..2]).unwrap(), expected);
        let same = [level("1", "main", 2.0), level("2", "main", 2.0001)];
        assert!(said(&same).unwrap().ends_with("changes by less than 0.1 %."));
        assert_eq!(said(&levels[..1]), None);
        // What leaves through a bound growing has its largest response beyond.
        let mut levels = levels;
        levels[1].branches[1].peak_standing = Some(Standing::AtLeast);
        assert_eq!(said(&levels), None);
    }
}
