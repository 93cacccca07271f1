//! Starts from where time marching leads: a motion may attract nearly all others, and yet be hardly met by Newton's method from random
//! series, as of motions that strike a stop many times in several periods of the force.

use crate::formulation::harmonics::{Transform, evaluate, series_from_coefficients, width};
use crate::formulation::state::State;
use crate::marching::{Marching, MarchingSettings};
use crate::structure::Model;
use num_complex::Complex64;

/// Steps in a period of the force: enough to come near a motion.
const STEPS: usize = 100;

/// Periods of the force over the inverse of the tracked mode's damping ratio: so many leave 2 % of what decays with that.
const PERIODS: f64 = 0.6;

/// Fewest and most of them.
const COUNT: (f64, f64) = (30.0, 300.0);

/// What a start may take, in steps times dofs squared.
const AFFORDED: f64 = 4e5;

/// The harmonics of what a motion has become after many periods, in modal coordinates; arguments as long as nothing touches. None where
/// that takes too long, or marching fails.
pub(super) fn settled(model: &Model, start: &State, (tracked, harmonics): (usize, usize)) -> Option<State> {
    let (m, n) = (model.forcing().harmonic, model.size());
    let settings = MarchingSettings { min_steps_per_period: Some(STEPS * m), ..MarchingSettings::default() };
    let mut marching = Marching::new(model, &settings, start.forcing, start.omega).ok()?;
    let (natural, decay) = model.resonance(tracked);
    let ratio = decay / natural;
    let periods = ((PERIODS / ratio).clamp(COUNT.0, COUNT.1) / m as f64).ceil() as usize;
    let steps = marching.steps_per_period();
    if (steps * periods) as f64 * (n * n) as f64 > AFFORDED || steps < 4 * harmonics {
        return None;
    }
    let at_rest = |of: usize| {
        let values: Vec<f64> = start.modal.chunks(width(start.harmonics)).map(|q| evaluate(q, 0.0)[of]).collect();
        model.modes().shapes.mul_vec(&values)
    };
    let velocities: Vec<f64> = at_rest(1).into_iter().map(|x| start.omega * x).collect();
    marching.set_state(&at_rest(0), &velocities).ok()?;
    (0..periods).try_for_each(|_| marching.period().map(|_| ())).ok()?;
    let mut samples = vec![vec![0.0; steps]; n];
    for i in 0..steps {
        samples.iter_mut().zip(marching.modal()).for_each(|(samples, y)| samples[i] = *y);
        marching.step().ok()?;
    }
    let mut transform = Transform::new(harmonics, steps);
    let (none, mut unused) = (vec![0.0; steps], vec![Complex64::default(); harmonics + 1]);
    let mut modal = vec![0.0; n * width(harmonics)];
    for (samples, series) in samples.iter().zip(modal.chunks_mut(width(harmonics))) {
        let mut coefficients = unused.clone();
        transform.analyse(samples, &none, &mut coefficients, &mut unused);
        series_from_coefficients(&coefficients, series);
    }
    let is_finite = modal.iter().all(|q| q.is_finite());
    is_finite.then_some(State { harmonics, modal, arguments: Vec::new(), ..*start })
}
