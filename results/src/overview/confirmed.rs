//! Whether isolas are confirmed: by twice the harmonics, or by time marching.

use crate::store::{BranchRow, Stability};

/// Whether nothing confirms an isola: no peak like its own was found with twice the harmonics, no motion near it by time marching,
/// and nothing elsewhere on it that is stable or not.
pub fn is_unconfirmed(row: &BranchRow) -> bool {
    let is_unmatched = |stability: &Stability| {
        let peak = stability.peak.as_ref();
        stability.stable == 0.0 && stability.unstable == 0.0 && peak.is_some_and(|peak| peak.verdict == "none")
    };
    row.is_isola() && row.certificate.doubled.is_none() && row.stability.as_ref().is_some_and(is_unmatched)
}

/// Whether no peak like that of an isola was found with twice the harmonics, and time marching did not find it or cannot tell. Motions
/// elsewhere on it may be those of a branch nearby.
pub fn is_unmatched(row: &BranchRow) -> bool {
    let is_marched = |stability: &Stability| {
        stability.peak.as_ref().is_some_and(|peak| !["none", "not_comparable"].contains(&peak.verdict.as_str()))
    };
    // The first programs did not look with twice the harmonics.
    let is_lost = row.certificate.doubled.is_none() && row.peak_standing.is_some();
    row.is_isola() && is_lost && !row.stability.as_ref().is_some_and(is_marched)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::PeakOrbit;
    use solver::response::certificate::{Certificate, Doubled, Standing};

    fn row(kind: &str, amplitude_2h: Option<f64>) -> BranchRow {
        let doubled = amplitude_2h.map(|amplitude| Doubled { amplitude, shift: 0.0, range: None });
        let certificate = Certificate { doubled, ..Certificate::default() };
        BranchRow { kind: kind.into(), closed: kind == "isola", certificate, ..BranchRow::default() }
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
    }
}
