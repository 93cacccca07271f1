//! Free motions of the damped linear structure, (λ² I + λ Ĉ + Ω²) y = 0 in modal coordinates, and which of its modes they are of.

use super::model::{DampedMode, Damping, Modes};
use crate::linalg::{LinalgError, Matrix, eigen};
use num_complex::Complex64;

/// Share of a pole that is rounding.
const ROUNDING: f64 = 1e-13;

/// Share of the imaginary part of a pole below which it is one of a motion that does not oscillate.
const OSCILLATES: f64 = 1e-9;

/// Modes that have this share of what the one has that takes most part in a motion take part in it as much: the lowest of them counts.
const AS_MUCH: f64 = 0.95;

/// Of mode `mode` alone: nothing couples it.
fn alone(mode: usize, frequency: f64, rate: f64, size: usize) -> Option<DampedMode> {
    let ratio = rate / (2.0 * frequency);
    let (omega, decay) = (frequency * (1.0 - ratio * ratio).max(0.0).sqrt(), ratio * frequency);
    let mut shape = vec![Complex64::default(); size];
    shape[mode] = -Complex64::i();
    (omega > 0.0).then_some(DampedMode { omega, decay, shape })
}

/// The free motion of every mode, in the order of the modes; `None` of rigid-body modes and of overdamped ones. Where damping couples
/// modes, each motion is of the mode that takes most part in it among those that have none yet; where eigenvalues do not converge, modes are
/// taken for uncoupled.
pub(super) fn damped_modes(modes: &Modes, damping: &Damping) -> Vec<Option<DampedMode>> {
    match damping {
        Damping::Full(matrix) => coupled(modes, matrix).unwrap_or_else(|_| uncoupled(modes, damping)),
        Damping::Modal(_) => uncoupled(modes, damping),
    }
}

fn uncoupled(modes: &Modes, damping: &Damping) -> Vec<Option<DampedMode>> {
    let n = modes.frequencies.len();
    let of_mode = |mode: usize| alone(mode, modes.frequencies[mode], damping.diagonal(mode), n);
    (0..n).map(|mode| of_mode(mode).filter(|_| !modes.is_rigid(mode))).collect()
}

fn coupled(modes: &Modes, damping: &Matrix) -> Result<Vec<Option<DampedMode>>, LinalgError> {
    let frequencies = &modes.frequencies;
    let n = frequencies.len();
    // ẏ = v, with Ω y in the place of y: both parts are of one size.
    let poles = eigen(&Matrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, false) if i == j - n => frequencies[i],
        (false, true) if i - n == j => -frequencies[j],
        (false, false) => -damping[(i - n, j - n)],
        _ => 0.0,
    }))?;
    let oscillating = poles.into_iter().filter(|(pole, _)| pole.im > OSCILLATES * pole.norm());
    let mut motions: Vec<(Complex64, Vec<Complex64>)> =
        oscillating.map(|(pole, vector)| (pole, normalised(vector[n..].to_vec()))).collect();
    let deforming: Vec<usize> = (0..n).filter(|&mode| !modes.is_rigid(mode)).collect();
    let part = |shape: &[Complex64], mode: usize| shape[mode].norm_sqr();
    // Up to rounding, which must not decide.
    let most = |shape: &[Complex64]| {
        let largest = deforming.iter().map(|&mode| part(shape, mode)).fold(0.0, f64::max);
        (largest / (1.0 - AS_MUCH)).round()
    };
    motions.sort_by(|a, b| most(&b.1).total_cmp(&most(&a.1)).then(a.0.im.total_cmp(&b.0.im)));
    let mut found: Vec<Option<DampedMode>> = vec![None; n];
    for (pole, mut shape) in motions {
        let free: Vec<usize> = deforming.iter().copied().filter(|&mode| found[mode].is_none()).collect();
        let largest = free.iter().map(|&mode| part(&shape, mode)).fold(0.0, f64::max);
        let own = free.into_iter().find(|&mode| part(&shape, mode) >= AS_MUCH * largest);
        let Some(own) = own.filter(|_| largest > 0.0) else { continue };
        let factor = -Complex64::i() / shape[own];
        shape.iter_mut().for_each(|y| *y *= factor);
        let decay = if pole.re.abs() > ROUNDING * pole.norm() { -pole.re } else { 0.0 };
        found[own] = Some(DampedMode { omega: pole.im, decay, shape });
    }
    Ok(found)
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
    use crate::structure::Model;

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
        let modes = pair(4.0).damped_modes().to_vec();
        let [Some(first), None] = &modes[..] else { panic!("{modes:?}") };
        assert!(
            (first.decay - 0.046_268_935_308_537_57).abs() < 1e-12
                && (first.omega - 1.225_495_358_513_634_4).abs() < 1e-12
        );
        assert!((first.ratio() - 0.037_728_411_531_627_47).abs() < 1e-12);
        let modes = pair(2.0).damped_modes().to_vec();
        let ratios: Vec<f64> = modes.iter().flatten().map(DampedMode::ratio).collect();
        assert!((ratios[0] - 0.831_166_025_791_306_8).abs() < 1e-12, "{ratios:?}");
        assert!((ratios[1] - 0.056_389_780_962_950_51).abs() < 1e-12, "{ratios:?}");
    }

    #[test]
    fn they_solve_their_equation() {
        for first in [-0.01, 0.0, 0.02, 1.0, 2.0, 4.0] {
            let model = pair(first);
            let modes = model.damped_modes();
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
        let modes = model([0.02, 8.0]).damped_modes().to_vec();
        let [Some(first), None] = &modes[..] else { panic!("{modes:?}") };
        assert!((first.decay - 0.01).abs() < 1e-15 && (first.omega - (1.0f64 - 1e-4).sqrt()).abs() < 1e-14);
    }

    /// What moves the structure without deforming it oscillates at no damping, however much part it takes in a motion.
    #[test]
    fn rigid_body_modes_have_no_motion() {
        let model = Model::builder("dashpot between")
            .mass(Matrix::diagonal(&[1.0, 1.0]))
            .stiffness(Matrix::diagonal(&[1.0, 0.0]))
            .damping_matrix([[2.0, -2.0], [-2.0, 2.0]])
            .force(0, 1.0)
            .build()
            .unwrap();
        let [None, Some(motion)] = model.damped_modes() else { panic!("{:?}", model.damped_modes()) };
        // λ³ + 4 λ² + λ + 2 = 0.
        let pole = Complex64::new(-motion.decay, motion.omega);
        assert!((pole.powu(3) + 4.0 * pole * pole + pole + 2.0).norm() < 1e-12, "{pole}");
    }

    /// Modes one per cent apart which damping couples keep their order.
    #[test]
    fn close_modes_keep_their_order() {
        for coupling in [0.5, 0.9, 0.97] {
            let (delta, damping) = (0.02, [0.01, 0.5 * coupling * 0.02]);
            let model = Model::builder("close modes")
                .mass(Matrix::diagonal(&[1.0, 1.0]))
                .stiffness(Matrix::diagonal(&[1.0, 1.0 + delta]))
                .damping_matrix([[damping[0], damping[1]], [damping[1], damping[0]]])
                .force(0, 1.0)
                .build()
                .unwrap();
            let omegas: Vec<f64> = model.damped_modes().iter().flatten().map(|mode| mode.omega).collect();
            assert!(omegas.len() == 2 && omegas[0] < omegas[1], "{coupling}: {omegas:?}");
        }
    }
}
