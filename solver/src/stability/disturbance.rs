//! How hard a push throws a structure from its main motion onto a detached branch.
//!
//! An impulse p = M φ_j s changes the velocity of one mode by s and of no other; φ_j is taken with the sign that lets it move the
//! monitored dof forward that it moves most. It acts on the main motion at a phase of the
//! forcing; marching says where the motion ends. Sizes are scanned upwards, at every phase, until a push of that size ends on the
//! branch, and once more in finer steps and farther if none does; between it and the size before the first change is bisected. Boundaries of basins need not be simple: a smaller push
//! between sizes that were scanned may do the same.

use super::endings::{Ending, Ends, NEAR, SURE};
use super::multipliers::Verdict;
use super::nearby::{distance, images, orbits, walk_to};
use super::polish::Polished;
use super::shooting::{NewtonOptions, Orbit, Shooting};
use super::verification::Verification;
use crate::marching::{Marching, MarchingError, MarchingSettings};
use crate::response::branch::Branch;
use crate::response::task::DisturbPlace;
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// What is scanned.
#[derive(Debug, Clone, PartialEq)]
pub struct DisturbSettings {
    /// Phases of the forcing at which the push acts, evenly spread over a period of the response.
    pub phases: usize,
    /// Number of sizes, and the ratio of each to the one before; the largest gives the mode twice the largest kinetic energy that
    /// the motion on the branch has.
    pub sizes: (usize, f64),
    /// The same of a second scan, where the first finds nothing: basins may be narrow. The largest of these gives the mode eight times
    /// that energy.
    pub finer: (usize, f64),
    /// The first change is bisected to this share of the push.
    pub resolution: f64,
    /// Most periods that a motion may take to end on one of the two.
    pub periods: usize,
}

impl Default for DisturbSettings {
    fn default() -> Self {
        Self { phases: 16, sizes: (12, 1.3), finer: (36, 1.05), resolution: 0.01, periods: 600 }
    }
}

/// The largest push of a finer scan over that of the first one.
const FARTHER: f64 = 2.0;
/// Newton iterations from where a motion from rest has come to.
const ITERATIONS: usize = 12;

/// The smallest push found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Push {
    /// Number of the phase, of as many as were scanned: t = number/phases of a period after the forcing is largest.
    pub phase: usize,
    /// Change of the modal velocity that ends on the branch, kg^½·m/s, in the sense that moves the monitored dof forward.
    pub size: f64,
    /// The largest smaller one at this phase that was seen not to.
    pub below: f64,
    /// Where that one ends.
    pub ends: Ending,
    /// Whether both were marched on until they were beyond doubt on their orbits.
    pub is_confirmed: bool,
}

/// Why no push was scanned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unpushed {
    /// Neither has a main branch a stable marched orbit at this frequency, nor does a motion from rest settle on another one than the
    /// branch's.
    NoMain,
    /// The branch has no stable marched orbit at this frequency.
    NoTarget,
    /// An orbit could not be marched.
    Failed,
}

impl std::fmt::Display for Unpushed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::NoMain => "no other stable motion is known at this frequency: no main branch that was followed to there has one, nor does the motion from rest settle on another",
            Self::NoTarget => "no stable motion on the branch at this frequency",
            Self::Failed => "the motion could not be marched",
        })
    }
}

/// What pushes in one mode do to the main motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Disturbance {
    /// Frequency ω of both motions, rad/s.
    pub omega: f64,
    /// Number of the mode that is pushed, from 0.
    pub mode: usize,
    /// Number of the monitored dof that the mode moves most.
    pub monitor: usize,
    /// |φ| of the mode there, kg^−½: an impulse s/|φ| at this dof, in N s, changes the velocity of the mode by s; that of the dof
    /// changes by s|φ|, in m/s, by this mode alone.
    pub shape: f64,
    /// Phases scanned.
    pub phases: usize,
    /// Largest |x| of the monitored dofs on the main motion and on the branch, m; empty without such orbits.
    pub amplitudes: [Vec<f64>; 2],
    /// Sizes scanned, ascending, kg^½·m/s.
    pub sizes: Vec<f64>,
    /// Where each ended: one size after the other, phase by phase.
    pub endings: Vec<Ending>,
    /// The smallest push found that ends on the branch.
    pub push: Option<Push>,
    /// Why none was scanned.
    pub reason: Option<Unpushed>,
    /// Where the motion ends that the forcing brings about when it is switched on at rest, at once and where it is largest; marched
    /// until it is beyond doubt. Not known without either orbit, nor of results of earlier programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_rest: Option<Ending>,
}

impl Disturbance {
    /// Whether it can be what pushes at `place` in a model with so many modes and monitored dofs did.
    pub fn is_sound(&self, place: &DisturbPlace, monitors: usize) -> bool {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let is_scanned = |push: &Push| {
            push.phase < self.phases
                && (push.below >= 0.0 && push.below < push.size && push.size.is_finite())
                && self.sizes.last().is_some_and(|largest| push.size <= *largest)
        };
        self.omega == place.omega
            && self.monitor < monitors
            && self.shape >= 0.0
            && self.shape.is_finite()
            && self.phases > 0
            && self.mode == place.mode
            && self.endings.len() == self.sizes.len() * self.phases
            && self.sizes.is_sorted_by(|a, b| a < b)
            && finite(&self.sizes)
            && self.sizes.iter().all(|size| *size > 0.0)
            && self.amplitudes.iter().all(|list| finite(list) && (list.is_empty() || list.len() == monitors))
            && self.push.as_ref().is_none_or(is_scanned)
            && self.sizes.is_empty() == self.reason.is_some()
    }
}

/// Told of every motion that was marched to its end, and of the largest |x| of the first monitored dof in its last period, m;
/// breaking cancels the rest.
pub type PushObserver<'o> = dyn FnMut(f64) -> ControlFlow<()> + 'o;

impl Verification {
    /// A frequency at which the branch can be settled on, rad/s: the middle of the widest range over which its marched orbits are
    /// known to be stable. `None` if none is.
    pub fn settled(&self) -> Option<f64> {
        let stable = |point: &super::verification::VerifiedPoint| {
            point.orbit.as_ref().filter(|_| point.verdict == Verdict::Stable).map(|orbit| orbit.omega)
        };
        let mut widest: Option<(f64, f64)> = None;
        let mut run: Option<(f64, usize)> = None;
        for point in &self.points {
            let Some(omega) = stable(point) else {
                run = None;
                continue;
            };
            let crosses = |from: usize| self.bifurcations.iter().any(|b| b.after >= from && b.after < point.index);
            let first = run.filter(|&(_, last)| !crosses(last)).map_or(omega, |(first, _)| first);
            run = Some((first, point.index));
            if widest.is_none_or(|(low, high)| (omega - first).abs() > high - low) {
                widest = Some((omega.min(first), omega.max(first)));
            }
        }
        widest.map(|(low, high)| 0.5 * (low + high))
    }
}

/// Scans pushes from the main motion at a level onto the highest stable motion of a branch: the lowest stable one of the main
/// branches or, where these were not followed as far, the one that a motion from rest settles on. `None` if the observer breaks.
pub fn disturb(
    model: &Model,
    settings: &DisturbSettings,
    mains: &[&Branch],
    branch: &Branch,
    place: &DisturbPlace,
    observer: &mut PushObserver<'_>,
) -> Option<Disturbance> {
    let [main, target] = stable_motions(model, settings, mains, branch, place.omega);
    let shapes = model.monitors().iter().map(|&dof| model.modes().shapes[(dof, place.mode)]).enumerate();
    let (monitor, shape) = shapes.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap_or_default();
    let mut found = Disturbance {
        omega: place.omega,
        mode: place.mode,
        monitor,
        shape: shape.abs(),
        phases: settings.phases,
        amplitudes: [&main, &target].map(|found| found.as_ref().map_or_else(Vec::new, |found| found.1.clone())),
        sizes: Vec::new(),
        endings: Vec::new(),
        push: None,
        reason: None,
        from_rest: None,
    };
    let [main, target] = [main, target].map(|motion| motion.map(|(orbit, _)| orbit));
    let Ok(ends) = Ends::new(model, main.as_ref(), target.as_ref()) else {
        return Some(Disturbance { reason: Some(Unpushed::Failed), ..found });
    };
    if let Some(ends) = &ends {
        let marching = Marching::new(model, &MarchingSettings::default(), branch.forcing, place.omega);
        let (ending, amplitude) = marching
            .map_or((Ending::Elsewhere, f64::NAN), |mut marching| ends.of(&mut marching, settings.periods, SURE));
        found.from_rest = Some(ending);
        observer(amplitude).is_continue().then_some(())?;
    }
    let (main, target, ends) = match (main, target, ends) {
        (Some(main), Some(target), Some(ends)) => (main, target, ends),
        (None, ..) => return Some(Disturbance { reason: Some(Unpushed::NoMain), ..found }),
        (Some(_), ..) => return Some(Disturbance { reason: Some(Unpushed::NoTarget), ..found }),
    };
    let Ok(scan) = Scan::new(model, settings, (place.mode, shape.signum()), main, &target, ends) else {
        return Some(Disturbance { reason: Some(Unpushed::Failed), ..found });
    };
    scan.upwards(scan.sizes(settings.sizes, 1.0), &mut found, observer)?;
    if found.push.is_none() {
        let finer = scan.sizes(settings.finer, FARTHER);
        found.sizes.retain(|size| finer.first().is_some_and(|smallest| size < smallest));
        found.endings.truncate(found.sizes.len() * found.phases);
        scan.upwards(finer, &mut found, observer)?;
    }
    Some(found)
}

/// An orbit with the largest |x| of each monitored dof, m.
type Motion = (Orbit, Vec<f64>);

/// The stable motion that pushes begin from and that on the branch, as far as they are known.
fn stable_motions(
    model: &Model,
    settings: &DisturbSettings,
    mains: &[&Branch],
    branch: &Branch,
    omega: f64,
) -> [Option<Motion>; 2] {
    let stable = |branch: &Branch| {
        let found = orbits(model, branch, omega).into_iter();
        found.filter(|(verdict, _)| *verdict == Verdict::Stable).map(|(_, polished)| polished)
    };
    let height = |polished: &Polished| polished.amplitudes[0];
    let of = |polished: Polished| (polished.orbit, polished.amplitudes);
    let main = mains.iter().flat_map(|main| stable(main)).min_by(|a, b| height(a).total_cmp(&height(b)));
    let target = stable(branch).max_by(|a, b| height(a).total_cmp(&height(b))).map(of);
    let main = main.map(of).or_else(|| from_rest(model, branch.forcing, omega, settings.periods));
    let is_other = |(main, _): &Motion| target.as_ref().is_none_or(|(target, _)| are_apart(model, main, target));
    [main.filter(is_other), target]
}

/// The stable orbit that a motion from rest settles on, with the largest |x| of each monitored dof.
fn from_rest(model: &Model, forcing: f64, omega: f64, periods: usize) -> Option<Motion> {
    let mut marching = Marching::new(model, &MarchingSettings::default(), forcing, omega).ok()?;
    for _ in 0..periods {
        marching.period().ok()?;
    }
    let near = Orbit { omega, forcing, steps: marching.steps_per_period(), state: marching.state() };
    let mut shooting = Shooting::around(model, &near).ok()?;
    let start = shooting.point_at(&near);
    let (point, period) =
        shooting.solve(&start, &NewtonOptions { plane: None, searches: false, iterations: ITERATIONS })?;
    let verdict = Verdict::of(&period.multipliers().ok()?, shooting.margin(&point, &period));
    (verdict == Verdict::Stable).then(|| (shooting.orbit(&point), period.amplitudes))
}

/// Whether two orbits of a frequency are different motions.
fn are_apart(model: &Model, a: &Orbit, b: &Orbit) -> bool {
    let size = distance(model, a.omega, &b.state, &[vec![0.0; b.state.len()]]);
    images(model, b).is_ok_and(|images| distance(model, a.omega, &a.state, &images) > NEAR * size)
}

/// Motions of a model at one frequency that begin with a push.
struct Scan<'m, 's> {
    model: &'m Model,
    settings: &'s DisturbSettings,
    mode: usize,
    /// Of the modal velocity that moves the monitored dof forward.
    sign: f64,
    main: Orbit,
    /// States of the main motion at the phases, with their steps.
    starts: Vec<(usize, Vec<f64>)>,
    ends: Ends<'m>,
    /// The largest push, kg^½·m/s.
    largest: f64,
}

impl<'m, 's> Scan<'m, 's> {
    fn new(
        model: &'m Model,
        settings: &'s DisturbSettings,
        (mode, sign): (usize, f64),
        main: Orbit,
        target: &Orbit,
        ends: Ends<'m>,
    ) -> Result<Self, MarchingError> {
        let n = model.size();
        let mut marching = main.marching(model)?;
        let mut starts = Vec::with_capacity(settings.phases);
        for phase in 0..settings.phases {
            walk_to(&mut marching, phase * main.steps / settings.phases)?;
            starts.push((marching.index(), marching.state()));
        }
        let mut largest = 0.0f64;
        target.marching(model)?.walk(&mut |marching| {
            let speeds = &marching.state()[n..2 * n];
            largest = largest.max(speeds.iter().map(|v| v * v).sum());
        })?;
        // (2 v)²/2 is four times the energy v²/2; √2 v has twice of it.
        let largest = (2.0 * largest).sqrt();
        Ok(Self { model, settings, mode, sign, main, starts, ends, largest })
    }

    /// So many sizes, ascending by this ratio, up to a multiple of the largest.
    fn sizes(&self, (count, ratio): (usize, f64), multiple: f64) -> Vec<f64> {
        (0..count).rev().map(|i| multiple * self.largest / ratio.powi(i as i32)).collect()
    }

    /// Goes on with a scan by these sizes until a push of one of them ends on the branch. `None` if the observer breaks.
    fn upwards(&self, sizes: Vec<f64>, found: &mut Disturbance, observer: &mut PushObserver<'_>) -> Option<()> {
        for size in sizes {
            let row = self.row(size, observer)?;
            let last = found.endings.len().saturating_sub(found.phases);
            let before = |phase: usize| found.endings.get(last + phase).copied().unwrap_or(Ending::Back);
            let below = found.sizes.last().copied().unwrap_or(0.0);
            let hits = (0..found.phases).filter(|&phase| row[phase] == Ending::Onto);
            let hits: Vec<Push> =
                hits.map(|phase| Push { phase, size, below, ends: before(phase), is_confirmed: false }).collect();
            found.sizes.push(size);
            found.endings.extend(&row);
            if !hits.is_empty() {
                found.push = self.smallest(hits, observer)?;
                break;
            }
        }
        Some(())
    }

    /// Where pushes of a size end, phase by phase.
    fn row(&self, size: f64, observer: &mut PushObserver<'_>) -> Option<Vec<Ending>> {
        let ending = |phase| {
            let (ending, amplitude) = self.ending(phase, size, NEAR);
            observer(amplitude).is_continue().then_some(ending)
        };
        (0..self.starts.len()).map(ending).collect()
    }

    /// Bisects the first change at each phase, and confirms the smallest.
    fn smallest(&self, starts: Vec<Push>, observer: &mut PushObserver<'_>) -> Option<Option<Push>> {
        let mut best: Option<Push> = None;
        for start in starts {
            let mut push = start;
            // What cannot become smaller than the best one is not looked at any further.
            while push.size - push.below > self.settings.resolution * push.size
                && best.is_none_or(|best| push.below < best.size)
            {
                let middle = 0.5 * (push.below + push.size);
                let (ending, amplitude) = self.ending(push.phase, middle, NEAR);
                match ending {
                    Ending::Onto => push.size = middle,
                    ends => (push.below, push.ends) = (middle, ends),
                }
                if observer(amplitude).is_break() {
                    return None;
                }
            }
            if best.is_none_or(|best| push.size < best.size) {
                best = Some(push);
            }
        }
        Some(best.map(|push| {
            let again = |size: f64| self.ending(push.phase, size, SURE).0;
            let is_confirmed =
                again(push.size) == Ending::Onto && (push.below == 0.0 || again(push.below) == push.ends);
            Push { is_confirmed, ..push }
        }))
    }

    /// Where a push ends, in a motion that comes within a share of the orbits' distance to one of them; and the largest |x| of the
    /// first monitored dof in its last period, m.
    fn ending(&self, phase: usize, size: f64, near: f64) -> (Ending, f64) {
        let marching = self.pushed(phase, size);
        marching.map_or((Ending::Elsewhere, f64::NAN), |mut marching| {
            self.ends.of(&mut marching, self.settings.periods, near)
        })
    }

    /// The main motion after a push, at the beginning of a period.
    fn pushed(&self, phase: usize, size: f64) -> Result<Marching<'m>, MarchingError> {
        let (step, state) = &self.starts[phase];
        let mut state = state.clone();
        state[self.model.size() + self.mode] += self.sign * size;
        let mut marching = Marching::with_steps(self.model, self.main.steps, self.main.forcing, self.main.omega)?;
        marching.restart_at(&state, *step)?;
        walk_to(&mut marching, self.main.steps)?;
        Ok(marching)
    }
}
