//! Closed-form linear solutions: where branches and backbones start.

use crate::formulation::Formulation;
use crate::formulation::harmonics::{complex, set_complex, width};
use crate::formulation::receptance::Receptance;
use crate::formulation::state::{Parameters, State};
use crate::linalg::LinalgError;
use crate::structure::DampedMode;
use crate::structure::laws::Law;
use num_complex::Complex64;

/// Linear response to the forcing of amplitude `forcing` at response frequency `omega` (rad/s).
///
/// # Errors
/// At an undamped resonance.
pub fn forced_response<'m>(problem: &impl Formulation<'m>, forcing: f64, omega: f64) -> Result<State, LinalgError> {
    let model = problem.model();
    let (n, nc, m) = (model.size(), width(problem.harmonics()), model.forcing().harmonic);
    let mut modal = vec![0.0; n * nc];
    if m <= problem.harmonics() {
        let mut receptance = Receptance::new(model, problem.harmonics(), problem.system().modal.clone(), true);
        let load: Vec<Complex64> = problem.modal().forcing().iter().map(|s| (forcing * s).into()).collect();
        let mut y = vec![Complex64::default(); n];
        receptance.solve_all(Parameters { omega, decay: 0.0, forcing }, m, &load, &mut y)?;
        for (series, y) in modal.chunks_mut(nc).zip(&y) {
            set_complex(series, m, *y);
        }
    }
    let arguments = problem.modal().open_arguments(&modal);
    Ok(State { harmonics: problem.harmonics(), omega, decay: 0.0, forcing, arguments, modal })
}

/// The linear mode `mode` (from 0) with its damping, Re q = 0, just below the first touch (see [`below_first_touch`]). Of one that does
/// not oscillate the frequency is zero.
pub fn mode_motion<'m>(problem: &impl Formulation<'m>, mode: usize) -> State {
    let model = problem.model();
    let nc = width(problem.harmonics());
    let is_damped = problem.unknown().is_damped();
    let damped = model.damped_modes()[mode].as_ref().filter(|_| is_damped);
    let scale = problem.scales().modal;
    let mut modal = vec![0.0; model.size() * nc];
    // X_1 = −i b: motion b sin ωt.
    let (omega, decay) = match damped {
        Some(DampedMode { omega, decay, shape }) => {
            modal.chunks_mut(nc).zip(shape).for_each(|(series, y)| set_complex(series, 1, scale * y));
            (*omega, *decay)
        }
        None => {
            modal[mode * nc + 2] = scale;
            if is_damped { (0.0, 0.5 * model.damping().diagonal(mode)) } else { (model.modes().frequencies[mode], 0.0) }
        }
    };
    let harmonics = problem.harmonics();
    below_first_touch(problem, State { harmonics, omega, decay, forcing: 0.0, arguments: Vec::new(), modal })
}

/// Scales a linear motion (and its forcing) to 99 % of the first touch; where a law acts at any amplitude, to a thousandth
/// of the reference length.
pub fn below_first_touch<'m>(problem: &impl Formulation<'m>, state: State) -> State {
    let nc = width(state.harmonics);
    let largest = state.modal.iter().fold(0.0f64, |m, q| m.max(q.abs()));
    let mut factor = f64::INFINITY;
    for (channel, element) in problem.model().numbered() {
        let series = state.combine(problem.modal().shape(channel).iter().copied());
        let reach: f64 = (1..=nc / 2).map(|k| complex(&series, k).norm()).sum();
        factor = factor.min(match element.law.clearance() {
            Some(gap) if gap > 0.0 => 0.99 * gap / reach,
            _ => 1e-3 * problem.scales().modal / largest,
        });
    }
    if !factor.is_finite() {
        factor = problem.scales().modal / largest;
    }
    times(problem, state, factor)
}

/// A linear motion (and its forcing) so many times as large.
pub fn times<'m>(problem: &impl Formulation<'m>, mut state: State, factor: f64) -> State {
    state.modal.iter_mut().for_each(|q| *q *= factor);
    state.forcing *= factor;
    state.arguments = problem.modal().open_arguments(&state.modal);
    state
}
