//! Many starts: forced responses that Newton's method meets from random motions of random frequency, from free motions that such
//! lead to, and by homotopy from these. They are not looked for where anything predicts them, and find what nothing computed is
//! connected to.

use crate::curve::least_norm::{ROUGH, converge, nearest, of_size};
use crate::curve::problem::Failure;
use crate::formulation::displacement::DisplacementForm;
use crate::formulation::harmonics::{complex, set_complex, width};
use crate::formulation::linear::forced_response;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError};
use crate::response::forced::Forced;
use crate::response::homotopy;
use crate::response::seeds::Landing;
use crate::settings::{Effort, HarmonicSettings, Settings};
use crate::structure::Model;
use crate::structure::laws::Law;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Starts of a batch.
pub const BATCH: usize = 16;

/// Most starts of a run, of a small model.
const MOST: f64 = 16384.0;

/// Starts of a run, times the square of the number of unknowns of each: what larger models can afford. Of sub-harmonic motion,
/// which has as many more shapes as it has periods of the forcing, so many times as many.
const AFFORDED: f64 = 3.2e7;

/// Of random motions, the sizes: between these multiples of the amplitude at which the structure becomes nonlinear in one of its modes,
/// which is drawn: an absorber does so long before what it is fixed to.
const SIZES: (f64, f64) = (0.03, 30.0);

/// The smallest where nothing but rigid contact is nonlinear: what is smaller does not touch.
const SMALLEST_TOUCHING: f64 = 0.3;

/// Harmonics of random motions fall with these powers of their number.
const FALLS: (f64, f64) = (1.0, 4.0);

/// Share of random motions that are their own mirror images half a period later, where such can be responses.
const MIRRORED: f64 = 2.0 / 3.0;

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

/// Decay rate that free motions are looked for with, of the frequency, where there is next to no damping.
const LEAST_DECAY: f64 = 1e-4;

/// Batches of random starts for each one of homotopies, which take some ten times as long.
const HOMOTOPIES: usize = 32;

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

fn is_linear_until_touched(model: &Model) -> bool {
    model.elements().iter().all(|element| element.law.rigid().is_some())
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
            let landed = match place.way {
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
                .map(|free| slowed(&State { decay: 0.0, forcing, ..free }, order));
            state = free.unwrap_or(state).shifted(random.gen_range(0.0..TAU));
        }
        // Sub-harmonic motion is much of it that and the ordinary response to the forcing.
        if number % 4 >= 2 && model.forcing().harmonic > 1 {
            state = driven(&self.forced[0], &state).unwrap_or(state);
        }
        let rung = if number % 8 >= 6 { random.gen_range(1..=RUNGS) } else { 0 };
        self.refined(forced, rung, &state)
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
        let newton = forced.settings().continuation.newton;
        let problem = forced.problem();
        let mut y = problem.encode(&rough);
        converge(problem, &mut y, STEPS[1], &newton)?;
        problem.decode(&y).map_err(|_| Failure::Singular)
    }
}

/// A random motion: in every mode as much energy as in any other on average, harmonics falling as fast as chance has it.
fn motion<'m, F: Formulation<'m>, C: Formulation<'m>>(
    random: &mut ChaCha8Rng,
    forced: &Forced<'m, F>,
    coarse: &C,
    sizes: &[f64],
) -> State {
    let (model, harmonics) = (forced.model(), coarse.harmonics());
    let mut between = |(low, high): (f64, f64)| (low.ln() + random.gen_range(0.0..1.0) * (high / low).ln()).exp();
    let omega = between(forced.reach().frequency);
    let smallest = if is_linear_until_touched(model) { SMALLEST_TOUCHING } else { SIZES.0 };
    let multiple = between((smallest, SIZES.1));
    let nonlinear = if let [only] = sizes { *only } else { sizes[random.gen_range(0..sizes.len())] };
    let size = multiple * nonlinear;
    let fall = random.gen_range(FALLS.0..FALLS.1);
    // Newton's method does not leave the motions that are their own mirror images: half the unknowns, and most isolas are of them.
    let has_mirrored = coarse.system().is_symmetric && model.forcing().harmonic % 2 == 1;
    let is_mirrored = has_mirrored && random.gen_bool(MIRRORED);
    let reference = model.modes().frequencies[forced.settings().tracked(forced.model())];
    let nc = width(harmonics);
    let mut modal = vec![0.0; model.size() * nc];
    for (series, frequency) in modal.chunks_mut(nc).zip(&model.modes().frequencies) {
        let size = size * (reference / frequency).min(1.0);
        for (i, q) in series.iter_mut().enumerate() {
            let k = i.div_ceil(2);
            let size = if is_mirrored && k % 2 == 0 { 0.0 } else { size * (k.max(1) as f64).powf(-fall) };
            *q = size * random.sample::<f64, _>(StandardNormal);
        }
    }
    let arguments = coarse.modal().open_arguments(&modal);
    State { harmonics, omega, decay: 0.0, forcing: forced.forcing(), arguments, modal }
}

/// The free motion that a start leads to: responses of light damping are near such motions, of some phase, and of far more of
/// them than there are backbones that begin at linear modes. None where it leads to none, or next to rest.
fn freed<'m, F: Formulation<'m>>(free: &mut F, start: &State, mode: usize) -> Option<State> {
    let model = free.system().model;
    let (damping, frequency) = (model.damping().diagonal(mode), model.modes().frequencies[mode]);
    // Steps change a parameter by a share of itself, and never one that is zero.
    let decay = start.omega * (0.5 * damping / frequency).max(LEAST_DECAY);
    // As the phase condition wants it: otherwise it is the motion that changes for it.
    let start = start.shifted(FRAC_PI_2 - complex(start.mode(mode), 1).arg());
    let mut y = free.encode(&State { decay, forcing: 0.0, ..start });
    of_size(free, &mut y, ROUGH, STEPS[0]).ok()?;
    let state = free.decode(&y).ok()?;
    let size = state.modal.iter().map(|q| q * q).sum::<f64>().sqrt();
    (size > SIZES.0 * free.scales().modal).then_some(state)
}

/// A motion as one of so many times its period: resonances of any order are near a free motion, of which the response has as
/// many periods.
fn slowed(state: &State, order: usize) -> State {
    let nc = width(state.harmonics);
    let spread = |values: &[f64]| {
        let mut slow = vec![0.0; values.len()];
        for (slow, series) in slow.chunks_mut(nc).zip(values.chunks(nc)) {
            slow[0] = series[0];
            (1..=state.harmonics / order).for_each(|k| set_complex(slow, order * k, complex(series, k)));
        }
        slow
    };
    let (arguments, modal) = (spread(&state.arguments), spread(&state.modal));
    State { omega: state.omega / order as f64, arguments, modal, ..*state }
}

/// A motion with the linear response to the forcing on top; none at an undamped resonance.
fn driven<'m, F: Formulation<'m>>(coarse: &F, start: &State) -> Option<State> {
    let mut state = forced_response(coarse, start.forcing, start.omega).ok()?;
    state.modal.iter_mut().zip(&start.modal).for_each(|(driven, own)| *driven += own);
    state.arguments = coarse.modal().open_arguments(&state.modal);
    Some(state)
}

/// Whether a response lies within the range of the study, where what ordinary continuation reaches is known.
fn is_within<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, state: &State) -> bool {
    let (low, high) = forced.reach().frequency;
    (low..=high).contains(&state.omega) && forced.contains(state)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::problem::Problem;
    use crate::structure::laws::{PolynomialSpring, Term};

    /// Free motions that random ones of two masses lead to, of so many random ones; the spring of the first to the ground has this linear
    /// part, and `mode` is the lowest that deforms the structure without it.
    fn free_motions(stiffness: [[f64; 2]; 2], linear: f64, mode: usize, tried: usize) -> usize {
        let terms = vec![Term { power: 1, coefficient: linear }, Term { power: 3, coefficient: 1.0 }];
        let model = Model::builder("two masses")
            .mass([[1.0, 0.0], [0.0, 1.0]])
            .stiffness(stiffness)
            .damping_ratio(0.01)
            .force("x1", 1.0)
            .element("spring", PolynomialSpring { terms }, ["x1"])
            .build()
            .unwrap();
        assert_eq!(model.modes().lowest_deforming(), Some(mode));
        let harmonics = 5;
        let truncation = HarmonicSettings { count: harmonics, ..HarmonicSettings::default() };
        let (unknown, scales) = (Unknown::Mode { damped: true }, Scales::new(&model, mode));
        let mut free = DisplacementForm::of_all_dofs(&model, truncation, mode, unknown, scales).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut found = 0;
        for _ in 0..tried {
            let mut modal: Vec<f64> = (0..2 * width(harmonics)).map(|_| random.sample(StandardNormal)).collect();
            for series in modal.chunks_mut(width(harmonics)) {
                series.iter_mut().enumerate().for_each(|(i, q)| *q /= (i.div_ceil(2).max(1) as f64).powi(2));
            }
            let omega = random.gen_range(0.8..3.0);
            let arguments = free.modal().open_arguments(&modal);
            let start = State { harmonics, omega, decay: 0.0, forcing: 0.0, arguments, modal };
            let Some(state) = freed(&mut free, &start, mode) else { continue };
            let mut y = free.encode(&state);
            assert!(free.linearise(&mut y) < ROUGH, "{state:?}");
            found += 1;
        }
        found
    }

    /// Rest is a free motion as well, and most motions are nearer to it than to any other.
    #[test]
    fn random_motions_lead_to_free_motions_that_are_not_rest() {
        let held = free_motions([[2.0, -1.0], [-1.0, 2.0]], 0.0, 0, 64);
        assert!(held >= 12, "{held} of 64");
        // What a law alone holds has a rigid-body mode below.
        let free = free_motions([[1.0, -1.0], [-1.0, 1.0]], 1.0, 1, 64);
        assert!(free >= 12, "{free} of 64");
    }
}
