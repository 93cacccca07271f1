//! Fold curves and peak curves: the extrema of frequency or amplitude along the branches of all forcing amplitudes; and the
//! responses of all of them at one frequency, for branches that have no such extremum.
//!
//! Isolas are born and merge where the forcing amplitude A has an extremum along such a curve, so that a fold of a branch
//! that is known leads to isolas that are not (T. Detroux, L. Renson, L. Masset & G. Kerschen, Comput. Methods Appl. Mech.
//! Eng. 296, 18–38, 2015, follow folds of a harmonic balance for this).

use crate::curve::continuation::{Continuation, CurvePoint};
use crate::curve::identity::Identity;
use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::problem::{Failure, Problem, inner, norm, weighted};
use crate::curve::record::Recorder;
use crate::curve::walk::{Bounds, Evaluated, TracedCurve, both_ways, interpolate, relative_distance};
use crate::formulation::Formulation;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::response::branch::{BranchPoint, Observer, Outcome, Stop, TracedPoint};
use crate::response::corners::{Corners, walk_past, with_corners};
use crate::response::critical::crossed;
pub use crate::response::critical::{
    Corner, CriticalCurve, CriticalError, CriticalEvent, CriticalKind, Extent, Quantity,
};
use crate::response::critical_doubled::certify;
use crate::response::critical_events::with_events;
use crate::response::grazing::grazing;
use crate::response::symmetry::{Asymmetry, up_to_branch_point};
use crate::settings::Settings;
use crate::structure::Model;

/// Largest scaled residual of a point of a curve, evaluated anew.
const SOLVED: f64 = 1e-6;

/// A start moves by no more than this share of its motion when it is located.
const NEAR: f64 = 0.1;

/// Most bisections of a chord on which a level is crossed.
const DEPTH: usize = 8;

/// A crossing may lie this share of a chord beyond its ends.
const BEYOND: f64 = 1e-3;

/// Follows the folds, the peaks or the responses at one frequency of a model.
pub struct Critical<'m> {
    model: &'m Model,
    settings: Settings,
    quantity: Option<Quantity>,
    extent: Extent,
    problem: PressureForm<'m>,
    newton: Newton,
    identity: Identity,
    recorder: Recorder,
}

impl<'m> Critical<'m> {
    /// Folds (extrema of ω) or peaks (of the amplitude or the root mean square) of `model` within `extent`.
    ///
    /// # Errors
    /// If a setting is out of range, or a law has no second derivatives.
    pub fn new(
        model: &'m Model,
        settings: &Settings,
        quantity: Quantity,
        extent: Extent,
    ) -> Result<Self, CriticalError> {
        Self::build(model, settings, Some(quantity), Unknown::Extremum(quantity), extent)
    }

    /// Forced responses of `model` at frequency `omega`, rad/s, within `extent`.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn at_frequency(
        model: &'m Model,
        settings: &Settings,
        omega: f64,
        extent: Extent,
    ) -> Result<Self, CriticalError> {
        Self::build(model, settings, None, Unknown::Forcing { omega }, extent)
    }

    fn build(
        model: &'m Model,
        settings: &Settings,
        quantity: Option<Quantity>,
        unknown: Unknown,
        extent: Extent,
    ) -> Result<Self, CriticalError> {
        settings.validate(model)?;
        let scales = Scales::new(model, settings.tracked(model));
        let mut problem = PressureForm::build(model, settings.harmonics, settings.tracked(model), unknown, scales)?;
        // Its scale, that of the linear resonance, is far below the forcing of isolas where the damping is weak.
        problem.measure_forcing_by(extent.forcing.1.max(scales.forcing));
        let (newton, identity, recorder) = Default::default();
        Ok(Self { model, settings: *settings, quantity, extent, problem, newton, identity, recorder })
    }

    /// The same with the steps of its curves recorded; those recorded before are taken as they were.
    pub fn recorded(self, recorder: Recorder) -> Self {
        Self { recorder, ..self }
    }

    /// The curve through a state near a fold (or peak, or response) of a branch, at the state's own A, followed both ways, with
    /// the extrema of A along it that are births, merges or cusps. `observer` is told of every point.
    ///
    /// # Errors
    /// If there is no point of the curve near the state. What stops the curve later is part of the result.
    pub fn curve(&mut self, near: &State, observer: &mut Observer<'_>) -> Result<CriticalCurve, CriticalError> {
        let extent = self.extent;
        let start = self.locate(near)?;
        let y = self.problem.encode(&start);
        let bounds =
            Bounds { frequency: extent.frequency, amplitude: f64::INFINITY, points: extent.points, closes: true };
        let (low, high) = extent.forcing;
        let settings = self.settings.continuation;
        let directions = [self.forcing_row(), self.problem.parameter_row()];
        let mut walked = Err(Failure::Singular);
        let mut corners = Corners::default();
        for direction in directions {
            let mut one_way = |continuation: &mut Continuation<'_, PressureForm<'m>>| {
                continuation.record(&self.recorder);
                up_to_branch_point(continuation, |continuation, meets| {
                    let mut ending = |problem: &mut PressureForm<'m>, last: &TracedPoint| {
                        let is_beyond = !(low..=high).contains(&last.point.state.forcing);
                        let is_met = meets(problem, last);
                        if is_beyond { Some(Stop::ForcingBound) } else { is_met }
                    };
                    walk_past(continuation, &bounds, observer, &mut ending, &mut corners)
                })
            };
            walked = both_ways(&mut self.problem, y.clone(), &direction, &settings, &mut one_way);
            if walked.is_ok() {
                break;
            }
        }
        let walked = walked.map_err(|failure| self.quantity_not_found(near, failure))?;
        let mut curve = self.assemble(walked, corners);
        certify(self.model, &self.settings, extent, &mut curve, observer);
        Ok(curve)
    }

    /// The fold (or peak) near a state, at its own A; where A is close to an extremum along the curve, at its own ω.
    ///
    /// # Errors
    /// If Newton's method fails, or ends at another response.
    pub fn locate(&mut self, near: &State) -> Result<State, CriticalError> {
        let y = self.problem.encode(near);
        let mut found = Err(Failure::Singular);
        for row in [self.forcing_row(), self.problem.parameter_row()] {
            found = self.converge(y.clone(), &row).map(|point| point.y);
            match &found {
                Ok(found) if relative_distance(self.problem.motion_metric(), found, &y) < NEAR => break,
                _ => {}
            }
        }
        let found = found.map_err(|failure| self.quantity_not_found(near, failure))?;
        let located = self.problem.decode(&found).map_err(|_| self.quantity_not_found(near, Failure::Singular))?;
        // A motion that nearly needs no forcing is near one that is driven the other way round.
        if relative_distance(self.problem.motion_metric(), &found, &y) >= NEAR || located.forcing <= 0.0 {
            let (quantity, omega, forcing) = (self.quantity, near.omega, near.forcing);
            return Err(CriticalError::Elsewhere { quantity, omega, forcing });
        }
        Ok(located)
    }

    /// The points of a curve at forcing amplitude `forcing`, converged there: one for every pair of neighbouring points on
    /// different sides of it.
    pub fn crossings(&mut self, curve: &CriticalCurve, forcing: f64) -> Vec<Result<State, Failure>> {
        let amplitudes: Vec<f64> = curve.forcing().collect();
        let segments: Vec<usize> = crossed(&amplitudes, forcing).collect();
        segments.into_iter().map(|segment| self.crossing_at(curve, segment, forcing)).collect()
    }

    /// The point of a curve at forcing amplitude `forcing` between point `segment` and the next, as [`crossed`] tells.
    ///
    /// # Errors
    /// If it does not converge, or the curve has no such points.
    pub fn crossing_at(&mut self, curve: &CriticalCurve, segment: usize, forcing: f64) -> Result<State, Failure> {
        let (a, b) = curve.pairs().nth(segment).ok_or(Failure::Diverged)?;
        let (a, b) = (self.problem.encode(&a.state), self.problem.encode(&b.state));
        let scaled = forcing / self.problem.scales().forcing;
        let point = self.crossing([&a, &b], scaled, DEPTH)?;
        self.problem.decode(&point.y).map_err(|_| Failure::Singular)
    }

    /// Whether a fold (or peak) near `state`, or a time shift of it that leaves the forcing unchanged, lies on `curve`.
    pub fn lies_on(&mut self, state: &State, curve: &CriticalCurve) -> bool {
        let Ok(state) = self.locate(state) else { return false };
        // Their frequency is none of the unknowns of responses at one.
        let is_elsewhere = |first: &BranchPoint| self.quantity.is_none() && first.omega() != state.omega;
        if curve.points.first().is_some_and(is_elsewhere) {
            return false;
        }
        let newton = self.settings.continuation.newton;
        let target = self.problem.encode(&state);
        let targets = self.problem.distinct_images(&target);
        let problem = &mut self.problem;
        curve.pairs().any(|(a, b)| {
            let (a, b) = (problem.encode(&a.state), problem.encode(&b.state));
            targets.iter().any(|target| self.identity.passes(problem, &newton, [&a, &b], target))
        })
    }

    /// Moves end points beyond a bound of the forcing amplitude to the bound.
    fn end_at_bounds(&mut self, points: &mut [BranchPoint], outcome: &Outcome) {
        let (Outcome::Open(first, last), count) = (outcome, points.len()) else { return };
        if count < 2 {
            return;
        }
        for (stop, end, inner) in [(first, 0, 1), (last, count - 1, count - 2)] {
            let forcing = points[end].state.forcing;
            let bound = forcing.clamp(self.extent.forcing.0, self.extent.forcing.1);
            if *stop != Stop::ForcingBound || bound == forcing {
                continue;
            }
            let [from, to] = [inner, end].map(|i| self.problem.encode(&points[i].state));
            let scaled = bound / self.problem.scales().forcing;
            if let Ok(point) = self.crossing([&from, &to], scaled, DEPTH) {
                points[end] = BranchPoint::evaluate(&mut self.problem, &point);
            }
        }
    }

    /// Point between two neighbouring ones at a scaled forcing amplitude.
    fn crossing(&mut self, [a, b]: [&[f64]; 2], forcing: f64, depth: usize) -> Result<CurvePoint, Failure> {
        let (row, last) = (self.forcing_row(), a.len() - 1);
        let chord: Vec<f64> = b.iter().zip(a).map(|(b, a)| b - a).collect();
        let length = norm(self.problem.metric(), &chord);
        let mut y = interpolate(a, b, (forcing - a[last]) / (b[last] - a[last]));
        y[last] = forcing;
        let found = self.converge(y.clone(), &row);
        // Next to an extremum of A Newton's method may end on its other side.
        let is_between = |found: &[f64], metric: &[f64]| {
            let difference = |origin: &[f64]| -> Vec<f64> { found.iter().zip(origin).map(|(f, o)| f - o).collect() };
            let share = inner(metric, &difference(a), &chord) / (length * length);
            (-BEYOND..=1.0 + BEYOND).contains(&share) && norm(metric, &difference(&y)) <= 0.5 * length
        };
        match found {
            Ok(found) if is_between(&found.y, self.problem.metric()) => return Ok(found),
            Err(failure) if depth == 0 => return Err(failure),
            _ if depth == 0 => return Err(Failure::Diverged),
            _ => {}
        }
        let plane = weighted(self.problem.metric(), &chord);
        let middle = self.converge(interpolate(a, b, 0.5), &plane)?.y;
        let is_before = (a[last] > forcing) != (middle[last] > forcing);
        let half: [&[f64]; 2] = if is_before { [a, &middle] } else { [&middle, b] };
        self.crossing(half, forcing, depth - 1)
    }

    /// Converges on the plane through `y` normal to `row`.
    fn converge(&mut self, mut y: Vec<f64>, row: &[f64]) -> Result<CurvePoint, Failure> {
        let origin = y.clone();
        let settings = NewtonSettings { max_iterations: 20, ..self.settings.continuation.newton };
        let constraint = Constraint::Hyperplane { row, origin: &origin };
        let convergence = self.newton.solve(&mut self.problem, &mut y, constraint, &settings)?;
        Ok(CurvePoint {
            y,
            tangent: self.newton.direction.clone(),
            iterations: convergence.iterations,
            factorisations: convergence.factorisations,
            residual: convergence.residual,
            orientation: self.problem.orientation(),
            step: 0.0,
        })
    }

    /// A as a linear form on the state.
    fn forcing_row(&self) -> Vec<f64> {
        let mut row = vec![0.0; self.problem.len()];
        row[self.problem.len() - 1] = 1.0;
        row
    }

    fn quantity_not_found(&self, near: &State, failure: Failure) -> CriticalError {
        CriticalError::Start { quantity: self.quantity, omega: near.omega, forcing: near.forcing, failure }
    }

    /// Locates the extrema of A, and drops what only the continuation needs.
    fn assemble(&mut self, walked: TracedCurve<BranchPoint>, mut corners: Corners) -> CriticalCurve {
        let (outcome, rejections) = (walked.outcome, walked.rejections);
        let settings = self.settings.continuation;
        // An end may be a branch point, where none starts, or has a symmetry that is not the curve's.
        let from_the_middle = |i: &usize| i.abs_diff(walked.visited.len() / 2);
        let mut places: Vec<usize> = (0..walked.visited.len()).collect();
        places.sort_by_key(from_the_middle);
        let start = places
            .into_iter()
            .map(|i| walked.visited[i].curve.clone())
            .find(|at| Continuation::start(&mut self.problem, at.y.clone(), &at.tangent, settings).is_ok());
        let continuation =
            start.and_then(|at| Continuation::start(&mut self.problem, at.y, &at.tangent, settings).ok());
        let (visited, mut events) = match continuation {
            Some(mut continuation) => {
                let is_closed = outcome == Outcome::Closed;
                let visited = with_corners(&mut continuation, walked.visited, is_closed, &mut corners);
                match self.quantity {
                    Some(_) => with_events(&mut continuation, visited, is_closed, &corners),
                    None => (visited, Vec::new()),
                }
            }
            None => (walked.visited, Vec::new()),
        };
        let mut points: Vec<BranchPoint> = visited.into_iter().map(|v| v.point).collect();
        self.end_at_bounds(&mut points, &outcome);
        // An end that is not met at the bound may lie where no forcing is left, and the curve turns into its own image.
        // Nor need a last step that converged be a point of it: beyond the last touch of a stop there are no folds.
        let is_there = |point: &BranchPoint| point.state.forcing > 0.0 && point.residual() < SOLVED;
        while points.pop_if(|last| !is_there(last)).is_some() {}
        let gone = points.iter().take_while(|point| !is_there(point)).count();
        points.drain(..gone);
        events.retain(|event| event.index >= gone);
        events.iter_mut().for_each(|event| event.index -= gone);
        events.retain(|event| event.index < points.len());
        let asymmetry = Asymmetry::along(&self.problem, &points, |state| state.forcing, outcome);
        let outcome = asymmetry.outcome();
        let turns: Vec<usize> =
            events.iter().map(|event| event.index).filter(|&index| asymmetry.turns(index)).collect();
        let kept = asymmetry.kept(&turns);
        events.retain(|event| kept.contains(&event.index) && !turns.contains(&event.index));
        events.iter_mut().for_each(|event| event.index -= kept.start);
        points.truncate(kept.end);
        points.drain(..kept.start);
        let grazing = match outcome {
            Outcome::Open(first, last) => [(first, points.first()), (last, points.last())].map(|(stop, point)| {
                let is_stalled = matches!(stop, Stop::Stalled(_));
                point.filter(|_| is_stalled).and_then(|point| grazing(self.model, &point.state))
            }),
            Outcome::Closed => [None, None],
        };
        let corners = corners.among(&points);
        CriticalCurve { quantity: self.quantity, points, events, corners, outcome, grazing, rejections }
    }
}
