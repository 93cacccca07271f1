//! Forced responses: the linear start, tracing a branch to both ends, its special points, identity of branches.

use crate::curve::continuation::Continuation;
use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::problem::Failure;
use crate::curve::walk::{Bounds, Walked, relative_distance, walk, walk_both};
use crate::formulation::harmonics::complex;
use crate::formulation::linear::forced_response;
use crate::formulation::modal::Modal;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError};
use crate::response::backbone::Backbone;
use crate::response::branch::{Branch, BranchKind, BranchPoint, Certificate, Observer, Outcome, Side, Stop};
use crate::response::forcing::{Unreached, from_rest};
use crate::response::special::with_special_points;
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

/// Forced responses at one forcing amplitude, by any formulation.
pub struct Forced<'m, F = PressureForm<'m>> {
    model: &'m Model,
    /// The system, ω free.
    problem: F,
    settings: Settings,
    bounds: Bounds,
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
        let bounds = Bounds {
            frequency: reach.frequency,
            amplitude: reach.amplitude,
            points: settings.branch.max_points,
            closure: Some(settings.branch.closure),
        };
        Ok(Self { model, problem, settings: *settings, bounds, forcing })
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

    /// Where a main branch is entered: the response at a frequency bound. It is the linear response if that is one, and
    /// otherwise what continuation in the forcing amplitude leads to from the linear range.
    ///
    /// # Errors
    /// If there is none.
    pub fn main_start(&mut self, side: Side) -> Result<State, Unreached> {
        let omega = match side {
            Side::Below => self.bounds.frequency.0,
            Side::Above => self.bounds.frequency.1,
        };
        let linear = forced_response(&self.problem, self.forcing, omega).map_err(|_| Failure::Singular)?;
        match self.converge(&linear) {
            Ok(state) if self.distance(&state, &linear) < 1e-3 => Ok(state),
            _ => from_rest::<F>(self.model, &self.settings, self.forcing, omega),
        }
    }

    /// The main branch: from the frequency bound of a side towards the other one, from [`Forced::main_start`] on.
    ///
    /// # Errors
    /// If there is no first point.
    pub fn main_branch(&mut self, side: Side, observer: &mut Observer<'_>) -> Result<Branch, Unreached> {
        let start = self.main_start(side)?;
        let y = self.problem.encode(&start);
        let mut inwards = self.problem.parameter_row();
        if side == Side::Above {
            inwards.iter_mut().for_each(|entry| *entry = -*entry);
        }
        let mut continuation = Continuation::start(&mut self.problem, y, &inwards, self.settings.continuation)?;
        let (visited, stop) = walk(&mut continuation, &Bounds { closure: None, ..self.bounds }, observer);
        let rejections = continuation.rejections();
        let walked = Walked { visited, start: 0, outcome: Outcome::Open(Stop::Start, stop), rejections };
        Ok(self.finish(walked, BranchKind::Main))
    }

    /// The branch through a converged state: forwards, and if it does not close, backwards as well.
    ///
    /// # Errors
    /// If the state does not converge again.
    pub fn branch_through(&mut self, state: &State, observer: &mut Observer<'_>) -> Result<Branch, Failure> {
        let y = self.problem.encode(state);
        let upwards = self.problem.parameter_row();
        let settings = self.settings.continuation;
        let walked = walk_both(&mut self.problem, y, &upwards, &settings, &self.bounds, observer)?;
        let kind = BranchKind::of_detached(&walked.outcome);
        Ok(self.finish(walked, kind))
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

    /// Whether a state lies within the bounds of branches.
    pub fn contains(&mut self, state: &State) -> bool {
        let (low, high) = self.bounds.frequency;
        let monitored = self.model.modes().shapes.row(self.model.monitors()[0]);
        let amplitude = self.problem.aft().max_abs(&state.combine(monitored.iter().copied()));
        (low..=high).contains(&state.omega) && amplitude <= self.bounds.amplitude
    }

    /// Converges a state at its own frequency (damped Newton). The result may lie anywhere: compare it.
    ///
    /// # Errors
    /// If Newton's method fails.
    pub fn converge(&mut self, state: &State) -> Result<State, Failure> {
        let mut y = self.problem.encode(state);
        let origin = y.clone();
        let row = self.problem.parameter_row();
        let settings = NewtonSettings { damped: true, max_iterations: 40, ..self.settings.continuation.newton };
        let constraint = Constraint::Hyperplane { row: &row, origin: &origin };
        Newton::default().solve(&mut self.problem, &mut y, constraint, &settings)?;
        self.problem.decode(&y).map_err(|_| Failure::Singular)
    }

    /// Relative distance ‖a − b‖/‖b‖ of two states, up to the time shifts 2πj/m that leave the forcing unchanged.
    pub fn distance(&self, a: &State, b: &State) -> f64 {
        let m = self.problem.modal().harmonic();
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
    fn finish(&mut self, walked: Walked<BranchPoint>, kind: BranchKind) -> Branch {
        let (outcome, rejections) = (walked.outcome, walked.rejections);
        let (points, special) = with_special_points(&mut self.problem, self.settings.continuation, walked);
        let certificate = Certificate::default();
        Branch { kind, forcing: self.forcing, points, special, outcome, rejections, certificate }
    }
}
