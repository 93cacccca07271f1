//! Which harmonics a force can have at all. A motion that repeats itself several times in the period makes a force that does, and an
//! odd law answers one of odd harmonics with such a force. Summed in whatever way, the other harmonics are rounding. As exact zeros they
//! stay zeros in all that is solved, and a branch of such motions passes the points at which others branch off as if they were not there.

use super::ElementForce;

/// What the harmonics of a motion have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    /// Their largest common divisor; 0 for one that does not move.
    step: usize,
    /// Whether they are odd multiples of it, and the law is odd.
    is_odd: bool,
}

impl Shape {
    /// Of arguments, each a series of `nc` coefficients, of a law that is odd or not.
    pub(super) fn of(arguments: &[f64], nc: usize, is_odd: bool) -> Self {
        let has = |k: usize| {
            let entries = if k == 0 { 0..1 } else { 2 * k - 1..2 * k + 1 };
            arguments.chunks(nc).any(|series| series[entries.clone()].iter().any(|c| *c != 0.0))
        };
        let list: Vec<usize> = (0..=nc / 2).filter(|&k| has(k)).collect();
        let step = list.iter().fold(0, |step, &k| divisor(step, k));
        Self { step, is_odd: is_odd && list.iter().all(|k| step > 0 && k % (2 * step) == step) }
    }

    /// Whether the force has harmonic k.
    fn has(self, k: usize) -> bool {
        match self.step {
            0 => k == 0 && !self.is_odd,
            step if self.is_odd => k % (2 * step) == step,
            step => k.is_multiple_of(step),
        }
    }

    /// A change of harmonic k of the motion changes harmonic j of the force if they are of the same class, j ± k a harmonic of
    /// the derivatives: these have the even multiples where the force has the odd ones.
    fn class(self, k: usize) -> usize {
        let period = if self.is_odd { 2 * self.step } else { self.step };
        if period == 0 { k } else { (k % period).min(period - k % period) }
    }

    /// Leaves of a force and its derivatives what there can be; the arguments have `nc` coefficients each.
    pub(super) fn impose(self, out: &mut ElementForce, nc: usize) {
        if self.step == 1 && !self.is_odd {
            return;
        }
        let harmonic = |entry: usize| entry.div_ceil(2);
        let classes: Vec<usize> = (0..nc).map(|entry| self.class(harmonic(entry))).collect();
        let lacks = (0..nc).filter(|&entry| !self.has(harmonic(entry)));
        for entry in lacks {
            for series in [&mut out.force, &mut out.domega] {
                series[entry..].iter_mut().step_by(nc).for_each(|coefficient| *coefficient = 0.0);
            }
        }
        let stride = out.force.len();
        for (row, class) in out.jacobian.chunks_exact_mut(stride).zip(classes.iter().cycle()) {
            for series in row.chunks_exact_mut(nc) {
                let entries = series.iter_mut().zip(&classes);
                entries.for_each(|(entry, other)| *entry = if other == class { *entry } else { 0.0 });
            }
        }
    }
}

/// Largest common divisor.
fn divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(harmonics: &[usize], is_odd: bool) -> Shape {
        let mut series = [0.0; 25];
        harmonics.iter().for_each(|&k| series[(2 * k).saturating_sub(1)] = 0.3);
        Shape::of(&series, 25, is_odd)
    }

    fn harmonics(shape: Shape) -> Vec<usize> {
        (0..=12).filter(|&k| shape.has(k)).collect()
    }

    #[test]
    fn forces_repeat_themselves_with_the_motion() {
        assert_eq!(harmonics(shape(&[], true)), [] as [usize; 0]);
        assert_eq!(harmonics(shape(&[0], true)), [0]);
        assert_eq!(harmonics(shape(&[1, 5], true)), [1, 3, 5, 7, 9, 11]);
        assert_eq!(harmonics(shape(&[3, 9], true)), [3, 9]);
        assert_eq!(harmonics(shape(&[3, 9], false)), [0, 3, 6, 9, 12]);
        assert_eq!(harmonics(shape(&[0, 3], true)), [0, 3, 6, 9, 12]);
        assert_eq!(harmonics(shape(&[4, 6], true)), [0, 2, 4, 6, 8, 10, 12]);
        assert_eq!(harmonics(shape(&[1, 2], true)).len(), 13);
        let odd = shape(&[1, 3], true);
        let couples = |shape: Shape, j: usize, k: usize| shape.class(j) == shape.class(k);
        assert!(couples(odd, 1, 3) && couples(odd, 2, 0) && !couples(odd, 1, 2) && !couples(odd, 0, 1));
        let third = shape(&[3, 6], false);
        assert!(couples(third, 1, 2) && couples(third, 4, 1) && couples(third, 0, 6) && !couples(third, 0, 1));
        assert!(couples(shape(&[0], true), 3, 3) && !couples(shape(&[], true), 3, 0));
    }
}
