//! Seeds: backbone motions shifted in time so that the forcing feeds in what is dissipated; landing on forced responses.

use crate::curve::least_norm::converge;
use crate::curve::problem::Failure;
use crate::formulation::Formulation;
use crate::formulation::modal::Modal;
use crate::formulation::state::State;
use crate::response::backbone::{Backbone, BackbonePoint};
use crate::response::forced::Forced;
use crate::response::forcing::{Unreached, from_rest, through_motion};
use crate::response::windows::{Window, crossing};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The two time shifts per backbone point at which the forcing does the right work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// ψ = asin((R_lin + R_nl)/W).
    First,
    /// ψ = π − asin((R_lin + R_nl)/W).
    Second,
}

/// A predicted forced response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Seed {
    /// Predicted motion at its frequency, with its forcing amplitude.
    pub state: State,
    /// Place on the backbone: index of a point, and between points the share of the way to the next.
    pub place: f64,
    /// Which of the two phases.
    pub phase: Phase,
}

/// A backbone motion at a place, interpolated between points, and its (R_lin + R_nl)/(W/A).
fn motion(backbone: &Backbone, place: f64) -> (State, f64) {
    let index = place as usize;
    let here = &backbone.points[index];
    let share = place - index as f64;
    match backbone.points.get(index + 1) {
        Some(next) if share > 0.0 => {
            let (from, to) = (here.energies().balance(), next.energies().balance());
            (here.point.state.interpolate(&next.point.state, share), from + share * (to - from))
        }
        _ => (here.point.state.clone(), here.energies().balance()),
    }
}

/// Seed at a place of the backbone (see [`Seed::place`]) for forcing amplitude `forcing`.
pub fn seed(modal: &Modal, backbone: &Backbone, place: f64, phase: Phase, forcing: f64) -> Seed {
    let (state, balance) = motion(backbone, place);
    let m = modal.harmonic() as f64;
    let angle = (balance / forcing).clamp(-1.0, 1.0).asin();
    let psi = match phase {
        Phase::First => angle,
        Phase::Second => std::f64::consts::PI - angle,
    };
    let shift = -(psi + modal.forcing_projection(&state).arg()) / m;
    let mut state = state.shifted(shift);
    (state.forcing, state.decay) = (forcing, 0.0);
    Seed { state, place, phase }
}

/// Landing no farther than this from its seed is a landing on what was predicted. Motions are compared whatever their
/// phases: where the dissipation changes steeply along the backbone, a response at the seed's own frequency has another
/// phase than the balance alone gives.
const NEAR: f64 = 0.3;

/// Most steps of least norm from a seed.
const STEPS: usize = 20;

/// A converged forced response and its distance from the seed that led to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Landing {
    /// The response.
    pub state: State,
    /// Relative distance of the two motions.
    pub distance: f64,
}

impl Landing {
    /// Whether this is what was predicted. A landing that is not may still be a response that nobody knew.
    pub fn is_near(&self) -> bool {
        self.distance <= NEAR
    }
}

/// Why a seed did not lead to a forced response.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LandingFailure {
    /// No point of the window converged.
    #[error("nothing converged: {0}")]
    NotConverged(Unreached),
    /// Every point that converged did so far from its prediction, this relative distance at best, on a known branch.
    #[error("what converged lies on a known branch, far from the prediction (relative distance {0:.2} or more)")]
    Far(f64),
    /// All that converged repeats itself after fewer periods of the force: it is of another order ([`crate::response::orders`]).
    #[error("every motion that converged repeats itself after fewer periods of the force")]
    Shorter,
}

/// How a seed is turned into a forced response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LandingMethod {
    /// With the full forcing, at whatever frequency is nearest. Runs and messages know it by what it once was.
    #[serde(rename = "fixed_frequency")]
    FullForcing,
    /// By fold-safe steps in the forcing amplitude, from where the energy balance just closes, or else from rest: slower, for
    /// windows where the other method finds nothing.
    SteppedForcing,
}

/// Seeds to land from in turn, the most promising places of a well first.
pub fn candidates(
    modal: &Modal,
    backbone: &Backbone,
    well: &Window,
    phase: Phase,
    method: LandingMethod,
    forcing: f64,
) -> Vec<Seed> {
    let seed_at = |place: f64| {
        let closing = || motion(backbone, place).1.abs().clamp(1e-3 * forcing, forcing);
        let forcing = if method == LandingMethod::SteppedForcing { closing() } else { forcing };
        seed(modal, backbone, place, phase, forcing)
    };
    places(backbone, well, method, forcing).into_iter().map(seed_at).collect()
}

/// Lands on forced responses from seeds of the backbone of mode `mode` (from 0), in their order. Steps in the forcing, which
/// cost the most, end with the first landing on what was predicted; where they lead nowhere, the forcing grows from rest at the
/// frequency of the first seed.
///
/// # Errors
/// If none converges: why the last one did not.
pub fn land_all<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    seeds: &[Seed],
    method: LandingMethod,
    mode: usize,
) -> Result<Vec<Landing>, Unreached> {
    let mut failure = Failure::Diverged.into();
    let mut landings = Vec::with_capacity(seeds.len());
    for seed in seeds {
        if forced.interrupt().is_set() {
            break;
        }
        match land(forced, seed, method, mode) {
            Ok(landing) => {
                let is_enough = method == LandingMethod::SteppedForcing && landing.is_near();
                landings.push(landing);
                if is_enough {
                    break;
                }
            }
            Err(reason) => failure = reason,
        }
    }
    if landings.is_empty() && method == LandingMethod::SteppedForcing {
        landings.extend(seeds.first().and_then(|seed| grown_from_rest(forced, seed, mode)));
    }
    if landings.is_empty() { Err(failure) } else { Ok(landings) }
}

/// What a growing forcing leads to from rest at the frequency of a seed, if it is of the order that is looked for: hardly ever what
/// was predicted, but known branches are compared with seeds that landed.
fn grown_from_rest<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, seed: &Seed, mode: usize) -> Option<Landing> {
    let (forcing, omega) = (forced.forcing(), seed.state.omega);
    let grown = from_rest::<F>(forced.model(), forced.settings(), forcing, omega, forced.interrupt()).ok()?;
    let state = forced.converge(&grown).ok().filter(|state| !forced.is_shorter(state))?;
    let distance = forced.motion_distance(&state, &seed.state, mode);
    Some(Landing { state, distance })
}

/// Lands on a forced response from a seed of the backbone of mode `mode` (from 0).
///
/// # Errors
/// If it does not converge.
pub fn land<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    seed: &Seed,
    method: LandingMethod,
    mode: usize,
) -> Result<Landing, Unreached> {
    match method {
        LandingMethod::FullForcing => land_nearby(forced, seed, mode),
        LandingMethod::SteppedForcing => land_by_forcing(forced, seed, mode),
    }
}

/// Lands with ω free: seeds of resonances lie next to folds, where there is nothing at their own frequency or Newton's method
/// does not find it. What a range does not contain that contains the seed is not what was predicted.
fn land_nearby<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    seed: &Seed,
    mode: usize,
) -> Result<Landing, Unreached> {
    let (newton, (low, high)) = (forced.settings().continuation.newton, forced.reach().frequency);
    let problem = forced.problem();
    let mut y = problem.encode(&seed.state);
    converge(problem, &mut y, STEPS, &newton)?;
    let state = problem.decode(&y).map_err(|_| Failure::Singular)?;
    if !(low.min(seed.state.omega)..=high.max(seed.state.omega)).contains(&state.omega) {
        return Err(Failure::Diverged.into());
    }
    let distance = forced.motion_distance(&state, &seed.state, mode);
    Ok(Landing { state, distance })
}

fn land_by_forcing<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    seed: &Seed,
    mode: usize,
) -> Result<Landing, Unreached> {
    let mut best: Result<Landing, Unreached> = Err(Unreached::OutOfReach);
    let (model, settings, interrupt) = (forced.model(), forced.settings(), forced.interrupt());
    for state in through_motion::<F>(model, settings, forced.forcing(), &seed.state, interrupt)? {
        let Ok(landed) = forced.converge(&state) else { continue };
        let distance = forced.motion_distance(&landed, &seed.state, mode);
        if best.as_ref().is_ok_and(|best| best.distance <= distance) {
            continue;
        }
        best = Ok(Landing { state: landed, distance });
    }
    best
}

/// Places to try. Near the edges of a window, where A* is close to A, the forced response crosses the backbone and the
/// prediction is nearly exact; far inside, where the forcing exceeds what is dissipated many times, it is poor. They do not depend on where
/// the points of the backbone lie, which its steps decide.
fn places(backbone: &Backbone, window: &Window, method: LandingMethod, forcing: f64) -> Vec<f64> {
    let beyond = |index: Option<usize>| index.filter(|&index| is_same_piece(backbone, index, window.best));
    let ahead = || (window.best..=window.last).chain(beyond(Some(window.last + 1)));
    let back = || (window.first..=window.best).rev().chain(beyond(window.first.checked_sub(1)));
    let inner = passing(backbone, ahead(), window, 0.5 * forcing);
    let edges = [passing(backbone, ahead(), window, 0.9 * forcing), passing(backbone, back(), window, 0.9 * forcing)];
    let [end, begin] = edges.map(|place| arc(backbone, place));
    let between = [0.5, 0.25, 0.75].map(|share| place_at(backbone, window, begin + share * (end - begin)));
    let all: Vec<f64> = match method {
        // A branch is followed from where the first of them lands: better not from its folds.
        LandingMethod::FullForcing => [inner, window.best as f64].into_iter().chain(between).chain(edges).collect(),
        // A walk in A passes through the motions of the others.
        LandingMethod::SteppedForcing => [inner].into_iter().chain(edges).collect(),
    };
    let mut list: Vec<f64> = Vec::new();
    for place in all {
        if !list.contains(&place) {
            list.push(place);
        }
    }
    list
}

/// Whether a point is one of the piece of another one.
fn is_same_piece(backbone: &Backbone, index: usize, other: usize) -> bool {
    backbone.points.get(index).is_some_and(|point| point.piece() == backbone.points[other].piece())
}

/// The first place at which A* passes `level` on a way from the lowest point of a window to the next one beyond its end; where it does not, the
/// end of the window.
fn passing(backbone: &Backbone, way: impl Iterator<Item = usize>, window: &Window, level: f64) -> f64 {
    let threshold = |index: usize| backbone.points[index].threshold();
    let mut here = window.best;
    for next in way {
        if threshold(next) >= level {
            let share = if next == here { 0.0 } else { crossing(threshold(here), threshold(next), level) };
            return here as f64 + share * (next as f64 - here as f64);
        }
        if (window.first..=window.last).contains(&next) {
            here = next;
        }
    }
    here as f64
}

/// Scaled arc length at a place.
fn arc(backbone: &Backbone, place: f64) -> f64 {
    let index = place as usize;
    let from = backbone.points[index].arc();
    let to = backbone.points.get(index + 1).map_or(from, BackbonePoint::arc);
    from + (place - index as f64) * (to - from)
}

/// The place of a window, or of the steps beside it, at an arc length.
fn place_at(backbone: &Backbone, window: &Window, at: f64) -> f64 {
    let begin = window.first.saturating_sub(1);
    let beyond = (begin..=window.last).find(|&index| backbone.points.get(index + 1).is_none_or(|next| next.arc() > at));
    let index = beyond.unwrap_or(window.last);
    let [from, to] = [index, index + 1].map(|i| backbone.points.get(i).map_or(at, BackbonePoint::arc));
    if to > from { index as f64 + ((at - from) / (to - from)).clamp(0.0, 1.0) } else { index as f64 }
}
