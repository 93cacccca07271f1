//! Many starts: forced responses that Newton's method meets from random motions of random frequency, and from free motions that
//! such lead to. They are not looked for where anything predicts them, and find what nothing computed is connected to.

use crate::curve::least_norm::{ROUGH, converge, nearest};
use crate::curve::problem::Failure;
use crate::formulation::Formulation;
use crate::formulation::harmonics::width;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::response::forced::Forced;
use crate::response::seeds::Landing;
use crate::settings::{HarmonicSettings, Settings};
use crate::structure::Model;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Starts of a batch.
pub const BATCH: usize = 16;

/// Most starts of a run, of a small model.
const MOST: f64 = 8192.0;

/// Starts of a run, times the square of the number of unknowns of each: what larger models can afford.
const AFFORDED: f64 = 3.2e7;

/// Of random motions, the sizes: between these multiples of the amplitude at which the structure becomes nonlinear.
const SIZES: (f64, f64) = (0.03, 30.0);

/// Harmonics with which a start is tried first: most fail, and cost less so.
const COARSE: usize = 5;

/// Decay rate that free motions are looked for with, of the frequency, where there is next to no damping.
const LEAST_DECAY: f64 = 1e-4;

/// Most steps of least norm with few harmonics, and then with all of them.
const STEPS: [usize; 2] = [40, 20];

/// A batch of random starts at a level. Its numbers depend on the level's forcing amplitude and on these.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartPlace {
    /// Number of the batch within its level, from 0.
    pub batch: usize,
    /// How often branches were traced from it before: as long as one is new there may be more.
    #[serde(default)]
    pub round: usize,
}

/// Number of batches of a run: fewer for larger models, whose starts take longer.
pub fn batches(model: &Model, settings: &Settings) -> usize {
    let series = model.size() + model.elements().iter().map(|element| element.channels.len()).sum::<usize>();
    let unknowns = (series * width(few(model, settings))) as f64;
    let starts = (AFFORDED / (unknowns * unknowns)).min(MOST);
    settings.search.effort.starts() * (starts / BATCH as f64).ceil() as usize
}

/// How many of so many batches are those of level `index` of `levels`, from 0: evenly spread.
pub fn share(batches: usize, index: usize, levels: usize) -> usize {
    batches * (index + 1) / levels - batches * index / levels
}

/// Harmonics of a first try.
fn few(model: &Model, settings: &Settings) -> usize {
    settings.harmonics.count.min(COARSE * model.forcing().harmonic)
}

/// The forced responses that a batch of starts leads to, each at a frequency of its own, within the bounds of the study.
///
/// # Errors
/// If none does: why the last one did not.
pub fn land<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, place: &StartPlace) -> Result<Vec<Landing>, Failure> {
    let (model, settings, forcing) = (forced.model(), *forced.settings(), forced.forcing());
    let truncation = HarmonicSettings { count: few(model, &settings), ..settings.harmonics };
    let scales = Scales::new(model, settings.tracked());
    let unknown = Unknown::Frequency { forcing };
    // What can be built with all harmonics can be with few.
    let build =
        |unknown| F::build(model, truncation, settings.tracked(), unknown, scales).map_err(|_| Failure::Singular);
    let mut coarse = build(unknown)?;
    let mut free = build(Unknown::Mode { damped: true })?;
    let mut random = ChaCha8Rng::seed_from_u64(forcing.to_bits());
    random.set_stream(place.batch as u64);
    let mut landings = Vec::new();
    let mut failure = Failure::Diverged;
    for number in 0..BATCH {
        let mut state = motion(&mut random, forced, &coarse);
        if number % 2 == 1 {
            state = freed(&mut free, &state).map_or(state, |free| State { decay: 0.0, forcing, ..free });
            state = state.shifted(random.gen_range(0.0..TAU));
        }
        match refined(forced, &mut coarse, &state) {
            Ok(state) if is_within(forced, &state) => landings.push(Landing { state, distance: 0.0 }),
            Ok(_) => {}
            Err(reason) => failure = reason,
        }
    }
    if landings.is_empty() { Err(failure) } else { Ok(landings) }
}

/// A random motion: in every mode as much energy as in any other on average, harmonics falling with the square of their number.
fn motion<'m, F: Formulation<'m>>(random: &mut ChaCha8Rng, forced: &Forced<'m, F>, coarse: &F) -> State {
    let (model, harmonics) = (forced.model(), coarse.harmonics());
    let mut between = |(low, high): (f64, f64)| (low.ln() + random.gen_range(0.0..1.0) * (high / low).ln()).exp();
    let omega = between(forced.reach().frequency);
    let size = between(SIZES) * coarse.scales().modal;
    let reference = model.modes().frequencies[forced.settings().tracked()];
    let nc = width(harmonics);
    let mut modal = vec![0.0; model.size() * nc];
    for (series, frequency) in modal.chunks_mut(nc).zip(&model.modes().frequencies) {
        let size = size * (reference / frequency).min(1.0);
        for (i, q) in series.iter_mut().enumerate() {
            let k = i.div_ceil(2).max(1) as f64;
            *q = size / (k * k) * random.sample::<f64, _>(StandardNormal);
        }
    }
    let arguments = coarse.modal().open_arguments(&modal);
    State { harmonics, omega, decay: 0.0, forcing: forced.forcing(), arguments, modal }
}

/// The free motion that a start leads to: responses of light damping are near such motions, of some phase, and of far more of
/// them than there are backbones that begin at linear modes. None where it leads to rest.
fn freed<'m, F: Formulation<'m>>(free: &mut F, start: &State) -> Option<State> {
    let model = free.system().model;
    let (damping, frequency) = (model.damping().diagonal(0), model.modes().frequencies[0]);
    // Steps change a parameter by a share of itself, and never one that is zero.
    let decay = start.omega * (0.5 * damping / frequency).max(LEAST_DECAY);
    let mut y = free.encode(&State { decay, forcing: 0.0, ..start.clone() });
    nearest(free, &mut y, ROUGH, STEPS[0]).ok()?;
    let state = free.decode(&y).ok()?;
    let size = state.modal.iter().map(|q| q * q).sum::<f64>().sqrt();
    (size > SIZES.0 * free.scales().modal).then_some(state)
}

/// Whether a response lies within the range of the study, where what ordinary continuation reaches is known.
fn is_within<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, state: &State) -> bool {
    let (low, high) = forced.reach().frequency;
    (low..=high).contains(&state.omega) && forced.contains(state)
}

/// The response that a start leads to, first with few harmonics.
fn refined<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    coarse: &mut F,
    start: &State,
) -> Result<State, Failure> {
    let mut y = coarse.encode(start);
    nearest(coarse, &mut y, ROUGH, STEPS[0])?;
    let rough = coarse.decode(&y).map_err(|_| Failure::Singular)?.with_harmonics(forced.settings().harmonics.count);
    if !is_within(forced, &rough) {
        return Err(Failure::Diverged);
    }
    let newton = forced.settings().continuation.newton;
    let problem = forced.problem();
    let mut y = problem.encode(&rough);
    converge(problem, &mut y, STEPS[1], &newton)?;
    problem.decode(&y).map_err(|_| Failure::Singular)
}
