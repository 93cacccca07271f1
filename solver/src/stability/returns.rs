//! Bifurcations that marching comes upon forth and back: next to a fold orbits may follow each other in another order than the points of
//! the branch that they are found from, and what is crossed there is crossed three times.

use super::bifurcation::Bifurcation;

/// Relative distances of frequency and amplitude of what is the same.
const SAME: (f64, f64) = (1e-6, 1e-5);

/// Bifurcations in the order of the arc without those that are crossed back after they were crossed, and these crossings back.
pub(super) fn once_each(found: Vec<Bifurcation>) -> Vec<Bifurcation> {
    let mut kept: Vec<Bifurcation> = Vec::with_capacity(found.len());
    for next in found {
        if kept.last().is_some_and(|last| is_crossed_back(last, &next)) {
            kept.pop();
        } else {
            kept.push(next);
        }
    }
    kept
}

fn is_crossed_back(last: &Bifurcation, next: &Bifurcation) -> bool {
    let [before, after] = last.outside;
    let is_same = |a: f64, b: f64, distance: f64| (a - b).abs() <= distance * a.abs();
    last.kind == next.kind
        && before != after
        && next.outside == [after, before]
        && is_same(last.omega, next.omega, SAME.0)
        && last.amplitudes.iter().zip(&next.amplitudes).all(|(a, b)| is_same(*a, *b, SAME.1))
}

#[cfg(test)]
mod tests {
    use super::super::bifurcation::BifurcationKind::{Fold, NeimarkSacker};
    use super::super::multipliers::Multiplier;
    use super::super::shooting::Orbit;
    use super::*;

    #[test]
    fn what_is_crossed_forth_and_back_is_crossed_once() {
        let at = |kind, omega: f64, outside| Bifurcation {
            kind,
            omega,
            amplitudes: vec![2.0 * omega],
            after: 3,
            multiplier: Multiplier { re: 1.0, im: 0.0 },
            outside,
            width: 0.0,
            orbit: Orbit { omega, forcing: 1.0, steps: 8, state: Vec::new() },
        };
        let (pair, fold) = (|outside| at(NeimarkSacker, 61.1401, outside), |outside| at(Fold, 61.1427, outside));
        let found = vec![pair([2, 0]), fold([0, 1]), fold([1, 0]), pair([0, 2]), pair([2, 0]), fold([0, 1])];
        let kinds: Vec<_> = once_each(found).iter().map(|found| (found.kind, found.outside)).collect();
        assert_eq!(kinds, [(NeimarkSacker, [2, 0]), (Fold, [0, 1])]);
        // Two folds at two places stay two.
        let two = vec![fold([0, 1]), at(Fold, 61.2, [1, 0])];
        assert_eq!(once_each(two).len(), 2);
    }
}
