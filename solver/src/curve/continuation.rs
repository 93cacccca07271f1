//! Arc-length continuation as an iterator over the points of a solution curve.
//!
//! The iterator only walks: it yields converged points until its smallest step fails, and no sharp corner is why. Bounds, closed loops, storing,
//! progress and cancelling belong to whoever drives it.

mod attempt;
mod between;

use crate::curve::corner;
use crate::curve::newton::{Constraint, Newton, NewtonSettings};
pub use crate::curve::point::CurvePoint;
use crate::curve::point::{land, unit};
use crate::curve::problem::{Failure, Problem, inner, norm, weighted};
use crate::curve::record::{Ahead, Recorder, Step};
pub use crate::curve::settings::{ContinuationSettings, Corrector, Predictor};
use crate::curve::stabiliser::Stabiliser;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Cosine between a step and the tangent at its end below which the tangent is computed anew.
const STALE: f64 = 0.97;

/// Scaled size from which on the largest step grows with a state: of a motion many times as large as the reference length, steps
/// that suit that length resolve more than anybody can see, and use up the points of a branch.
const LARGE: f64 = 5.0;

/// An iteration that fails with a smaller residual fails by rounding.
const NOISE: f64 = 1e-8;

/// How many times as many iterations are spent on a step then.
const PATIENCE: usize = 3;

/// Why a step was not accepted.
#[derive(Debug, Clone, Copy, PartialEq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rejection {
    /// Newton's method failed.
    #[error("{0}")]
    Newton(Failure),
    /// The point lies too far off the tangent.
    #[error("the point lies off the tangent (cosine {0:.2})")]
    Angle(f64),
    /// The determinant changed its sign, and the way back does not lead here: the corrector has hopped to another part of
    /// the curve.
    #[error("the curve changes its orientation")]
    Orientation,
    /// The point differs too much from the last one to be its neighbour: the corrector has hopped across a resonance.
    #[error("the response changes too much within a step")]
    Distance,
}

/// Continuation of one curve in one direction.
pub struct Continuation<'p, P: Problem> {
    problem: &'p mut P,
    settings: ContinuationSettings,
    newton: Newton,
    /// Of the first point, and so of all.
    symmetry: Stabiliser,
    current: CurvePoint,
    previous: Option<CurvePoint>,
    step: f64,
    /// Longest step that the problem allows from the current point.
    longest: f64,
    /// Whether it limits steps at all.
    is_narrow: bool,
    rejections: usize,
    /// Whether the tangent of the current point is that of its own Jacobian.
    refreshed: bool,
    stalled: Option<Rejection>,
    row: Vec<f64>,
    origin: Vec<f64>,
    recorder: Recorder,
}

impl<'p, P: Problem> Continuation<'p, P> {
    /// Starts from a point near the curve, which is made symmetric where it nearly is and corrected on the plane normal to
    /// `direction` through it; the walk goes the way of `direction`.
    ///
    /// # Errors
    /// If the corrector fails at the first point.
    pub fn start(
        problem: &'p mut P,
        mut y: Vec<f64>,
        direction: &[f64],
        settings: ContinuationSettings,
    ) -> Result<Self, Failure> {
        Stabiliser::of(problem, &y).project(problem, &mut y);
        let mut newton = Newton::default();
        let row = weighted(problem.metric(), &unit(problem.metric(), direction.to_vec()));
        let mut current = land(problem, &mut newton, y, &row, &settings.newton)?;
        let symmetry = Stabiliser::of(problem, &current.y);
        symmetry.keep(problem, &mut current.y, &mut current.tangent);
        let (longest, is_narrow) = longest_from(problem, &settings, &current);
        let step = settings.initial_step.min(longest);
        Ok(Self {
            problem,
            settings,
            newton,
            symmetry,
            current,
            previous: None,
            step,
            longest,
            is_narrow,
            rejections: 0,
            refreshed: false,
            stalled: None,
            row,
            origin: Vec::new(),
            recorder: Recorder::default(),
        })
    }

    /// The point reached.
    pub fn current(&self) -> &CurvePoint {
        &self.current
    }

    /// Its settings.
    pub fn settings(&self) -> &ContinuationSettings {
        &self.settings
    }

    /// The problem, for whoever evaluates the points.
    pub fn problem(&mut self) -> &mut P {
        self.problem
    }

    /// Has its steps recorded; those recorded before are taken as they were.
    pub fn record(&mut self, recorder: &Recorder) {
        recorder.begin();
        self.recorder = recorder.clone();
    }

    /// Whether the next step was recorded before.
    pub fn goes_on(&self) -> bool {
        self.recorder.goes_on()
    }

    /// Goes on from a point of the curve beyond what no step passes, with a first step of this length.
    pub fn resume(&mut self, from: CurvePoint, step: f64) {
        self.recorder.begin();
        (self.longest, self.is_narrow) = longest_from(self.problem, &self.settings, &from);
        (self.current, self.previous, self.step) = (from, None, step.min(self.longest));
        (self.refreshed, self.stalled) = (false, None);
    }

    /// Steps refused so far.
    pub fn rejections(&self) -> usize {
        self.rejections
    }

    /// Why the walk ended, once it has.
    pub fn stalled(&self) -> Option<Rejection> {
        self.stalled
    }

    /// Point at arc length `step` along the tangent from `from`, corrected; neither the walk nor its step change.
    ///
    /// # Errors
    /// If the corrector fails.
    pub fn probe(&mut self, from: &CurvePoint, step: f64) -> Result<CurvePoint, Failure> {
        self.correct(from, None, step)
    }

    /// Point of the curve near `y` on the plane through it normal to `row`; neither the walk nor its step change.
    ///
    /// # Errors
    /// If the corrector fails.
    pub fn correct_on(&mut self, y: Vec<f64>, row: &[f64]) -> Result<CurvePoint, Failure> {
        land(self.problem, &mut self.newton, y, row, &self.settings.newton)
    }

    fn correct(&mut self, from: &CurvePoint, previous: Option<&[f64]>, step: f64) -> Result<CurvePoint, Failure> {
        let metric = self.problem.metric();
        let direction = match (self.settings.predictor, previous) {
            (Predictor::Secant, Some(previous)) => {
                unit(metric, from.y.iter().zip(previous).map(|(a, b)| a - b).collect())
            }
            _ => from.tangent.clone(),
        };
        let mut y: Vec<f64> = from.y.iter().zip(&direction).map(|(y, t)| y + step * t).collect();
        self.row.clear();
        self.row.extend(metric.iter().zip(&direction).map(|(w, t)| w * t));
        self.origin.clone_from(&y);
        let constraint = match self.settings.corrector {
            Corrector::Hyperplane => Constraint::Hyperplane { row: &self.row, origin: &self.origin },
            Corrector::Sphere => Constraint::Sphere { centre: &from.y, radius: step },
        };
        let convergence = self.newton.solve(self.problem, &mut y, constraint, &self.settings.newton)?;
        let mut point = CurvePoint {
            y,
            tangent: unit(self.problem.metric(), self.newton.direction.clone()),
            iterations: convergence.iterations,
            factorisations: convergence.factorisations,
            residual: convergence.residual,
            orientation: self.problem.orientation(),
            step,
        };
        self.symmetry.keep(self.problem, &mut point.y, &mut point.tangent);
        if inner(self.problem.metric(), &point.tangent, &from.tangent) < 0.0 {
            point.turn_round();
        }
        Ok(point)
    }

    /// Whether the tangent has little to do with the step that led here, on a curve that may turn within a narrow range.
    fn has_stale_tangent(&self) -> bool {
        let Some(previous) = self.previous.as_ref().filter(|_| self.is_narrow) else { return false };
        let metric = self.problem.metric();
        let moved: Vec<f64> = self.current.y.iter().zip(&previous.y).map(|(a, b)| a - b).collect();
        inner(metric, &moved, &self.current.tangent) < STALE * norm(metric, &moved)
    }

    /// The tangent comes from the last matrix factorised, which belongs to a point nearby: where the curve turns sharply
    /// that is not good enough, however short the step.
    fn refresh_tangent(&mut self) {
        if self.refreshed {
            return;
        }
        self.refreshed = true;
        let row = weighted(self.problem.metric(), &self.current.tangent);
        if let Ok(mut point) = land(self.problem, &mut self.newton, self.current.y.clone(), &row, &self.settings.newton)
        {
            self.symmetry.keep(self.problem, &mut point.y, &mut point.tangent);
            self.current.tangent = point.tangent;
        }
    }

    /// Next step from the effort of the last one and from how much the tangent turned.
    fn adapt(&mut self, point: &CurvePoint) {
        let turn = inner(self.problem.metric(), &point.tangent, &self.current.tangent).clamp(-1.0, 1.0).acos();
        let excess = point.factorisations as f64 - self.settings.target_factorisations as f64;
        let by_effort = 2.0f64.powf(-0.5 * excess);
        let by_turn = if turn > 1e-12 { 0.3 / turn } else { f64::INFINITY };
        let factor = by_effort.min(by_turn).clamp(0.5, 2.0);
        (self.longest, self.is_narrow) = longest_from(self.problem, &self.settings, point);
        self.step = (self.step * factor).min(self.longest);
    }

    /// Below this length a step is given up.
    fn shortest(&self) -> f64 {
        self.settings.min_step * (self.longest / self.settings.max_step).min(1.0)
    }

    /// Takes a step that was taken before.
    fn repeat(&mut self, Step { point, ahead, memory, .. }: Step) {
        self.problem.recall(&memory);
        (self.step, self.longest, self.is_narrow) = (ahead.step, ahead.longest, ahead.is_narrow);
        (self.rejections, self.refreshed) = (ahead.rejections, ahead.is_refreshed);
        self.previous = Some(std::mem::replace(&mut self.current, point));
    }

    /// What the next step depends on beside the last two points.
    fn ahead(&self) -> Ahead {
        let (rejections, is_refreshed) = (self.rejections, self.refreshed);
        Ahead { step: self.step, longest: self.longest, is_narrow: self.is_narrow, rejections, is_refreshed }
    }

    /// Steps past a sharp corner; whether there is one.
    fn turn_corner(&mut self) -> bool {
        let steps = (self.shortest(), self.longest);
        let beyond = corner::beyond(self.problem, &mut self.newton, &self.settings.newton, &self.current, steps);
        let Some(mut point) = beyond else { return false };
        self.symmetry.keep(self.problem, &mut point.y, &mut point.tangent);
        (self.longest, self.is_narrow) = longest_from(self.problem, &self.settings, &point);
        self.step = point.step.min(self.longest);
        self.refreshed = true;
        self.previous = Some(std::mem::replace(&mut self.current, point));
        true
    }

    /// Whether a step failed with next to nothing left of the residual: beside a branch point rounding alone makes every step of the
    /// iteration one along the curve that crosses.
    fn is_noise(&self, rejection: Rejection) -> bool {
        matches!(rejection, Rejection::Newton(Failure::NotConverged { residual, .. }) if residual < NOISE)
    }

    /// Steps on with iterations that take no more of a step than helps, and longer ones first; whether there is such a step.
    fn step_patiently(&mut self) -> bool {
        let usual = self.settings.newton;
        let max_iterations = PATIENCE * usual.max_iterations;
        self.settings.newton = NewtonSettings { damped: true, max_iterations, ..usual };
        self.step = self.settings.initial_step.min(self.longest);
        let mut found = None;
        while found.is_none() && self.step >= self.shortest() {
            found = self.attempt().ok();
            if found.is_none() {
                self.rejections += 1;
                self.step *= 0.5;
            }
        }
        self.settings.newton = usual;
        found.map(|point| self.take(point)).is_some()
    }

    /// Takes a step.
    fn take(&mut self, point: CurvePoint) {
        self.adapt(&point);
        self.refreshed = false;
        self.previous = Some(std::mem::replace(&mut self.current, point));
        if self.has_stale_tangent() {
            self.refresh_tangent();
        }
    }

    /// Steps on to the next point; whether there is one.
    fn advance(&mut self) -> bool {
        loop {
            match self.attempt() {
                Ok(point) => {
                    self.take(point);
                    return true;
                }
                Err(rejection) => {
                    self.rejections += 1;
                    self.refresh_tangent();
                    self.step *= 0.5;
                    if self.step < self.shortest() {
                        if matches!(rejection, Rejection::Newton(_))
                            && (self.turn_corner() || self.is_noise(rejection) && self.step_patiently())
                        {
                            return true;
                        }
                        self.stalled = Some(rejection);
                        return false;
                    }
                }
            }
        }
    }
}

impl<P: Problem> Iterator for Continuation<'_, P> {
    type Item = CurvePoint;

    fn next(&mut self) -> Option<CurvePoint> {
        match self.recorder.next(self.problem.len()) {
            Some(step) => self.repeat(step),
            None if self.advance() => self.recorder.add(&self.current, self.ahead(), || self.problem.memory()),
            None => return None,
        }
        Some(self.current.clone())
    }
}

/// Longest step from a point, and whether the problem limits it. Only where it says how far a step may go without passing over
/// something, a step may be longer than the largest one of the settings.
fn longest_from<P: Problem>(problem: &mut P, settings: &ContinuationSettings, point: &CurvePoint) -> (f64, bool) {
    let allowed = problem.longest_step(&point.y, &point.tangent);
    let is_narrow = allowed.is_finite();
    let size = if is_narrow { norm(problem.metric(), &point.y) / LARGE } else { 1.0 };
    (allowed.min(settings.max_step * size.max(1.0)), is_narrow)
}
