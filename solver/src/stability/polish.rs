//! From a solution of the harmonic balance to the time marcher's own periodic orbit, and what its multipliers say.
//!
//! One computation verifies (how far is the marched orbit from the truncated series?) and decides stability: the marcher's
//! tangent contains the impacts as they are, which no truncated series does.

use super::basin::is_left_by_a_push;
use super::multipliers::{Multiplier, Verdict};
use super::shooting::{NewtonOptions, Orbit, Period, Point, Shooting};
use super::symmetry;
use crate::formulation::harmonics::{evaluate, width};
use crate::formulation::state::State;
use crate::marching::{Account, MarchingSettings};
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// How near an orbit must be, and when impacts forbid the comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct PolishSettings {
    /// Time steps.
    pub marching: MarchingSettings,
    /// Largest distance of the marched orbit, rms over a period and all modes, relative to the motion without its mean.
    pub distance: f64,
    /// Largest relative difference of the frequencies.
    pub detuning: f64,
    /// Largest share of the energy supplied in a period that impacts may take.
    ///
    /// The marcher's contact takes the kinetic energy of the nodes that hit; that of the balance is elastic as H grows.
    /// The difference matters where this energy is not small beside what damping and friction take, that is beside what
    /// the forcing supplies. A reduced blade of 39 dofs loses 0.1 to 0.2 % of it in impacts, a single mass all of it.
    pub impacts: f64,
    /// Largest share of the kinetic energy that the hardest impact may take of an orbit that is called stable. Where contact has just begun
    /// impacts take next to nothing, but what a small push makes of them depends on whether what strikes is the structure, or little of it.
    pub struck: f64,
    /// Most work that a period with its tangent may be: time steps times numbers in a step's tangent. A blade of 39 dofs has 1e7,
    /// and takes tens of milliseconds.
    pub work: f64,
}

impl Default for PolishSettings {
    fn default() -> Self {
        Self {
            marching: MarchingSettings::default(),
            distance: 0.2,
            detuning: 0.01,
            impacts: 0.02,
            struck: 0.1,
            work: 3e8,
        }
    }
}

/// Why there is no verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The marcher's impacts take too much energy ([`PolishSettings::impacts`]).
    Impacts,
    /// Newton's method came to no orbit.
    NotConverged,
    /// The orbits that it came to are too far away.
    TooFar,
    /// The motion could not be marched, or its multipliers not be computed.
    Failed,
    /// A period takes too many time steps ([`PolishSettings::work`]).
    Costly,
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Impacts => "marching loses impact energy that a rigid contact keeps",
            Self::NotConverged => "no marched orbit was found",
            Self::TooFar => "the marched orbit is another one",
            Self::Failed => "the motion could not be marched",
            Self::Costly => "a period takes too many time steps: a law acts, or a mode moves, too fast",
        })
    }
}

/// A marched orbit near a solution of the balance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Polished {
    /// The orbit.
    pub orbit: Orbit,
    /// Largest |x| of each monitored dof, m.
    pub amplitudes: Vec<f64>,
    /// Its distance from the solution, rms over a period and all modes, relative to the solution without its mean.
    pub distance: f64,
    /// All multipliers, the largest first.
    pub multipliers: Vec<Multiplier>,
    /// Share of the energy supplied in a period that impacts take.
    pub impacts: f64,
    /// Moduli that are 1 within this are not known to be on either side of the unit circle.
    pub margin: f64,
}

/// What polishing a solution of the balance came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Polish {
    /// Verdict.
    pub verdict: Verdict,
    /// Why there is none.
    pub reason: Option<Reason>,
    /// The marched orbit; without one the verdict is not known.
    pub polished: Option<Polished>,
    /// Periods marched with their tangent, and without.
    pub periods: (usize, usize),
}

/// What is known around a point of a branch.
#[derive(Debug, Clone, Copy, Default)]
pub struct Around<'a> {
    /// Two solutions of the balance between which the branch passes the point.
    pub between: Option<[&'a State; 2]>,
    /// A solution nearby with the orbit that it was polished to.
    pub neighbour: Option<(&'a State, &'a Orbit)>,
}

/// Most Newton iterations of an attempt.
const ITERATIONS: usize = 12;

/// Polishes a solution of the balance to an orbit of the marcher.
///
/// Attempts, in this order, the first one within the gates counts: in the plane across the branch, from the solution plus
/// the neighbour's correction, with a line search; at fixed frequency with full steps, from there; the same from the
/// solution; in the plane from the solution. A line search may stall where contacts open and close, full steps pass.
pub fn polish(model: &Model, settings: &PolishSettings, state: &State, around: Around<'_>) -> Polish {
    let nothing = |verdict, reason, periods| Polish { verdict, reason: Some(reason), polished: None, periods };
    let Ok(mut shooting) = Shooting::new(model, &settings.marching, state) else {
        return nothing(Verdict::NoOrbitNearby, Reason::Failed, (0, 0));
    };
    if shooting.work() > settings.work {
        return nothing(Verdict::NoOrbitNearby, Reason::Costly, (0, 0));
    }
    let Ok(start) = shooting.point_of(state) else {
        return nothing(Verdict::NoOrbitNearby, Reason::Failed, (0, 0));
    };
    let corrected = corrected(&shooting, &start, around);
    let normal = normal(&shooting, around);
    let (mut reason, mut is_lossy) = (Reason::NotConverged, false);
    for (from, plane, searches) in attempts(&start, corrected.as_ref(), normal.as_deref()) {
        let options = NewtonOptions { plane, searches, iterations: ITERATIONS };
        let Some((point, period)) = shooting.solve(from, &options) else { continue };
        match judge(model, &mut shooting, settings, state, &point, &period) {
            Ok(mut found) => {
                found.periods = shooting.periods;
                return found;
            }
            Err(why) => {
                is_lossy |= why == Reason::TooFar && share_of_impacts(&period) > settings.impacts;
                reason = why;
            }
        }
    }
    // Another orbit than that of the balance: because of impacts, if it or the balance's motion would lose too much in them.
    // Where Newton's method came to nothing, a motion that is no orbit says nothing.
    let impacts = |period: Period| share_of_impacts(&period) > settings.impacts;
    if reason == Reason::TooFar && (is_lossy || shooting.period(&start).is_ok_and(impacts)) {
        return nothing(Verdict::NotComparable, Reason::Impacts, shooting.periods);
    }
    nothing(Verdict::NoOrbitNearby, reason, shooting.periods)
}

/// The point plus what polishing moved the neighbour by.
fn corrected(shooting: &Shooting<'_>, start: &Point, around: Around<'_>) -> Option<Point> {
    let (state, orbit) = around.neighbour?;
    let (before, after) = (shooting.point_of(state).ok()?, shooting.point_at(orbit));
    let moved = |(x, (a, b)): (&f64, (&f64, &f64))| x + a - b;
    let x = start.x.iter().zip(after.x.iter().zip(&before.x)).map(moved).collect();
    Some(Point { x, w: start.w + after.w - before.w })
}

/// Normal of the plane across the branch.
fn normal(shooting: &Shooting<'_>, around: Around<'_>) -> Option<Vec<f64>> {
    let [a, b] = around.between?;
    shooting.across(&shooting.point_of(a).ok()?, &shooting.point_of(b).ok()?)
}

/// Where attempts start, in which plane they stay, and whether they search.
fn attempts<'a>(
    start: &'a Point,
    corrected: Option<&'a Point>,
    normal: Option<&'a [f64]>,
) -> Vec<(&'a Point, Option<&'a [f64]>, bool)> {
    let mut attempts = Vec::new();
    let first = corrected.unwrap_or(start);
    if normal.is_some() {
        attempts.push((first, normal, true));
    }
    attempts.push((first, None, false));
    if corrected.is_some() {
        attempts.push((start, None, false));
        if normal.is_some() {
            attempts.push((start, normal, true));
        }
    }
    attempts
}

/// A verdict, if the orbit's impacts let it be one of the balance's motion as well.
pub(super) fn comparable(settings: &PolishSettings, period: &Period, verdict: Verdict) -> Verdict {
    let (taken, before) = period.account.hardest;
    let is_struck = verdict == Verdict::Stable && taken > settings.struck * before;
    if is_struck || share_of_impacts(period) > settings.impacts { Verdict::NotComparable } else { verdict }
}

/// What an orbit says, if it is near enough.
fn judge(
    model: &Model,
    shooting: &mut Shooting<'_>,
    settings: &PolishSettings,
    state: &State,
    point: &Point,
    period: &Period,
) -> Result<Polish, Reason> {
    let orbit = shooting.orbit(point);
    let share = period.stride as f64 / orbit.steps as f64;
    let distance = distance(state, &period.path, share);
    let is_near = distance < settings.distance && (orbit.omega / state.omega - 1.0).abs() < settings.detuning;
    let is_untouched = period.account.impacts == 0.0 && strikes(model, state);
    if !is_near || is_untouched || symmetry::is_lost(model, state, &period.path, share) {
        return Err(Reason::TooFar);
    }
    let multipliers = period.multipliers().map_err(|_| Reason::Failed)?;
    let margin = shooting.margin(point, period);
    let impacts = share_of_impacts(period);
    let verdict = match comparable(settings, period, Verdict::of(&multipliers, margin)) {
        Verdict::Stable if is_left_by_a_push(shooting, point, period, &multipliers) => Verdict::Marginal,
        verdict => verdict,
    };
    let polished = Polished { orbit, amplitudes: period.amplitudes.clone(), distance, multipliers, impacts, margin };
    let reason = (verdict == Verdict::NotComparable).then_some(Reason::Impacts);
    Ok(Polish { verdict, reason, polished: Some(polished), periods: (0, 0) })
}

/// A motion that presses for a larger share of the period than this is not one that only passes by.
const PRESSED: f64 = 0.02;

/// Whether a rigid contact closes and opens again in a motion of the balance, by more than what the two ways to compute it may differ in.
fn strikes(model: &Model, state: &State) -> bool {
    let nc = width(state.harmonics);
    let mut shares = model.contacts().map(|contact| {
        let pressure = &state.arguments[contact.first * nc..(contact.first + 1) * nc];
        let count = 16 * nc;
        let is_pressed = |&i: &usize| evaluate(pressure, TAU * i as f64 / count as f64)[0] > 0.0;
        (0..count).filter(is_pressed).count() as f64 / count as f64
    });
    shares.any(|share| share > PRESSED && share < 1.0)
}

/// The energy supplied counts at least as this share of what the forcing exchanges with the structure: a period that closes to what
/// Newton's method leaves takes or gives a billionth of that, and where the forcing supplies nothing it would be all there is.
const ROUNDING: f64 = 1e-5;

/// Share of the energy supplied in a period that impacts take, 0 to 1. Where friction drives the structure the forcing may supply
/// nothing.
pub(super) fn share_of_impacts(period: &Period) -> f64 {
    share(&period.account)
}

fn share(account: &Account) -> f64 {
    if account.impacts > 0.0 { account.impacts / measure(account) } else { 0.0 }
}

/// What that share may be off by what rounding leaves: touches that graze, or do not, take or spare a millionth of what the forcing
/// exchanges, which is all where it supplies nothing.
pub(super) fn noise_of_impacts(period: &Period) -> f64 {
    noise(&period.account)
}

fn noise(account: &Account) -> f64 {
    if account.exchanged > 0.0 { ROUNDING * account.exchanged / measure(account) } else { 0.0 }
}

/// The energy that impacts are compared with.
fn measure(&Account { supplied, exchanged, impacts, .. }: &Account) -> f64 {
    supplied.max(impacts).max(ROUNDING * exchanged)
}

/// Distance of a marched path from the motion of the balance, rms over the period and all modes, relative to what varies of
/// the latter: a static deflection that both share says nothing of the vibration. `path`: modal displacements at instants that
/// are a `share` of the period apart, one after the other.
fn distance(state: &State, path: &[f64], share: f64) -> f64 {
    let n = state.modal.len() / (2 * state.harmonics + 1);
    let (mut apart, mut size) = (0.0, 0.0);
    for (i, marched) in path.chunks_exact(n).enumerate() {
        let tau = TAU * i as f64 * share;
        for (j, y) in marched.iter().enumerate() {
            let (balanced, mean) = (evaluate(state.mode(j), tau)[0], state.mode(j)[0]);
            apart += (y - balanced) * (y - balanced);
            size += (balanced - mean) * (balanced - mean);
        }
    }
    (apart / size).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_measured_by_what_varies() {
        // Twice the vibration about a static deflection of twenty times its amplitude.
        let state = State {
            harmonics: 1,
            omega: 1.0,
            decay: 0.0,
            forcing: 1.0,
            arguments: Vec::new(),
            modal: vec![20.0, 1.0, 0.0],
        };
        let path: Vec<f64> = (0..256).map(|i| 20.0 + 2.0 * (TAU * f64::from(i) / 256.0).cos()).collect();
        let apart = distance(&state, &path, 1.0 / 256.0);
        assert!((apart - 1.0).abs() < 1e-12, "{apart}");
    }

    /// What Newton's method leaves of a motion that friction drives changes its share by less than others may tell it differently.
    #[test]
    fn leftovers_are_no_impacts() {
        let share = |supplied, impacts| share(&Account { supplied, exchanged: 1.0, impacts, ..Account::default() });
        assert_eq!(share(0.5, 0.1), 0.2);
        assert_eq!(share(0.1, 0.5), 1.0);
        assert_eq!(share(-0.1, 1e-5), 1.0);
        assert_eq!(share(0.5, -1e-9), 0.0);
        assert!(share(-0.1, 1e-9) - share(-0.1, 0.0) < 2e-4);
    }

    /// Of a blade that friction holds against the casing the forcing supplies nothing: whether a node grazes it makes an orbit that was
    /// told with a share of 0 one of 0.042, and that is none the less the same orbit.
    #[test]
    fn where_nothing_is_supplied_the_share_of_impacts_is_rounding() {
        let account = |supplied, impacts| Account { supplied, exchanged: 1.0, impacts, ..Account::default() };
        let grazing = account(-0.018, 4.2e-7);
        assert!(share(&grazing) > 0.04 && noise(&grazing) >= share(&grazing));
        let usual = account(0.5, 0.1);
        assert!((noise(&usual) - 2e-5).abs() < 1e-9, "{}", noise(&usual));
    }
}
