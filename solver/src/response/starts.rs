//! Many starts: forced responses that Newton's method meets from random motions of random frequency, from free motions that such
//! lead to, and by homotopy from these. They are not looked for where anything predicts them, and find what nothing computed is
//! connected to.

use crate::curve::least_norm::{ROUGH, converge, nearest};
use crate::curve::problem::Failure;
use crate::formulation::displacement::DisplacementForm;
use crate::formulation::harmonics::width;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError};
use crate::response::forced::Forced;
use crate::response::homotopy;
use crate::response::motions::{driven, freed, motion};
use crate::response::seeds::Landing;
use crate::response::settled::settled;
use crate::settings::{Effort, HarmonicSettings, Settings};
use crate::structure::Model;
use crate::structure::laws::Law;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Starts of a batch.
pub const BATCH: usize = 16;

/// Most starts of a run, of a small model.
const MOST: f64 = 16384.0;

/// Starts of a run, times the square of the number of unknowns of each: what larger models can afford. Of sub-harmonic motion,
/// which has as many more shapes as it has periods of the forcing, so many times as many.
const AFFORDED: f64 = 3.2e7;

/// Harmonics with which a start is tried first: most fail, and cost less so.
const COARSE: usize = 5;

/// Most dofs of a structure all of which are unknown in a first try.
const FEW_DOFS: usize = 16;

/// Forcing of a rung over that of the one below.
const RUNG: f64 = 1.125;

/// Rungs above the forcing of a level: up to about twice as much.
const RUNGS: usize = 6;

/// Share of free motions that are tried with their own period.
const ORDINARY: f64 = 2.0 / 3.0;

/// Others are tried as motions of up to so many times their period.
const ORDERS: usize = 4;

/// Batches of random starts for each one of homotopies, which take some ten times as long.
const HOMOTOPIES: usize = 32;

/// One start in so many batches is marched until it comes near what attracts it.
const MARCHED: usize = 4;

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
    /// How its starts lead to responses.
    #[serde(default, skip_serializing_if = "StartWay::is_direct")]
    pub way: StartWay,
}

impl StartPlace {
    /// A batch of random starts from which nothing was traced yet.
    pub fn random(batch: usize) -> Self {
        Self { batch, round: 0, way: StartWay::Direct }
    }

    /// A batch of homotopies from which nothing was traced yet.
    pub fn homotopy(batch: usize) -> Self {
        Self { batch, round: 0, way: StartWay::Homotopy }
    }

    /// The task that its branches start from.
    #[must_use]
    pub fn landing(self) -> Self {
        Self { round: 0, ..self }
    }
}

/// How random starts lead to forced responses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StartWay {
    /// By Newton's method, which takes the nearest one.
    #[default]
    Direct,
    /// From a free motion that a force on its fundamental drives, which gives way to that on harmonic m.
    Homotopy,
}

impl StartWay {
    fn is_direct(&self) -> bool {
        *self == Self::Direct
    }
}

/// Number of batches of a run: as many as are asked for, or fewer for larger models, whose starts take longer.
pub fn batches(model: &Model, settings: &Settings) -> usize {
    let series = model.size() + model.elements().iter().map(|element| element.channels.len()).sum::<usize>();
    let unknowns = (series * width(few(model, settings))) as f64;
    let starts = (AFFORDED * model.forcing().harmonic as f64 / (unknowns * unknowns)).min(MOST);
    let effort = settings.search.effort;
    match settings.search.starts {
        Some(starts) if effort != Effort::None => starts.div_ceil(BATCH),
        _ => effort.starts() * (starts / BATCH as f64).ceil() as usize,
    }
}

/// How many of so many batches are those of level `index` of `levels`, from 0: evenly spread.
pub fn share(batches: usize, index: usize, levels: usize) -> usize {
    batches * (index + 1) / levels - batches * index / levels
}

/// The batches of homotopies of a level with so many batches of random starts: of motions that last several periods of the force,
/// where nothing else leads to any.
pub fn homotopies(model: &Model, batches: usize) -> impl Iterator<Item = StartPlace> {
    let count = if model.forcing().harmonic > 1 { batches.div_ceil(HOMOTOPIES) } else { 0 };
    (0..count).map(StartPlace::homotopy)
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
    let (model, settings) = (forced.model(), *forced.settings());
    let truncation = HarmonicSettings { count: few(model, &settings), ..settings.harmonics };
    let tracked = settings.tracked(model);
    let scales = Scales::new(model, tracked);
    // Receptances have a pole wherever a harmonic meets a resonance, which no step gets past: the more the lower ω is.
    if suits_all_dofs(model) {
        let all = |unknown| DisplacementForm::of_all_dofs(model, truncation, tracked, unknown, scales);
        if let Ok(mut tries) = Tries::new(forced.forcing(), all) {
            return tries.land(forced, place);
        }
    }
    let form = |unknown| F::build(model, truncation, tracked, unknown, scales);
    // What can be built with all harmonics can be with few.
    Tries::new(forced.forcing(), form).map_err(|_| Failure::Singular)?.land(forced, place)
}

/// Whether motions of all dofs at once are quickly computed, and contact pressures need not be told apart.
fn suits_all_dofs(model: &Model) -> bool {
    model.size() <= FEW_DOFS && model.elements().iter().all(|element| element.law.rigid().is_none())
}

/// Balances of few harmonics, in whatever form.
struct Tries<C, B> {
    /// Makes them.
    form: B,
    /// Of forced responses: at the forcing of the level, and at ever larger ones.
    forced: Vec<C>,
    /// Of free motions.
    free: C,
    /// Modal amplitudes at which the structure becomes nonlinear, see [`Scales::nonlinear_amplitudes`].
    sizes: Vec<f64>,
}

impl<'m, C: Formulation<'m>, B: Fn(Unknown) -> Result<C, FormulationError>> Tries<C, B> {
    fn new(forcing: f64, form: B) -> Result<Self, FormulationError> {
        let rungs = (0..=RUNGS).map(|rung| Unknown::Frequency { forcing: forcing * RUNG.powi(rung as i32) });
        let (forced, free) = (rungs.map(&form).collect::<Result<_, _>>()?, form(Unknown::Mode { damped: true })?);
        let sizes = free.scales().nonlinear_amplitudes(free.system().model);
        Ok(Self { form, forced, free, sizes })
    }

    fn land<F: Formulation<'m>>(
        &mut self,
        forced: &mut Forced<'m, F>,
        place: &StartPlace,
    ) -> Result<Vec<Landing>, Failure> {
        let mut random = ChaCha8Rng::seed_from_u64(forced.forcing().to_bits());
        random.set_stream(place.batch as u64);
        let mut landings = Vec::new();
        let mut failure = Failure::Diverged;
        for number in 0..BATCH {
            if forced.interrupt().is_set() {
                break;
            }
            let is_marched =
                number + 1 == BATCH && place.batch.is_multiple_of(MARCHED) && suits_all_dofs(forced.model());
            let landed = match place.way {
                StartWay::Direct if is_marched => self.by_marching(&mut random, forced),
                StartWay::Direct => self.directly(&mut random, number, forced),
                StartWay::Homotopy => self.by_homotopy(&mut random, forced),
            };
            match landed {
                Ok(state) if is_within(forced, &state) => landings.push(Landing { state, distance: 0.0 }),
                Ok(_) => {}
                Err(reason) => failure = reason,
            }
        }
        if landings.is_empty() { Err(failure) } else { Ok(landings) }
    }

    /// The response nearest to a random motion, or to the free motion that this leads to.
    fn directly<F: Formulation<'m>>(
        &mut self,
        random: &mut ChaCha8Rng,
        number: usize,
        forced: &mut Forced<'m, F>,
    ) -> Result<State, Failure> {
        let (model, forcing) = (forced.model(), forced.forcing());
        let mut state = motion(random, forced, &self.forced[0], &self.sizes);
        if number % 2 == 1 {
            let order = if random.gen_bool(ORDINARY) { 1 } else { random.gen_range(2..=ORDERS) };
            let quick = State { omega: state.omega * order as f64, ..state.clone() };
            let free = freed(&mut self.free, &quick, forced.settings().tracked(forced.model()))
                .map(|free| State { decay: 0.0, forcing, ..free }.repeated(order, state.harmonics));
            state = free.unwrap_or(state).shifted(random.gen_range(0.0..TAU));
        }
        // Sub-harmonic motion is much of it that and the ordinary response to the forcing.
        if number % 4 >= 2 && model.forcing().harmonic > 1 {
            state = driven(&self.forced[0], &state).unwrap_or(state);
        }
        let rung = if number % 8 >= 6 { random.gen_range(1..=RUNGS) } else { 0 };
        self.refined(forced, rung, &state)
    }

    /// The response that a random motion comes near to by itself.
    fn by_marching<F: Formulation<'m>>(
        &mut self,
        random: &mut ChaCha8Rng,
        forced: &mut Forced<'m, F>,
    ) -> Result<State, Failure> {
        let (model, settings) = (forced.model(), *forced.settings());
        let start = motion(random, forced, &self.forced[0], &self.sizes);
        let near = settled(model, &start, (settings.tracked(model), settings.harmonics.count));
        let near = near.ok_or(Failure::Diverged)?;
        let arguments = forced.modal().open_arguments(&near.modal);
        converged(forced, &State { arguments, ..near })
    }

    /// The response that the free motion which a random one leads to becomes as the force on its fundamental gives way.
    fn by_homotopy<F: Formulation<'m>>(
        &mut self,
        random: &mut ChaCha8Rng,
        forced: &mut Forced<'m, F>,
    ) -> Result<State, Failure> {
        let state = motion(random, forced, &self.forced[0], &self.sizes);
        let phase = random.gen_range(0.0..TAU);
        let free = freed(&mut self.free, &state, forced.settings().tracked(forced.model())).ok_or(Failure::Diverged)?;
        let rough = homotopy::follow(&self.form, &mut self.free, &free, forced.forcing(), phase)?;
        self.refined(forced, 0, &rough)
    }

    /// The response that a start leads to, first with few harmonics, and from a rung of larger forcing down: what is hard to
    /// meet where it is born is large further up.
    fn refined<F: Formulation<'m>>(
        &mut self,
        forced: &mut Forced<'m, F>,
        rung: usize,
        start: &State,
    ) -> Result<State, Failure> {
        let mut y = self.forced[rung].encode(start);
        nearest(&mut self.forced[rung], &mut y, ROUGH, STEPS[0])?;
        for form in self.forced[..rung].iter_mut().rev() {
            nearest(form, &mut y, ROUGH, STEPS[1])?;
        }
        let rough = self.forced[0].decode(&y).map_err(|_| Failure::Singular)?;
        let rough = rough.with_harmonics(forced.settings().harmonics.count);
        if !is_within(forced, &rough) {
            return Err(Failure::Diverged);
        }
        converged(forced, &rough)
    }
}

/// The response near a motion of all harmonics.
fn converged<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, rough: &State) -> Result<State, Failure> {
    let newton = forced.settings().continuation.newton;
    let problem = forced.problem();
    let mut y = problem.encode(rough);
    converge(problem, &mut y, STEPS[1], &newton)?;
    problem.decode(&y).map_err(|_| Failure::Singular)
}

/// Whether a response lies within the range of the study, where what ordinary continuation reaches is known.
fn is_within<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, state: &State) -> bool {
    let (low, high) = forced.reach().frequency;
    (low..=high).contains(&state.omega) && forced.contains(state)
}
