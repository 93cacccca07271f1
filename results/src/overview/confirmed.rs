//! Whether isolas are confirmed: by twice the harmonics, or by time marching.

use crate::store::{BranchRow, Stability};
use solver::response::certificate::Doubled;

/// A peak may lie right beside a fold, and both are known as far as they converge.
const EDGE: f64 = 1e-6;

/// Peak and ends of a branch with twice the harmonics, as far as they are its own. They are looked for one by one: of an isola near most of
/// whose points no motion was found they may be of several curves, or of the main branch; of any branch they are where the peak lies beyond
/// the ends.
pub(super) fn doubled(row: &BranchRow) -> Option<Doubled> {
    let doubled = row.certificate.doubled?;
    let is_scattered = row.is_isola() && row.certificate.elsewhere.is_some_and(|change| change.share.is_none());
    let omega = row.omega_at_max * (1.0 + doubled.shift);
    let is_inside = doubled.range.is_none_or(|(low, high)| (low * (1.0 - EDGE)..=high * (1.0 + EDGE)).contains(&omega));
    Some(doubled).filter(|_| !is_scattered && is_inside)
}

/// Whether nothing confirms an isola: no peak like its own is confirmed with twice the harmonics, no motion near it by time marching,
/// and nothing elsewhere on it that is stable or not.
pub fn is_unconfirmed(row: &BranchRow) -> bool {
    let is_unmatched = |stability: &Stability| {
        let peak = stability.peak.as_ref();
        stability.stable == 0.0 && stability.unstable == 0.0 && peak.is_some_and(|peak| peak.verdict == "none")
    };
    row.is_isola() && doubled(row).is_none() && row.stability.as_ref().is_some_and(is_unmatched)
}

/// Whether no peak like that of an isola is confirmed with twice the harmonics, and time marching did not find it or cannot tell. Motions
/// elsewhere on it may be those of a branch nearby.
pub fn is_unmatched(row: &BranchRow) -> bool {
    let is_marched = |stability: &Stability| {
        stability.peak.as_ref().is_some_and(|peak| !["none", "not_comparable"].contains(&peak.verdict.as_str()))
    };
    // The first programs did not look with twice the harmonics.
    let is_lost = doubled(row).is_none() && row.peak_standing.is_some();
    row.is_isola() && is_lost && !row.stability.as_ref().is_some_and(is_marched)
}

/// How many of some isolas are in doubt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Doubts {
    /// All of them.
    all: usize,
    /// Those that are unmatched ([`is_unmatched`]).
    unmatched: usize,
    /// Those that nothing confirms ([`is_unconfirmed`]).
    unconfirmed: usize,
}

impl Doubts {
    /// Those of these isolas.
    pub fn about<'r>(isolas: impl Iterator<Item = &'r BranchRow>) -> Self {
        let mut doubts = Self { all: 0, unmatched: 0, unconfirmed: 0 };
        for row in isolas {
            doubts.all += 1;
            doubts.unmatched += usize::from(is_unmatched(row));
            doubts.unconfirmed += usize::from(is_unconfirmed(row));
        }
        doubts
    }

    /// What is said of it after a sentence about the isolas.
    pub fn sentence(self) -> Option<&'static str> {
        match self.unconfirmed {
            0 if self.unmatched == 0 => None,
            0 if self.unmatched < self.all => Some("Twice the harmonics do not confirm all of these isolas."),
            0 if self.all == 1 => Some("Twice the harmonics do not confirm it."),
            0 => Some("Twice the harmonics confirm none of these isolas."),
            some if self.unmatched > some => Some(
                "Some of these isolas may be artefacts of too few harmonics, and others are not confirmed by twice as many.",
            ),
            some if some < self.all => Some("Some of these isolas may be artefacts of too few harmonics."),
            _ if self.all == 1 => Some("It may be an artefact of too few harmonics."),
            _ => Some("All of these isolas may be artefacts of too few harmonics."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::PeakOrbit;
    use solver::response::certificate::{Certificate, Change, Standing};

    fn row(kind: &str, amplitude_2h: Option<f64>) -> BranchRow {
        let doubled = amplitude_2h.map(|amplitude| Doubled { amplitude, shift: 0.0, range: None });
        let certificate = Certificate { doubled, ..Certificate::default() };
        BranchRow { kind: kind.into(), closed: kind == "isola", certificate, ..BranchRow::default() }
    }

    /// Peak and ends that belong to several curves are no isola.
    #[test]
    fn what_is_scattered_over_curves_confirms_nothing() {
        let found = Doubled { amplitude: 0.9, shift: 0.01, range: Some((1.9, 2.1)) };
        let isola = |found: Doubled, share: Option<f64>| {
            let elsewhere = Some(Change { omega: 2.0, share });
            let certificate = Certificate { doubled: Some(found), elsewhere, ..Certificate::default() };
            BranchRow { certificate, omega_at_max: 2.0, ..row("isola", None) }
        };
        assert_eq!(doubled(&isola(found, Some(0.1))), Some(found));
        assert_eq!(doubled(&isola(found, None)), None);
        assert_eq!(doubled(&isola(Doubled { shift: 0.06, ..found }, Some(0.1))), None);
        assert_eq!(doubled(&BranchRow { kind: "main".into(), ..isola(found, None) }), Some(found));
        let lost = BranchRow { peak_standing: Some(Standing::At), ..isola(found, None) };
        assert!(is_unmatched(&lost));
    }

    #[test]
    fn an_isola_that_nothing_confirms() {
        let marched = |verdict: &str, unstable: f64| {
            let peak = Some(PeakOrbit { verdict: verdict.into(), at: None });
            Some(Stability { is_whole: true, unstable, peak, ..Stability::default() })
        };
        let isola = |amplitude_2h, stability| BranchRow { stability, ..row("isola", amplitude_2h) };
        assert!(is_unconfirmed(&isola(None, marched("none", 0.0))));
        for confirmed in [
            isola(Some(1.0), marched("none", 0.0)),
            isola(None, marched("unstable", 1.0)),
            isola(None, marched("none", 0.1)),
            isola(None, marched("not_comparable", 0.0)),
            isola(None, None),
            BranchRow { kind: "main".into(), ..isola(None, marched("none", 0.0)) },
        ] {
            assert!(!is_unconfirmed(&confirmed), "{confirmed:?}");
        }
        let looked_for = |row: BranchRow| BranchRow { peak_standing: Some(Standing::At), ..row };
        for stability in [None, marched("not_comparable", 0.0), marched("none", 0.0), marched("none", 0.3)] {
            assert!(is_unmatched(&looked_for(isola(None, stability))));
        }
        assert!(!is_unmatched(&isola(None, None)), "nobody looked");
        for matched in [isola(Some(1.0), None), isola(None, marched("unstable", 1.0)), row("main", None)] {
            assert!(!is_unmatched(&looked_for(matched)));
        }
        let artefact = looked_for(isola(None, marched("none", 0.0)));
        let unmatched = looked_for(isola(None, None));
        let confirmed = looked_for(isola(Some(1.0), None));
        let told = |rows: &[&BranchRow]| Doubts::about(rows.iter().copied()).sentence();
        assert_eq!(told(&[&confirmed]), None);
        assert_eq!(told(&[&artefact]), Some("It may be an artefact of too few harmonics."));
        assert_eq!(told(&[&artefact; 2]), Some("All of these isolas may be artefacts of too few harmonics."));
        assert_eq!(told(&[&unmatched]), Some("Twice the harmonics do not confirm it."));
        assert_eq!(told(&[&unmatched; 2]), Some("Twice the harmonics confirm none of these isolas."));
        assert_eq!(told(&[&artefact, &confirmed]), Some("Some of these isolas may be artefacts of too few harmonics."));
        assert!(told(&[&artefact, &unmatched]).unwrap().ends_with("others are not confirmed by twice as many."));
        assert_eq!(told(&[&unmatched, &confirmed]), Some("Twice the harmonics do not confirm all of these isolas."));
    }
}
