//! Free motions of the damped linear structure, (λ² I + λ Ĉ + Ω²) y = 0 in modal coordinates, and which of its modes they are of.

use super::Model;
use crate::linalg::{LinalgError, Matrix, eigen};
use num_complex::Complex64;

/// Share of the imaginary part of a pole below which it is one of a motion that does not oscillate.
const OSCILLATES: f64 = 1e-9;

/// Modes that have this share of what the one has that takes most part in a motion take part in it as much.
const AS_MUCH: f64 = 0.5;

/// A free motion that oscillates while it decays, Re y exp(λt), λ = −decay + i omega.
#[derive(Debug, Clone, PartialEq)]
pub struct DampedMode {
    /// Frequency, rad/s, above zero.
    pub omega: f64,
    /// Decay rate, 1/s; negative where it grows.
    pub decay: f64,
    /// Shape y, n modal amplitudes, the mode's own −i.
    pub shape: Vec<Complex64>,
}

impl DampedMode {
    /// Damping ratio, −Re λ / |λ|.
    pub fn ratio(&self) -> f64 {
        self.decay / self.omega.hypot(self.decay)
    }

    /// Of mode `mode` alone: nothing couples it.
    fn uncoupled(mode: usize, frequency: f64, rate: f64, size: usize) -> Option<Self> {
        let decay = 0.5 * rate;
        let omega = (frequency * frequency - decay * decay).sqrt();
        let mut shape = vec![Complex64::default(); size];
        shape[mode] = -Complex64::i();
        (omega > 0.0).then_some(Self { omega, decay, shape })
    }
}

/// The free motion of every mode, in the order of the modes; `None` of modes that do not oscillate: rigid-body modes and overdamped ones.
/// Where damping couples modes, each motion is of the lowest mode among those that take most part in it and have none yet.
///
/// # Errors
/// If eigenvalues do not converge.
pub fn damped_modes(model: &Model) -> Result<Vec<Option<DampedMode>>, LinalgError> {
    let frequencies = &model.modes().frequencies;
    let n = frequencies.len();
    if let Some(rates) = model.damping().uncoupled() {
        let of_mode = |mode: usize| DampedMode::uncoupled(mode, frequencies[mode], rates[mode], n);
        return Ok((0..n).map(of_mode).collect());
    }
    // ẏ = v, with Ω y in the place of y: both parts are of one size.
    let damping = model.damping();
    let poles = eigen(&Matrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) => 0.0,
        (true, false) if i == j - n => frequencies[i],
        (false, true) if i - n == j => -frequencies[j],
        (false, false) => -damping.entry(i - n, j - n),
        _ => 0.0,
    }))?;
    let oscillating = poles.into_iter().filter(|(pole, _)| pole.im > OSCILLATES * pole.norm());
    let mut motions: Vec<(Complex64, Vec<Complex64>)> =
        oscillating.map(|(pole, vector)| (pole, normalised(vector[n..].to_vec()))).collect();
    let part = |shape: &[Complex64], mode: usize| shape[mode].norm_sqr();
    let most = |shape: &[Complex64]| (0..n).map(|mode| part(shape, mode)).fold(0.0, f64::max);
    // Shapes have length 1: those of which one mode alone has most come first.
    motions.sort_by(|a, b| most(&b.1).total_cmp(&most(&a.1)).then(a.0.im.total_cmp(&b.0.im)));
    let mut modes: Vec<Option<DampedMode>> = vec![None; n];
    for (pole, mut shape) in motions {
        let free: Vec<usize> = (0..n).filter(|&mode| modes[mode].is_none()).collect();
        let largest = free.iter().map(|&mode| part(&shape, mode)).fold(0.0, f64::max);
        let own = free.into_iter().find(|&mode| part(&shape, mode) >= AS_MUCH * largest);
        let Some(own) = own.filter(|_| largest > 0.0) else { continue };
        let factor = -Complex64::i() / shape[own];
        shape.iter_mut().for_each(|y| *y *= factor);
        modes[own] = Some(DampedMode { omega: pole.im, decay: -pole.re, shape });
    }
    Ok(modes)
}

/// The same of length 1.
fn normalised(mut shape: Vec<Complex64>) -> Vec<Complex64> {
    let length = shape.iter().map(|y| y.norm_sqr()).sum::<f64>().sqrt();
    shape.iter_mut().for_each(|y| *y /= length);
    shape
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(first: f64) -> Model {
        Model::builder("a dashpot")
            .mass(Matrix::diagonal(&[1.0, 1.0]))
            .stiffness([[1.5, -0.5], [-0.5, 1.5]])
            .damping_matrix([[first, 0.0], [0.0, 0.05]])
            .force(0, 1.0)
            .build()
            .unwrap()
    }

    /// Residual of (λ² I + λ Ĉ + Ω²) y = 0.
    fn residual(model: &Model, mode: &DampedMode) -> f64 {
        let pole = Complex64::new(-mode.decay, mode.omega);
        let of_row = |j: usize| {
            let square = model.modes().frequencies[j].powi(2);
            ((pole * pole + square) * mode.shape[j] + pole * model.damping().row_times(j, &mode.shape)).norm()
        };
        (0..model.size()).map(of_row).fold(0.0, f64::max)
    }

    /// By numpy: a dashpot that holds one mass leaves a motion of the other, lightly damped.
    #[test]
    fn what_a_dashpot_leaves_oscillates() {
        let modes = damped_modes(&pair(4.0)).unwrap();
        let [Some(first), None] = &modes[..] else { panic!("{modes:?}") };
        assert!(
            (first.decay - 0.046_268_935_308_537_57).abs() < 1e-12
                && (first.omega - 1.225_495_358_513_634_4).abs() < 1e-12
        );
        assert!((first.ratio() - 0.037_728_411_531_627_47).abs() < 1e-12);
        let modes = damped_modes(&pair(2.0)).unwrap();
        let ratios: Vec<f64> = modes.iter().flatten().map(DampedMode::ratio).collect();
        assert!((ratios[0] - 0.831_166_025_791_306_8).abs() < 1e-12, "{ratios:?}");
        assert!((ratios[1] - 0.056_389_780_962_950_51).abs() < 1e-12, "{ratios:?}");
    }

    #[test]
    fn they_solve_their_equation() {
        for first in [-0.01, 0.0, 0.02, 1.0, 2.0, 4.0] {
            let model = pair(first);
            let modes = damped_modes(&model).unwrap();
            for (j, mode) in modes.iter().enumerate().filter_map(|(j, mode)| Some((j, mode.as_ref()?))) {
                assert!(residual(&model, mode) < 1e-9, "{first}, mode {j}: {}", residual(&model, mode));
                assert!((mode.shape[j] + Complex64::i()).norm() < 1e-12);
            }
            assert!(modes.iter().any(Option::is_some));
        }
    }

    /// Damping that couples nothing has the closed form, however it is given.
    #[test]
    fn uncoupled_modes_have_their_closed_form() {
        let model = |damping: [f64; 2]| {
            let [first, other] = damping;
            Model::builder("two masses")
                .mass(Matrix::diagonal(&[1.0, 1.0]))
                .stiffness(Matrix::diagonal(&[1.0, 4.0]))
                .damping_matrix([[first, 0.0], [0.0, other]])
                .force(0, 1.0)
                .build()
                .unwrap()
        };
        let modes = damped_modes(&model([0.02, 8.0])).unwrap();
        let [Some(first), None] = &modes[..] else { panic!("{modes:?}") };
        assert!((first.decay - 0.01).abs() < 1e-15 && (first.omega - (1.0f64 - 1e-4).sqrt()).abs() < 1e-14);
    }
}
