//! Forced responses: the linear start, tracing a branch to both ends, its special points, identity of branches.

use crate::curve::continuation::Continuation;
use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::problem::{Failure, Problem, norm};
use crate::formulation::harmonics::complex;
use crate::formulation::linear::forced_response;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::response::backbone::Backbone;
use crate::response::branch::{Branch, BranchPoint, Outcome, SpecialKind, SpecialPoint, Stop};
use crate::response::extrema::{Maximum, Measure, insert_maxima, locate_maximum, turning_points};
use crate::response::forcing::from_rest;
use crate::response::melnikov::forcing_projection;
use crate::response::walk::{Bounds, Observer, Visited, Walked, relative_distance, walk, walk_both};
use crate::settings::{Settings, SettingsError};
use crate::structure::Model;
use serde::{Deserialize, Serialize};

/// Within which frequencies and amplitudes branches are followed: settings, completed by the backbone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// Lowest and highest frequency, rad/s.
    pub frequency: (f64, f64),
    /// Largest amplitude of the first monitored dof, m.
    pub amplitude: f64,
}

impl Reach {
    /// As set; where nothing is set, 10 % beyond the backbone's frequencies and three times its largest amplitude.
    ///
    /// # Errors
    /// If a bound that is set lies on the wrong side of one that the backbone gives.
    pub fn new(settings: &Settings, backbone: &Backbone) -> Result<Self, SettingsError> {
        let (low, high) = backbone.frequency_range();
        let (low, high) = (settings.frequency.min.unwrap_or(0.9 * low), settings.frequency.max.unwrap_or(1.1 * high));
        if low >= high {
            let remedy = format!("the lower frequency bound is {low}: use a higher one");
            return Err(SettingsError { key: "frequency.max", value: high.to_string(), remedy });
        }
        let amplitude = settings.branch.max_amplitude.unwrap_or(3.0 * backbone.max_amplitude());
        Ok(Self { frequency: (low, high), amplitude })
    }
}

/// Forced responses at one forcing amplitude.
pub struct Forced<'m> {
    /// The system, ω free.
    pub problem: PressureForm<'m>,
    settings: Settings,
    bounds: Bounds,
    forcing: f64,
}

impl<'m> Forced<'m> {
    /// Forced responses of `model` at forcing amplitude `forcing`.
    pub fn new(model: &'m Model, settings: &Settings, reach: Reach, forcing: f64) -> Self {
        let scales = Scales::new(model, settings.tracked());
        let problem = PressureForm::new(model, settings.harmonics, settings.tracked(), Unknown::Frequency, scales);
        let bounds = Bounds {
            frequency: reach.frequency,
            amplitude: reach.amplitude,
            points: settings.branch.max_points,
            closure: Some(settings.branch.closure),
        };
        let mut forced = Self { problem, settings: *settings, bounds, forcing };
        forced.problem.set_forcing(forcing);
        forced
    }

    /// Within which frequencies and amplitudes branches are followed.
    pub fn reach(&self) -> Reach {
        Reach { frequency: self.bounds.frequency, amplitude: self.bounds.amplitude }
    }

    /// Forcing amplitude A.
    pub fn forcing(&self) -> f64 {
        self.forcing
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The main branch: from the lower frequency bound upwards. It starts at the linear response if that is one, and
    /// otherwise where continuation in the forcing amplitude leads from the linear range.
    pub fn main_branch(&mut self, observer: &mut Observer<'_>) -> Result<Branch, Failure> {
        let omega = self.bounds.frequency.0;
        let linear = forced_response(&self.problem, self.forcing, omega).map_err(|_| Failure::Singular)?;
        let start = match self.converge(&linear) {
            Ok(state) if self.distance(&state, &linear) < 1e-3 => state,
            _ => from_rest(self.problem.model(), &self.settings, self.forcing, omega)?,
        };
        let y = self.problem.encode(&start);
        let upwards = self.problem.parameter_row();
        let mut continuation = Continuation::start(&mut self.problem, y, &upwards, self.settings.continuation)?;
        let (visited, stop) = walk(&mut continuation, &Bounds { closure: None, ..self.bounds }, observer);
        let rejections = continuation.rejections();
        let walked = Walked { visited, start: 0, outcome: Outcome::Open(Stop::Start, stop), rejections };
        Ok(self.finish(walked))
    }

    /// The branch through a converged state: forwards, and if it does not close, backwards as well.
    pub fn branch_through(&mut self, state: &State, observer: &mut Observer<'_>) -> Result<Branch, Failure> {
        let y = self.problem.encode(state);
        let upwards = self.problem.parameter_row();
        let settings = self.settings.continuation;
        let walked = walk_both(&mut self.problem, y, &upwards, &settings, &self.bounds, observer)?;
        Ok(self.finish(walked))
    }

    /// Forced responses of a branch close to quadrature with the forcing, Re(X_m·s) = 0: the resonances.
    pub fn resonances(&self, branch: &Branch) -> Vec<State> {
        let real = |point: &BranchPoint| forcing_projection(&self.problem, &point.state).re;
        let count = branch.points.len();
        let last = if branch.is_closed() { count } else { count.saturating_sub(1) };
        let pairs = (0..last).map(|i| (&branch.points[i], &branch.points[(i + 1) % count]));
        let crossings = pairs.filter(|(a, b)| real(a) * real(b) < 0.0);
        crossings.map(|(a, b)| a.state.interpolate(&b.state, real(a) / (real(a) - real(b)))).collect()
    }

    /// Whether a state lies within the bounds of branches.
    pub fn contains(&mut self, state: &State) -> bool {
        let (low, high) = self.bounds.frequency;
        let monitored = self.problem.model().modes.shapes.row(self.problem.model().monitors[0]);
        let amplitude = self.problem.aft().max_abs(&state.combine(monitored.iter().copied()));
        (low..=high).contains(&state.omega) && amplitude <= self.bounds.amplitude
    }

    /// Converges a state at its own frequency (damped Newton). The result may lie anywhere: compare it.
    pub fn converge(&mut self, state: &State) -> Result<State, Failure> {
        let mut y = self.problem.encode(state);
        let origin = y.clone();
        let row = self.problem.parameter_row();
        let settings = NewtonSettings { damped: true, max_iterations: 40, ..self.settings.continuation.newton };
        let constraint = Constraint::Hyperplane { row: &row, origin: &origin };
        Newton::default().solve(&mut self.problem, &mut y, constraint, &settings)?;
        Ok(self.problem.decode(&y))
    }

    /// Relative distance ‖a − b‖/‖b‖ of two states, up to the time shifts 2πj/m that leave the forcing unchanged.
    pub fn distance(&self, a: &State, b: &State) -> f64 {
        let m = self.problem.model().forcing.harmonic;
        let target = self.problem.encode(b);
        (0..m)
            .map(|j| {
                let shifted = a.shifted(std::f64::consts::TAU * j as f64 / m as f64);
                relative_distance(self.problem.motion_metric(), &self.problem.encode(&shifted), &target)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Relative distance ‖a − b‖/‖b‖ of two motions whatever their phases: aligned by the first harmonic of the mode
    /// followed.
    pub fn motion_distance(&self, a: &State, b: &State) -> f64 {
        let phase = |state: &State| complex(state.mode(self.settings.tracked()), 1).arg();
        let aligned = a.shifted(phase(b) - phase(a));
        relative_distance(self.problem.motion_metric(), &self.problem.encode(&aligned), &self.problem.encode(b))
    }

    /// Whether a converged state lies on `branch`: the branch is interpolated at the state's frequency, and converged
    /// there.
    pub fn lies_on(&mut self, state: &State, branch: &Branch) -> bool {
        let count = branch.points.len();
        let pairs = if branch.is_closed() { count } else { count.saturating_sub(1) };
        for i in 0..pairs {
            let (a, b) = (&branch.points[i].state, &branch.points[(i + 1) % count].state);
            let (low, high) = (a.omega.min(b.omega), a.omega.max(b.omega));
            let slack = 1e-9 * high;
            if state.omega < low - slack || state.omega > high + slack {
                continue;
            }
            let share = if b.omega == a.omega { 0.5 } else { (state.omega - a.omega) / (b.omega - a.omega) };
            let mut between = a.interpolate(b, share);
            between.omega = state.omega;
            let rough = self.distance(&between, state);
            if rough < 1e-4 {
                return true;
            }
            if rough < 0.3
                && let Ok(converged) = self.converge(&between)
                && self.distance(&converged, state) < 1e-6
            {
                return true;
            }
        }
        false
    }

    /// Locates folds and peak, and drops what only the continuation needs.
    fn finish(&mut self, walked: Walked) -> Branch {
        let Walked { visited, start, outcome, rejections } = walked;
        let closed = outcome == Outcome::Closed;
        let mut maxima = vec![Maximum { anchor: start, located: None }];
        let mut kinds = vec![SpecialKind::Start];
        let first = visited[start].curve.clone();
        if let Ok(mut continuation) =
            Continuation::start(&mut self.problem, first.y.clone(), &first.tangent, self.settings.continuation)
        {
            for (anchor, sign) in frequency_folds(&visited, closed) {
                let measure = move |_: &mut PressureForm<'_>, v: &Visited| sign * v.point.omega();
                maxima.push(refine(&mut continuation, &visited, anchor, closed, &measure));
                kinds.resize(maxima.len(), SpecialKind::Fold);
            }
            let amplitude = |v: &Visited| v.point.amplitude();
            let peak = (0..visited.len()).max_by(|&a, &b| amplitude(&visited[a]).total_cmp(&amplitude(&visited[b])));
            let measure = move |_: &mut PressureForm<'_>, v: &Visited| v.point.amplitude();
            maxima.push(refine(&mut continuation, &visited, peak.unwrap_or(0), closed, &measure));
            kinds.resize(maxima.len(), SpecialKind::Peak);
        }
        let (visited, indices) = insert_maxima(visited, maxima);
        let mut special: Vec<SpecialPoint> =
            kinds.into_iter().zip(indices).map(|(kind, index)| SpecialPoint { kind, index }).collect();
        // A fold may turn out higher than the point refined from the highest step.
        let highest = |a: &usize, b: &usize| visited[*a].point.amplitude().total_cmp(&visited[*b].point.amplitude());
        if let Some(index) = (0..visited.len()).max_by(highest) {
            special.retain(|s| s.kind != SpecialKind::Peak);
            special.push(SpecialPoint { kind: SpecialKind::Peak, index });
        }
        special.sort_by_key(|s| s.index);
        let points: Vec<BranchPoint> = visited.into_iter().map(|v| v.point).collect();
        Branch { forcing: self.forcing, points, special, outcome, rejections }
    }
}

/// Turning points in frequency, (index, +1 for a maximum or −1 for a minimum); those that the sampled contact makes by
/// changing one sample at a time are too shallow to count.
fn frequency_folds(visited: &[Visited], closed: bool) -> Vec<(usize, f64)> {
    let omegas: Vec<f64> = visited.iter().map(|v| v.point.omega()).collect();
    let scale = omegas.iter().fold(0.0f64, |m, w| m.max(w.abs()));
    let n = omegas.len();
    if closed {
        // Rotated to start at the lowest frequency, so that the ends of the list are no folds of their own.
        let lowest = (0..n).min_by(|&a, &b| omegas[a].total_cmp(&omegas[b])).unwrap_or(0);
        let rotated: Vec<f64> = (0..=n).map(|i| omegas[(lowest + i) % n]).collect();
        let mut folds = turning_points(&rotated, 1e-5 * scale);
        folds.pop();
        return folds.into_iter().map(|(i, max)| ((lowest + i) % n, if max { 1.0 } else { -1.0 })).collect();
    }
    turning_points(&omegas, 1e-5 * scale)
        .into_iter()
        .filter(|&(i, _)| i > 0 && i + 1 < n)
        .map(|(i, max)| (i, if max { 1.0 } else { -1.0 }))
        .collect()
}

fn refine(
    continuation: &mut Continuation<'_, PressureForm<'_>>,
    visited: &[Visited],
    anchor: usize,
    closed: bool,
    measure: &Measure<'_>,
) -> Maximum {
    let n = visited.len();
    if n < 3 || (!closed && (anchor == 0 || anchor + 1 == n)) {
        return Maximum { anchor, located: None };
    }
    let (before, after) = ((anchor + n - 1) % n, (anchor + 1) % n);
    let arc = |a: usize, b: usize, problem: &PressureForm<'_>| {
        let difference: Vec<f64> = visited[a].curve.y.iter().zip(&visited[b].curve.y).map(|(a, b)| a - b).collect();
        norm(problem.metric(), &difference)
    };
    let problem = continuation.problem();
    let arcs = (arc(before, anchor, problem), arc(anchor, after, problem));
    let values = [before, anchor, after].map(|i| measure(problem, &visited[i]));
    locate_maximum(continuation, visited, anchor, arcs, values, measure)
}
