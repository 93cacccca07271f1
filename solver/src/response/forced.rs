//! Forced responses: the linear start, tracing a branch to both ends, its special points, identity of branches.

use crate::curve::continuation::Continuation;
use crate::curve::identity::Identity;
use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::problem::Failure;
use crate::curve::walk::{Bounds, Walked, begin_at_bound, end_at_bound, relative_distance, walk, walk_both};
use crate::formulation::harmonics::complex;
use crate::formulation::linear::forced_response;
use crate::formulation::modal::Modal;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError};
use crate::response::backbone::Backbone;
use crate::response::branch::{Branch, BranchKind, BranchPoint, Certificate, Observer, Outcome, Side, Stop, Visited};
use crate::response::forcing::{Unreached, from_rest};
use crate::response::special::with_special_points;
use crate::settings::{Settings, SettingsError};
use crate::structure::Model;
use serde::{Deserialize, Serialize};

/// Within which frequencies and amplitudes branches are followed: settings, completed by the backbone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// Lowest and highest frequency of the study, rad/s.
    pub frequency: (f64, f64),
    /// Amplitude of the first monitored dof up to which responses are expected, m; a bound only if the settings give one.
    pub amplitude: f64,
    /// Lowest and highest frequency that the backbone suggests, rad/s: 10 % beyond its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub natural: Option<(f64, f64)>,
}

impl Reach {
    /// As set; where nothing is set, 10 % beyond the backbone's frequencies and three times its largest amplitude.
    ///
    /// # Errors
    /// If a bound that is set lies on the wrong side of one that the backbone gives.
    pub fn new(settings: &Settings, backbone: &Backbone) -> Result<Self, SettingsError> {
        let (low, high) = backbone.frequency_range();
        // Nobody knows where a backbone that ends early would have gone.
        let end = match settings.backbone.max_frequency {
            _ if !backbone.outcome.is_unfinished() => high,
            Some(bound) => bound,
            None => high.max(FAR * low),
        };
        let natural = (0.9 * low, 1.1 * end);
        let (low, high) = (settings.frequency.min.unwrap_or(natural.0), settings.frequency.max.unwrap_or(natural.1));
        if low >= high {
            let remedy = format!("the lower frequency bound is {low}: use a higher one");
            return Err(SettingsError { key: "frequency.max", value: high.to_string(), remedy });
        }
        let amplitude = settings.branch.max_amplitude.unwrap_or(3.0 * backbone.max_amplitude());
        Ok(Self { frequency: (low, high), amplitude, natural: Some(natural) })
    }

    /// Frequencies that main branches are walked through even if their response is linear at the study's bounds.
    fn swept(&self) -> (f64, f64) {
        let (low, high) = self.natural.unwrap_or(self.frequency);
        (low.min(self.frequency.0), high.max(self.frequency.1))
    }
}

/// Where a backbone ends early, main branches are walked up to this multiple of its lowest frequency.
const FAR: f64 = 4.0;

/// Beyond the frequencies swept, branches are followed down to half the lowest and up to twice the highest.
const WIDEST: (f64, f64) = (0.5, 2.0);

/// No branch is followed beyond this multiple of the largest amplitude that backbone, scales and linear resonance suggest.
const RUNAWAY: f64 = 1e4;

/// Relative distance of a response from the linear one up to which it counts as linear.
const LINEAR: f64 = 1e-3;

/// Relative distance of a response from the linear one up to which it counts as the ordinary response, if Newton's method leads
/// there from the linear one.
const ORDINARY: f64 = 0.3;

/// Forced responses at one forcing amplitude, by any formulation.
pub struct Forced<'m, F = PressureForm<'m>> {
    model: &'m Model,
    /// The system, ω free.
    problem: F,
    settings: Settings,
    reach: Reach,
    identity: Identity,
    forcing: f64,
}

impl<'m> Forced<'m> {
    /// Forced responses of `model` at forcing amplitude `forcing`, in pressure form.
    pub fn new(model: &'m Model, settings: &Settings, reach: Reach, forcing: f64) -> Self {
        Self::build(model, settings, reach, forcing).expect("every model has a pressure form")
    }
}

impl<'m, F: Formulation<'m>> Forced<'m, F> {
    /// Forced responses of `model` at forcing amplitude `forcing`, in any formulation.
    ///
    /// # Errors
    /// If the formulation does not fit the model.
    pub fn build(model: &'m Model, settings: &Settings, reach: Reach, forcing: f64) -> Result<Self, FormulationError> {
        let scales = Scales::new(model, settings.tracked());
        let unknown = Unknown::Frequency { forcing };
        let problem = F::build(model, settings.harmonics, settings.tracked(), unknown, scales)?;
        Ok(Self { model, problem, settings: *settings, reach, identity: Identity::default(), forcing })
    }

    /// The structure.
    pub fn model(&self) -> &'m Model {
        self.model
    }

    /// The system, ω free.
    pub fn problem(&mut self) -> &mut F {
        &mut self.problem
    }

    /// Its forcing and channels in modal coordinates.
    pub fn modal(&self) -> &Modal {
        self.problem.modal()
    }

    /// Within which frequencies and amplitudes branches are followed.
    pub fn reach(&self) -> Reach {
        self.reach
    }

    /// Forcing amplitude A.
    pub fn forcing(&self) -> f64 {
        self.forcing
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Frequencies beyond which nothing is followed.
    fn widest(&self) -> (f64, f64) {
        let (low, high) = self.reach.swept();
        (WIDEST.0 * low, WIDEST.1 * high)
    }

    fn bounds(&self, frequency: (f64, f64), closes: bool) -> Bounds {
        let scales = self.problem.scales();
        let linear = scales.length * self.forcing / scales.forcing;
        let runaway = RUNAWAY * self.reach.amplitude.max(scales.length).max(linear);
        let amplitude = self.settings.branch.max_amplitude.unwrap_or(runaway);
        Bounds { frequency, amplitude, points: self.settings.branch.max_points, closes }
    }

    /// The main branch: what ordinary continuation from below or from above reaches. It starts where the response is linear, at
    /// the end of the range or beyond, and otherwise where continuation in the forcing amplitude leads from the linear range at
    /// the widest bound; it is followed beyond the study's bounds until the response there is the ordinary one.
    ///
    /// # Errors
    /// If there is no first point.
    pub fn main_branch(&mut self, side: Side, observer: &mut Observer<'_>) -> Result<Branch, Unreached> {
        let start = self.main_start(side)?;
        let y = self.problem.encode(&start);
        let mut direction = self.problem.parameter_row();
        if side == Side::Above {
            direction.iter_mut().for_each(|d| *d = -*d);
        }
        let bounds = self.bounds(self.widest(), false);
        let (swept, study) = (self.reach.swept(), self.reach.frequency);
        let newton = self.landing();
        let mut continuation = Continuation::start(&mut self.problem, y, &direction, self.settings.continuation)?;
        let mut ending = |problem: &mut F, last: &Visited| {
            let (omega, towards) = (last.point.omega(), last.curve.tangent[problem.len() - problem.parameters()]);
            let leaves = (omega < swept.0 && towards < 0.0) || (omega > swept.1 && towards > 0.0);
            (leaves && is_ordinary(problem, &newton, &last.point.state)).then_some(Stop::FrequencyBound)
        };
        let (visited, stop) = walk(&mut continuation, &bounds, observer, &mut ending);
        let visited = trimmed(&mut continuation, visited, study);
        let rejections = continuation.rejections();
        let walked = Walked { visited, start: 0, outcome: Outcome::Open(Stop::Start, stop), rejections };
        Ok(self.finish(walked, BranchKind::Main))
    }

    /// First state of a main branch.
    fn main_start(&mut self, side: Side) -> Result<State, Unreached> {
        let end = |(low, high): (f64, f64)| if side == Side::Below { low } else { high };
        let mut last = 0.0;
        for omega in [end(self.reach.swept()), end(self.widest())] {
            let linear = forced_response(&self.problem, self.forcing, omega).map_err(|_| Failure::Singular)?;
            match self.converge(&linear) {
                Ok(state) if self.distance(&state, &linear) < LINEAR => return Ok(state),
                _ => last = omega,
            }
        }
        let started = from_rest::<F>(self.model, &self.settings, self.forcing, last);
        started.or_else(|_| from_rest::<F>(self.model, &self.settings, self.forcing, end(self.reach.swept())))
    }

    /// Whether a response is what grows out of the linear one: linear, or not far from it and what Newton's method finds from
    /// there.
    pub fn is_ordinary(&mut self, state: &State) -> bool {
        let newton = self.landing();
        is_ordinary(&mut self.problem, &newton, state)
    }

    /// The branch through a converged state: forwards, and if it does not close, backwards as well. Bounds that the settings
    /// give end it; others do not.
    ///
    /// # Errors
    /// If the state does not converge again.
    pub fn branch_through(&mut self, state: &State, observer: &mut Observer<'_>) -> Result<Branch, Failure> {
        let y = self.problem.encode(state);
        let upwards = self.problem.parameter_row();
        let (widest, study) = (self.widest(), self.reach.frequency);
        let low = if self.settings.frequency.min.is_some() { study.0 } else { widest.0 };
        let high = if self.settings.frequency.max.is_some() { study.1 } else { widest.1 };
        let (bounds, settings) = (self.bounds((low, high), true), self.settings.continuation);
        let walked = walk_both(&mut self.problem, y, &upwards, &settings, &bounds, observer)?;
        let kind = BranchKind::of_detached(&walked.outcome, self.is_cut(&walked));
        Ok(self.finish(walked, kind))
    }

    /// Whether a curve ends at a bound that the settings give.
    fn is_cut(&self, walked: &Walked<BranchPoint>) -> bool {
        let Outcome::Open(first, last) = walked.outcome else { return false };
        let (given, (low, high)) = (self.settings.frequency, self.reach.frequency);
        let ends = [(first, walked.visited.first()), (last, walked.visited.last())];
        ends.into_iter().any(|(stop, end)| match (stop, end) {
            (Stop::FrequencyBound, Some(end)) => {
                let at = end.point.omega();
                (given.min.is_some() && at <= low * (1.0 + 1e-6)) || (given.max.is_some() && at >= high * (1.0 - 1e-6))
            }
            (Stop::AmplitudeBound, _) => self.settings.branch.max_amplitude.is_some(),
            _ => false,
        })
    }

    /// Forced responses of a branch close to quadrature with the forcing, Re(X_m·s) = 0: the resonances.
    pub fn resonances(&self, branch: &Branch) -> Vec<State> {
        let real = |point: &BranchPoint| self.problem.modal().forcing_projection(&point.state).re;
        let count = branch.points.len();
        let last = if branch.is_closed() { count } else { count.saturating_sub(1) };
        let pairs = (0..last).map(|i| (&branch.points[i], &branch.points[(i + 1) % count]));
        let crossings = pairs.filter(|(a, b)| real(a) * real(b) < 0.0);
        crossings.map(|(a, b)| a.state.interpolate(&b.state, real(a) / (real(a) - real(b)))).collect()
    }

    /// Whether a state lies within the bounds that the settings give, and within the widest ones.
    pub fn contains(&mut self, state: &State) -> bool {
        let (low, high) = self.widest();
        let (low, high) = (self.settings.frequency.min.unwrap_or(low), self.settings.frequency.max.unwrap_or(high));
        let monitored = self.model.modes().shapes.row(self.model.monitors()[0]);
        let amplitude = self.problem.aft().max_abs(&state.combine(monitored.iter().copied()));
        (low..=high).contains(&state.omega) && amplitude <= self.bounds((low, high), true).amplitude
    }

    /// Settings of Newton's method for states that may be far from a solution.
    fn landing(&self) -> NewtonSettings {
        NewtonSettings { damped: true, max_iterations: 40, ..self.settings.continuation.newton }
    }

    /// Converges a state at its own frequency (damped Newton). The result may lie anywhere: compare it.
    ///
    /// # Errors
    /// If Newton's method fails.
    pub fn converge(&mut self, state: &State) -> Result<State, Failure> {
        let settings = self.landing();
        converge(&mut self.problem, &settings, state)
    }

    /// Relative distance ‖a − b‖/‖b‖ of two states, up to the time shifts 2πj/m that leave the forcing unchanged.
    pub fn distance(&self, a: &State, b: &State) -> f64 {
        distance(&self.problem, a, b)
    }

    /// Relative distance ‖a − b‖/‖b‖ of two motions whatever their phases: aligned by the first harmonic of the mode
    /// followed.
    pub fn motion_distance(&self, a: &State, b: &State) -> f64 {
        let phase = |state: &State| complex(state.mode(self.settings.tracked()), 1).arg();
        let aligned = a.shifted(phase(b) - phase(a));
        relative_distance(self.problem.motion_metric(), &self.problem.encode(&aligned), &self.problem.encode(b))
    }

    /// Whether a converged state, or a time shift of it that leaves the forcing unchanged, lies on `branch`.
    pub fn lies_on(&mut self, state: &State, branch: &Branch) -> bool {
        let newton = self.settings.continuation.newton;
        let target = self.problem.encode(state);
        let targets: Vec<Vec<f64>> =
            (0..self.problem.images()).map(|index| self.problem.image(&target, index)).collect();
        let points: Vec<Vec<f64>> = branch.points.iter().map(|point| self.problem.encode(&point.state)).collect();
        let last = if branch.is_closed() { points.first() } else { None };
        let successors = points.iter().skip(1).chain(last);
        points
            .iter()
            .zip(successors)
            .any(|(a, b)| targets.iter().any(|target| self.identity.passes(&mut self.problem, &newton, [a, b], target)))
    }

    /// Locates folds and peak, and drops what only the continuation needs.
    fn finish(&mut self, walked: Walked<BranchPoint>, kind: BranchKind) -> Branch {
        let (outcome, rejections) = (walked.outcome, walked.rejections);
        let (points, special) = with_special_points(&mut self.problem, self.settings.continuation, walked);
        let certificate = Certificate::default();
        Branch { kind, forcing: self.forcing, points, special, outcome, rejections, certificate }
    }
}

/// See [`Forced::converge`].
fn converge<'m, F: Formulation<'m>>(
    problem: &mut F,
    settings: &NewtonSettings,
    state: &State,
) -> Result<State, Failure> {
    let mut y = problem.encode(state);
    let origin = y.clone();
    let row = problem.parameter_row();
    let constraint = Constraint::Hyperplane { row: &row, origin: &origin };
    Newton::default().solve(problem, &mut y, constraint, settings)?;
    problem.decode(&y).map_err(|_| Failure::Singular)
}

/// See [`Forced::distance`].
fn distance<'m, F: Formulation<'m>>(problem: &F, a: &State, b: &State) -> f64 {
    let (from, target) = (problem.encode(a), problem.encode(b));
    (0..problem.images())
        .map(|index| relative_distance(problem.motion_metric(), &problem.image(&from, index), &target))
        .fold(f64::INFINITY, f64::min)
}

/// See [`Forced::is_ordinary`].
fn is_ordinary<'m, F: Formulation<'m>>(problem: &mut F, settings: &NewtonSettings, state: &State) -> bool {
    let Ok(linear) = forced_response(problem, state.forcing, state.omega) else { return false };
    let away = distance(problem, state, &linear);
    away < LINEAR
        || (away < ORDINARY
            && converge(problem, settings, &linear).is_ok_and(|found| distance(problem, &found, state) < 1e-6))
}

/// What is left of a walk if it begins where it first enters a range of frequencies and ends where it last leaves it, with
/// points at the bounds themselves. A walk that is never inside, or does not leave, keeps its end.
fn trimmed<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    mut visited: Vec<Visited>,
    (low, high): (f64, f64),
) -> Vec<Visited> {
    let slack = 1e-9 * high;
    let inside = |v: &Visited| (low - slack..=high + slack).contains(&v.point.omega());
    let (Some(first), Some(last)) = (visited.iter().position(inside), visited.iter().rposition(inside)) else {
        return visited;
    };
    if last + 1 < visited.len() {
        visited.truncate(last + 2);
        end_at_bound(continuation, &mut visited, (low, high));
    }
    if first > 0 {
        visited.drain(..first - 1);
        begin_at_bound(continuation, &mut visited, (low, high));
    }
    visited
}
