//! Floquet multipliers, and what they say of an orbit.

use crate::linalg::{LinalgError, Matrix, eigenvalues};
use crate::structure::Model;
use serde::{Deserialize, Serialize};

/// Margin of orbits on which the force of every law is smooth: rounding, and what Newton's method leaves.
const SMOOTH: f64 = 1e-6;

/// Least and largest margin of orbits with contacts that open or sliders that slip: such events happen at whole time steps.
/// Multipliers near the unit circle were seen to move with the grid by 1e-4 to 6e-4 in contact, by 4e-4 with sliders.
const ROUGH: (f64, f64) = (1e-4, 1e-3);

/// An imaginary part below this share of the modulus is rounding of a real multiplier.
const REAL: f64 = 1e-7;

/// A Floquet multiplier μ: what a small deviation along its direction is multiplied by in a period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Multiplier {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Multiplier {
    /// |μ|.
    pub fn modulus(&self) -> f64 {
        self.re.hypot(self.im)
    }

    /// Whether it is real: a complex one comes with its conjugate.
    pub fn is_real(&self) -> bool {
        self.im.abs() <= REAL * self.modulus()
    }

    /// |μ| − 1.
    pub fn excess(&self) -> f64 {
        self.modulus() - 1.0
    }

    /// Distance in the complex plane.
    pub fn distance(&self, other: &Self) -> f64 {
        (self.re - other.re).hypot(self.im - other.im)
    }
}

/// Whether an orbit is stable, or why that is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every multiplier is inside the unit circle: small deviations die out. Of an orbit near a solution of the balance, beside a fold,
    /// those of a ten-thousandth of the motion do as well, as far as that could be told.
    Stable,
    /// A multiplier is outside: almost every small deviation grows.
    Unstable,
    /// The largest modulus is 1 within the [`margin`] of the orbit; or it is smaller, but beside a fold, where a push of a
    /// ten-thousandth of the motion leads away.
    Marginal,
    /// The marcher has no periodic orbit near the solution of the balance, or none was found.
    NoOrbitNearby,
    /// The marcher's model of the impact is another one than that of the balance, and it matters here.
    NotComparable,
}

impl Verdict {
    /// What multipliers say; nothing of moduli that are 1 within `margin`.
    pub fn of(multipliers: &[Multiplier], margin: f64) -> Self {
        // What is not a number stays, and is neither below nor above anything.
        let larger = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
        match multipliers.iter().map(Multiplier::modulus).reduce(larger) {
            Some(largest) if largest < 1.0 - margin => Self::Stable,
            Some(largest) if largest > 1.0 + margin => Self::Unstable,
            _ => Self::Marginal,
        }
    }

    /// Whether it follows from multipliers.
    pub fn is_known(self) -> bool {
        matches!(self, Self::Stable | Self::Unstable | Self::Marginal)
    }
}

/// Multipliers of a monodromy matrix, the largest first.
///
/// # Errors
/// If the matrix is not finite, or the iteration does not converge.
pub fn multipliers(monodromy: &Matrix) -> Result<Vec<Multiplier>, LinalgError> {
    let mut found: Vec<Multiplier> =
        eigenvalues(monodromy)?.into_iter().map(|mu| Multiplier { re: mu.re, im: mu.im }).collect();
    // Of a pair, the one above the real axis first.
    found.sort_by(|a, b| b.modulus().total_cmp(&a.modulus()).then(b.im.total_cmp(&a.im)));
    Ok(found)
}

/// Half width of the band of moduli round 1 in which a multiplier of an orbit of frequency `omega` (rad/s) decides nothing.
///
/// Where contacts open or sliders slip it is what the grid of time steps leaves uncertain, but never so much that the linear
/// structure alone, with its 1 − e^{−c_j T/2} of the least damped mode (c_j = 2ξ_jω_j), would be in doubt as long as it is
/// damped at all.
pub fn margin(model: &Model, omega: f64, is_smooth: bool) -> f64 {
    let half_period = std::f64::consts::PI / omega;
    let decay = |j: usize| -(-2.0 * model.resonance(j).1 * half_period).exp_m1();
    let least = (0..model.size()).map(decay).fold(f64::INFINITY, f64::min);
    if is_smooth { SMOOTH } else { (0.5 * least).clamp(ROUGH.0, ROUGH.1) }
}

/// How many multipliers are outside the unit circle, by the way on which they left it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Outside {
    /// Real, above 1.
    pub above: usize,
    /// Real, below −1.
    pub below: usize,
    /// Of complex pairs, both of a pair counted.
    pub paired: usize,
}

impl Outside {
    /// Counts those of a modulus above 1 + `margin`.
    pub fn of(multipliers: &[Multiplier], margin: f64) -> Self {
        let mut outside = Self::default();
        for mu in multipliers.iter().filter(|mu| mu.excess() > margin) {
            let place = match (mu.is_real(), mu.re > 0.0) {
                (false, _) => &mut outside.paired,
                (true, true) => &mut outside.above,
                (true, false) => &mut outside.below,
            };
            *place += 1;
        }
        outside
    }

    /// All of them: the dimension of the unstable manifold.
    pub fn count(&self) -> usize {
        self.above + self.below + self.paired
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multipliers_are_sorted_counted_and_judged() {
        let blocks = [[1.2, 0.0, 0.0, 0.0], [0.0, -1.1, 0.0, 0.0], [0.0, 0.0, 0.6, 0.9], [0.0, 0.0, -0.9, 0.6]];
        let found = multipliers(&Matrix::from_fn(4, 4, |i, j| blocks[i][j])).unwrap();
        assert!(found.is_sorted_by(|a, b| a.modulus() >= b.modulus()));
        assert_eq!(Outside::of(&found, 1e-3), Outside { above: 1, below: 1, paired: 2 });
        assert_eq!(Outside::of(&found, 0.1001), Outside { above: 1, below: 0, paired: 0 });
        assert_eq!(Verdict::of(&found, 1e-3), Verdict::Unstable);
        let at = |re| Verdict::of(&[Multiplier { re, im: 0.0 }], 1e-3);
        assert_eq!([at(-0.9), at(0.9995), at(-1.002)], [Verdict::Stable, Verdict::Marginal, Verdict::Unstable]);
        assert!(multipliers(&Matrix::diagonal(&[f64::NAN])).is_err());
    }

    #[test]
    fn nothing_is_stable_without_multipliers() {
        let good = Multiplier { re: 0.5, im: 0.0 };
        let bad = Multiplier { re: f64::NAN, im: 0.0 };
        assert_eq!(Verdict::of(&[], 1e-3), Verdict::Marginal);
        assert_eq!([&[good, bad], &[bad, good]].map(|list| Verdict::of(list, 1e-3)), [Verdict::Marginal; 2]);
    }
}
