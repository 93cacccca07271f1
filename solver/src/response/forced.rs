//! Forced responses: the linear start, tracing a main branch, special points, identity of branches.

mod between;
mod detached;

use crate::curve::continuation::Continuation;
use crate::curve::identity::Identity;
use crate::curve::newton::NewtonSettings;
use crate::curve::problem::Failure;
use crate::curve::record::Recorder;
use crate::curve::walk::{Bounds, TracedCurve, relative_distance, walk};
use crate::formulation::harmonics::complex;
use crate::formulation::linear::forced_response;
use crate::formulation::modal::Modal;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError};
use crate::response::branch::{
    Branch, BranchKind, BranchPoint, Certificate, Observer, Outcome, Side, Stop, TracedPoint,
};
use crate::response::folds::{Critical, CriticalCurve, CriticalError, Extent, Quantity};
use crate::response::forcing::{Unreached, from_rest};
use crate::response::interrupt::Interrupt;
use crate::response::orders::Shorter;
use crate::response::ordinary::{Departure, LINEAR, Study, converge, distance, is_ordinary, main_part};
pub use crate::response::search_range::SearchRange;
use crate::response::special::with_special_points;
use crate::response::truncation::certificate;
use crate::settings::Settings;
use crate::structure::Model;

/// Beyond the frequencies swept, branches are followed down to a tenth of the lowest and up to ten times the highest.
const WIDEST: (f64, f64) = (0.1, 10.0);

/// Main branches are followed so many times further up, unless an upper bound is given: with hardly any damping, springs that
/// harden lead a resonance that far before it turns back.
const FARTHEST: f64 = 100.0;

/// Where the response is not linear at the ends of the frequencies swept, main branches start at half the lowest or twice the
/// highest.
const OUTSIDE: (f64, f64) = (0.5, 2.0);

/// No branch is followed beyond this multiple of the largest amplitude that backbone, scales and linear resonance suggest.
const RUNAWAY: f64 = 1e4;

/// Forced responses at one forcing amplitude, by any formulation.
pub struct Forced<'m, F = PressureForm<'m>> {
    model: &'m Model,
    /// The system, ω free.
    problem: F,
    settings: Settings,
    reach: SearchRange,
    identity: Identity,
    forcing: f64,
    /// Motions that are of other orders.
    shorter: Shorter,
    recorder: Recorder,
    interrupt: Interrupt,
}

impl<'m> Forced<'m> {
    /// Forced responses of `model` at forcing amplitude `forcing`, in pressure form.
    pub fn new(model: &'m Model, settings: &Settings, reach: SearchRange, forcing: f64) -> Self {
        Self::build(model, settings, reach, forcing).expect("every model has a pressure form")
    }
}

impl<'m, F: Formulation<'m>> Forced<'m, F> {
    /// Forced responses of `model` at forcing amplitude `forcing`, in any formulation.
    ///
    /// # Errors
    /// If the formulation does not fit the model.
    pub fn build(
        model: &'m Model,
        settings: &Settings,
        reach: SearchRange,
        forcing: f64,
    ) -> Result<Self, FormulationError> {
        let scales = Scales::new(model, settings.tracked(model));
        let unknown = Unknown::Frequency { forcing };
        let problem = F::build(model, settings.harmonics, settings.tracked(model), unknown, scales)?;
        let shorter = Shorter::of(model, settings.search.harmonics.as_ref());
        let (identity, recorder, interrupt) = Default::default();
        Ok(Self { model, problem, settings: *settings, reach, identity, forcing, shorter, recorder, interrupt })
    }

    /// The same with the steps of its branches and curves recorded; those recorded before are taken as they were.
    pub fn recorded(self, recorder: Recorder) -> Self {
        Self { recorder, ..self }
    }

    /// The same, asking whether to go on where it tells of no points.
    pub fn interrupted_by(self, interrupt: Interrupt) -> Self {
        Self { interrupt, ..self }
    }

    /// Who may ask to stop.
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// What records the steps.
    pub fn recorder(&self) -> Recorder {
        self.recorder.clone()
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
    pub fn reach(&self) -> SearchRange {
        self.reach
    }

    /// Forcing amplitude A.
    pub fn forcing(&self) -> f64 {
        self.forcing
    }

    /// Whether a motion repeats itself after fewer periods of the force and is of an earlier order that is looked for.
    pub(super) fn is_shorter(&self, state: &State) -> bool {
        self.shorter.has(state)
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Frequencies beyond which nothing is followed but main branches up to [`FARTHEST`] times as high.
    fn widest(&self) -> (f64, f64) {
        let (low, high) = self.reach.swept();
        (WIDEST.0 * low, WIDEST.1 * high)
    }

    /// Ends of the frequency range at which a main branch may start from a side, the nearest first.
    fn entries(&self, side: Side) -> [f64; 2] {
        let (low, high) = self.reach.swept();
        match side {
            Side::Below => [low, OUTSIDE.0 * low],
            Side::Above => [high, OUTSIDE.1 * high],
        }
    }

    fn bounds(&self, frequency: (f64, f64), closes: bool) -> Bounds {
        let scales = self.problem.scales();
        let linear = scales.length * self.forcing / scales.forcing;
        let runaway = RUNAWAY * self.reach.amplitude.max(scales.length).max(linear);
        let amplitude = self.settings.branch.max_amplitude.unwrap_or(runaway);
        Bounds { frequency, amplitude, points: self.settings.branch.max_points, closes }
    }

    /// The main branch: what ordinary continuation from below or from above reaches. It starts where the response is linear, at
    /// the end of the range or beyond, and otherwise where continuation in the forcing amplitude leads from rest; it is followed
    /// beyond the study's bounds until the response there is the ordinary one.
    ///
    /// If all that a growing forcing leads to from rest lies on curves that close, it is one of these, an isola.
    ///
    /// # Errors
    /// If there is no first point.
    pub fn main_branch(&mut self, side: Side, observer: &mut Observer<'_>) -> Result<Branch, Unreached> {
        if let Some(start) = self.linear_start(side)? {
            return self.main_from(side, &start, false, observer);
        }
        let [near, far] = self.entries(side);
        let (lowest, highest) = self.widest();
        let farthest = if side == Side::Below { lowest } else { highest };
        let (mut closed, mut unfinished, mut failure) = (None, None, None);
        for omega in [far, farthest, near] {
            let start = from_rest::<F>(self.model, &self.settings, self.forcing, omega, &self.interrupt);
            match start.and_then(|start| self.main_from(side, &start, true, observer)) {
                // What a growing forcing leads to may lie on an isola.
                Ok(branch) if branch.is_closed() => closed = closed.or(Some(branch)),
                Ok(branch) if branch.breaks_off() => unfinished = unfinished.or(Some(branch)),
                Ok(branch) => return Ok(branch),
                Err(why) => failure = failure.or(Some(why)),
            }
        }
        let closed = closed.map(|branch| Branch { kind: BranchKind::Isola, ..branch });
        unfinished.or(closed).ok_or(failure.unwrap_or(Unreached::OutOfReach))
    }

    /// A linear response at the end of the frequency range on this side, or beyond.
    fn linear_start(&mut self, side: Side) -> Result<Option<State>, Failure> {
        for omega in self.entries(side) {
            let linear = forced_response(&self.problem, self.forcing, omega).map_err(|_| Failure::Singular)?;
            match self.converge(&linear) {
                Ok(state) if self.distance(&state, &linear) < LINEAR => return Ok(Some(state)),
                _ => {}
            }
        }
        Ok(None)
    }

    /// What a growing forcing leads to from rest on this side of the frequency range, if the response there is not linear: it need
    /// not lie on a main branch.
    pub fn grown_from_rest(&mut self, side: Side) -> Option<State> {
        if !matches!(self.linear_start(side), Ok(None)) {
            return None;
        }
        let [_, far] = self.entries(side);
        let state = from_rest::<F>(self.model, &self.settings, self.forcing, far, &self.interrupt).ok()?;
        self.converge(&state).ok()
    }

    /// The curve through the first state of a main branch, into the range of the study and on; if it may close, closed if it comes
    /// back.
    fn main_from(
        &mut self,
        side: Side,
        start: &State,
        closes: bool,
        observer: &mut Observer<'_>,
    ) -> Result<Branch, Unreached> {
        let y = self.problem.encode(start);
        let mut direction = self.problem.parameter_row();
        if side == Side::Above {
            direction.iter_mut().for_each(|d| *d = -*d);
        }
        let (lowest, highest) = self.widest();
        let further = if self.settings.frequency.max.is_some() { 1.0 } else { FARTHEST };
        let bounds = self.bounds((lowest, further * highest), closes);
        let (swept, study) = (self.reach.swept(), self.reach.frequency);
        let (newton, given) = (self.landing(), self.settings.frequency);
        let mut continuation = Continuation::start(&mut self.problem, y, &direction, self.settings.continuation)?;
        continuation.record(&self.recorder);
        let mut departure = Departure::new(swept, given);
        let mut ending = |problem: &mut F, last: &TracedPoint| {
            departure.is_final(problem, &newton, last).then_some(Stop::FrequencyBound)
        };
        let (mut visited, stop) = walk(&mut continuation, &bounds, observer, &mut ending);
        let stop = departure.settled(&mut visited, stop);
        let (visited, outcome) = match stop {
            Stop::Closed => (visited, Outcome::Closed),
            _ => main_part(&mut continuation, &newton, (visited, stop), side, Study { frequency: study, given }),
        };
        let rejections = continuation.rejections();
        Ok(self.finish(TracedCurve { visited, start: 0, outcome, rejections }, BranchKind::Main))
    }

    /// Whether a response is what grows out of the linear one: linear, or not far from it and what Newton's method finds from
    /// there.
    pub fn is_ordinary(&mut self, state: &State) -> bool {
        let newton = self.landing();
        is_ordinary(&mut self.problem, &newton, state)
    }

    /// The frequencies that the settings give; the widest ones where they give none.
    fn given(&self) -> (f64, f64) {
        let (widest, study, given) = (self.widest(), self.reach.frequency, self.settings.frequency);
        let low = if given.min.is_some() { study.0 } else { widest.0 };
        (low, if given.max.is_some() { study.1 } else { widest.1 })
    }

    /// Computes what the certificate of a branch says: how much its truncation to H harmonics leaves open.
    pub fn certify(&self, branch: &mut Branch, observer: &mut Observer<'_>) {
        branch.certificate = certificate::<F>(self.model, &self.settings, branch, observer);
    }

    /// Follows extrema of a quantity along branches over the forcing amplitude.
    ///
    /// # Errors
    /// If a law has no second derivatives.
    pub fn extrema(&self, quantity: Quantity) -> Result<Critical<'m>, CriticalError> {
        Ok(Critical::new(self.model, &self.settings, quantity, self.extent())?.recorded(self.recorder()))
    }

    /// Follows responses at frequency `omega`, rad/s, over the forcing amplitude.
    ///
    /// # Errors
    /// None that depends on the model.
    pub fn responses_at(&self, omega: f64) -> Result<Critical<'m>, CriticalError> {
        Ok(Critical::at_frequency(self.model, &self.settings, omega, self.extent())?.recorded(self.recorder()))
    }

    /// What follows curves of the kind that this one is of.
    ///
    /// # Errors
    /// If a law has no second derivatives.
    pub fn like(&self, curve: &CriticalCurve) -> Result<Critical<'m>, CriticalError> {
        match (curve.quantity, curve.points.first()) {
            (Some(quantity), _) => self.extrema(quantity),
            (None, first) => self.responses_at(first.map_or(0.0, BranchPoint::omega)),
        }
    }

    /// Within which forcing amplitudes and frequencies curves over the forcing amplitude are followed.
    fn extent(&self) -> Extent {
        let forcing = self.reach.forcing_around(self.forcing);
        Extent { forcing, frequency: self.widest(), points: self.settings.branch.max_points }
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
        let (low, high) = self.given();
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

    /// Relative distance ‖a − b‖/‖b‖ of two motions whatever their phases: aligned by the first harmonic of mode `mode`
    /// (from 0), the one that the motions are of.
    pub fn motion_distance(&self, a: &State, b: &State, mode: usize) -> f64 {
        let phase = |state: &State| complex(state.mode(mode), 1).arg();
        let aligned = a.shifted(phase(b) - phase(a));
        relative_distance(self.problem.motion_metric(), &self.problem.encode(&aligned), &self.problem.encode(b))
    }

    /// Whether a converged state, or a time shift of it that leaves the forcing unchanged, lies on `branch`.
    pub fn lies_on(&mut self, state: &State, branch: &Branch) -> bool {
        self.position_on(state, branch).is_some()
    }

    /// Number of the point of a branch between which and the next one a converged state lies, if it lies on the branch.
    pub fn position_on(&mut self, state: &State, branch: &Branch) -> Option<usize> {
        let newton = self.settings.continuation.newton;
        let target = self.problem.encode(state);
        let points: Vec<Vec<f64>> = branch.points.iter().map(|point| self.problem.encode(&point.state)).collect();
        let points: Vec<&[f64]> = points.iter().map(|point| &point[..]).collect();
        self.identity.position(&mut self.problem, &newton, &points, branch.is_closed(), &target)
    }

    /// Locates folds and peak, and drops what only the continuation needs.
    fn finish(&mut self, walked: TracedCurve<BranchPoint>, kind: BranchKind) -> Branch {
        let (outcome, rejections) = (walked.outcome, walked.rejections);
        let (points, special) = with_special_points(&mut self.problem, self.settings.continuation, walked);
        let certificate = Certificate::default();
        Branch { kind, forcing: self.forcing, points, special, outcome, rejections, certificate }
    }
}
