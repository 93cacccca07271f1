//! Backbone: the nonlinear normal mode of one mode, or its resonances in quadrature with the forcing, with energies and
//! modal contributions (paper [20–26]).

mod crossing;
mod error;

use crate::curve::continuation::Continuation;
use crate::curve::extrema::{insert_maxima, locate_maximum, turning_points};
use crate::curve::problem::{Failure, norm};
use crate::curve::walk::{Bounds, TracedCurve, relative_distance, walk, walk_both};
use crate::formulation::linear;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError};
use crate::response::branch::{BranchPoint, Observer, Outcome, Stop, TracedPoint};
use crate::response::columns::{self, OnBackbone, Row};
use crate::response::melnikov::Energies;
use crate::settings::{BackboneEquation, Criterion, Settings, SettingsError};
use crate::structure::Model;
pub use crossing::MOST as MOST_CROSSING;
use crossing::{Rest, Way, curves_across};
pub use error::BackboneError;
use error::drifting;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// A point of the backbone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BackbonePoint {
    /// Motion, and what points of any curve have.
    pub point: BranchPoint,
    /// What a backbone has besides: [`columns::of_backbone`].
    pub values: Row,
}

impl BackbonePoint {
    /// Energy balance.
    pub fn energies(&self) -> Energies {
        Energies {
            linear: self.values.first(columns::R_LIN),
            nonlinear: self.values.first(columns::R_NL),
            work_per_amplitude: self.values.first(columns::WORK),
            certificate: self.values.first(columns::CERTIFICATE),
        }
    }

    /// Threshold amplitude A*: forced responses are predicted here for A > A*.
    pub fn threshold(&self) -> f64 {
        self.values.first(columns::THRESHOLD)
    }

    /// Share of each mode, summing to 1.
    pub fn contributions(&self) -> &[f64] {
        self.values.all(columns::CONTRIBUTIONS)
    }

    /// Scaled arc length from the first point; that of a piece goes on from the end of the one before.
    pub fn arc(&self) -> f64 {
        self.values.first(columns::ARC)
    }

    /// Number of the piece it belongs to, from 0.
    pub fn piece(&self) -> usize {
        self.values.get(columns::PIECE).map_or(0, |values| values[0] as usize)
    }
}

/// A nonlinear normal mode, or a curve of phase-resonant responses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Backbone {
    /// Mode it starts from, from 0.
    pub mode: usize,
    /// Points along the arc, piece after piece: the first piece grows out of the linear mode, further ones cross it or each other at
    /// branch points ([`BackbonePoint::piece`]).
    pub points: Vec<BackbonePoint>,
    /// How its first piece begins and ends.
    pub outcome: Outcome,
    /// How further pieces begin and end.
    pub crossing: Vec<Outcome>,
    /// Steps refused and repeated shorter.
    pub rejections: usize,
}

/// How many times as large as in the linear range the motion may be that a backbone starts with: dry friction may keep smaller ones
/// from swinging.
const LARGER: [f64; 3] = [10.0, 100.0, 1000.0];

/// Amplitude up to which a backbone is followed, reference lengths, unless the settings say so.
const FOLLOWED: f64 = 8.0;

/// How many times as far it is followed again where that is not far enough for the forcing, and how often.
const FARTHER: (f64, usize) = (4.0, 5);

/// It is far enough once its threshold is this many times the forcing.
const ENOUGH: f64 = 2.0;

/// Relative distance of the first motion from the linear one, at most, if that is larger.
const ALIKE: f64 = 0.5;

fn system<'m, F: Formulation<'m>>(
    model: &'m Model,
    settings: &Settings,
    equation: BackboneEquation,
) -> Result<F, FormulationError> {
    let unknown = match equation {
        BackboneEquation::DampedMode => Unknown::Mode { damped: true },
        BackboneEquation::ConservativeMode => Unknown::Mode { damped: false },
        BackboneEquation::PhaseResonance => Unknown::PhaseResonance,
    };
    let scales = Scales::new(model, settings.tracked(model));
    F::build(model, settings.harmonics, settings.tracked(model), unknown, scales)
}

fn bounds(settings: &Settings, scales: &Scales) -> Bounds {
    let limits = &settings.backbone;
    let omega = scales.frequency;
    Bounds {
        frequency: (limits.min_frequency.unwrap_or(0.25 * omega), limits.max_frequency.unwrap_or(4.0 * omega)),
        amplitude: limits.max_amplitude.unwrap_or(FOLLOWED * scales.length),
        points: limits.max_points,
        closes: false,
    }
}

/// Whether the frequency of a state is within bounds.
fn is_within<'m, F: Formulation<'m>>(problem: &mut F, y: &[f64], bounds: &Bounds) -> bool {
    let (low, high) = bounds.frequency;
    problem.decode(y).is_ok_and(|state| (low..=high).contains(&state.omega))
}

/// One backbone where several may be.
impl AsRef<[Backbone]> for Backbone {
    fn as_ref(&self) -> &[Backbone] {
        std::slice::from_ref(self)
    }
}

impl Backbone {
    /// Computes the backbone of the primary mode, the first one of `settings.backbone.modes`; those of all modes:
    /// [`crate::response::modes::Backbones`].
    ///
    /// # Errors
    /// If a setting is out of range, or the first point does not converge. What stops the curve later is part of the result.
    pub fn compute(model: &Model, settings: &Settings) -> Result<Self, BackboneError> {
        Self::compute_with(model, settings, &mut |_| ControlFlow::Continue(()))
    }

    /// The same, telling `observer` of every point.
    ///
    /// # Errors
    /// Those of [`Backbone::compute`].
    pub fn compute_with(
        model: &Model,
        settings: &Settings,
        observer: &mut Observer<'_>,
    ) -> Result<Self, BackboneError> {
        Self::compute_in::<PressureForm<'_>>(model, settings, observer)
    }

    /// The same, as far as responses to forcing amplitudes up to `forcing` go, with the curves that cross it where it matters for these:
    /// unless the settings give a largest amplitude, a backbone whose threshold is not beyond that where it ends is followed farther.
    ///
    /// # Errors
    /// Those of [`Backbone::compute`].
    pub fn reaching(
        model: &Model,
        settings: &Settings,
        forcing: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Self, BackboneError> {
        let mut compute =
            |settings: &Settings| Self::compute_for::<PressureForm<'_>>(model, settings, forcing, observer);
        let mut backbone = compute(settings)?;
        let (farther, times) = FARTHER;
        let mut wider = *settings;
        let mut bound = FOLLOWED * Scales::new(model, settings.tracked(model)).length;
        for _ in 0..times {
            if settings.backbone.max_amplitude.is_some() || backbone.is_enough(forcing) {
                break;
            }
            bound *= farther;
            wider.backbone.max_amplitude = Some(bound);
            backbone = compute(&wider)?;
        }
        Ok(backbone)
    }

    /// Computes the backbone of the primary mode in any formulation, telling `observer` of every point.
    ///
    /// # Errors
    /// Those of [`Backbone::compute`], and if the formulation does not have this backbone.
    pub fn compute_in<'m, F: Formulation<'m>>(
        model: &'m Model,
        settings: &Settings,
        observer: &mut Observer<'_>,
    ) -> Result<Self, BackboneError> {
        Self::compute_for::<F>(model, settings, 0.0, observer)
    }

    fn compute_for<'m, F: Formulation<'m>>(
        model: &'m Model,
        settings: &Settings,
        forcing: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Self, BackboneError> {
        settings.validate(model)?;
        let mode = settings.tracked(model);
        let omega = model.modes().frequencies[mode];
        let not_started = |failure| {
            let drifting = if failure == Failure::Singular { drifting(model) } else { None };
            BackboneError::Start { mode: mode + 1, omega, failure, drifting }
        };
        let equation = settings.backbone.equation;
        let mut problem: F = system(model, settings, equation)?;
        let start = match equation {
            BackboneEquation::PhaseResonance => {
                linear::forced_response(&problem, 1.0, omega / model.forcing().harmonic as f64)
                    .map(|state| linear::below_first_touch(&problem, state))
                    .map_err(|_| not_started(Failure::Singular))?
            }
            _ => linear::mode_motion(&problem, mode),
        };
        let y = problem.encode(&start);
        let direction = problem.growth(&y);
        let bounds = bounds(settings, problem.scales());
        let (low, high) = bounds.frequency;
        if !(low..=high).contains(&start.omega) {
            let remedy = format!("mode {} starts at {} rad/s: choose bounds round it", mode + 1, start.omega);
            let (key, value) =
                if start.omega < low { ("backbone.min_frequency", low) } else { ("backbone.max_frequency", high) };
            return Err(SettingsError { key, value: value.to_string(), remedy }.into());
        }
        let way = Way { settings, bounds, forcing };
        let begin = |problem: &mut F, observer: &mut Observer<'_>| {
            let mut continuation = Continuation::start(problem, y.clone(), &direction, settings.continuation)?;
            let mut rest = Rest::default();
            let mut ending =
                |problem: &mut F, last: &TracedPoint| rest.is_passed(problem, &last.curve.y).then_some(Stop::Start);
            let (mut visited, stop) = walk(&mut continuation, &way.bounds, observer, &mut ending);
            if stop == Stop::Start {
                visited.pop();
            }
            let (outcome, rejections) = (Outcome::Open(Stop::Start, stop), continuation.rejections());
            Self::with_crossing(problem, &way, TracedCurve { visited, start: 0, outcome, rejections }, observer)
        };
        let first = Continuation::start(&mut problem, y.clone(), &direction, settings.continuation);
        let failure = match first.map(|started| started.current().y.clone()) {
            Ok(first) if is_within(&mut problem, &first, &way.bounds) => {
                return begin(&mut problem, observer).map_err(not_started);
            }
            Ok(_) => None,
            Err(failure) => Some(failure),
        };
        if let Some(backbone) = Self::of_larger(&mut problem, &way, &start, observer) {
            return Ok(backbone);
        }
        // All there is begins beyond the bounds of its frequency.
        failure.map_or_else(|| begin(&mut problem, observer), Err).map_err(not_started)
    }

    /// The curve through a motion that is larger than `start` and like it otherwise, if there is one within the bounds.
    fn of_larger<'m, F: Formulation<'m>>(
        problem: &mut F,
        way: &Way<'_>,
        start: &State,
        observer: &mut Observer<'_>,
    ) -> Option<Self> {
        LARGER.into_iter().find_map(|factor| {
            let y = problem.encode(&linear::times(problem, start.clone(), factor));
            let direction = problem.growth(&y);
            let started = Continuation::start(problem, y.clone(), &direction, way.settings.continuation).ok()?;
            let first = started.current().y.clone();
            let is_alike = relative_distance(problem.motion_metric(), &first, &y) < ALIKE;
            if !is_alike || !is_within(problem, &first, &way.bounds) {
                return None;
            }
            let rest = norm(problem.motion_metric(), &problem.encode(start));
            Self::both_ways(problem, way, (first, rest), observer).ok()
        })
    }

    /// The phase-resonance backbone through a forced response near quadrature (see [`crate::response::forced::Forced::resonances`]),
    /// both ways: finds the backbones that are not connected to any linear mode, from branches that are.
    ///
    /// # Errors
    /// If a setting is out of range, or the first point does not converge.
    pub fn through(
        model: &Model,
        settings: &Settings,
        near: &State,
        observer: &mut Observer<'_>,
    ) -> Result<Self, BackboneError> {
        settings.validate(model)?;
        let mut problem: PressureForm<'_> = system(model, settings, BackboneEquation::PhaseResonance)?;
        let y = problem.encode(near);
        let bounds = Bounds { closes: true, ..bounds(settings, problem.scales()) };
        Self::both_ways(&mut problem, &Way { settings, bounds, forcing: 0.0 }, (y, 0.0), observer)
            .map_err(|failure| BackboneError::Resonance { omega: near.omega, failure })
    }

    /// The curve through a state near it, towards larger motions and towards smaller ones, down to motions of size `rest` in the metric
    /// of motions.
    fn both_ways<'m, F: Formulation<'m>>(
        problem: &mut F,
        way: &Way<'_>,
        (y, rest): (Vec<f64>, f64),
        observer: &mut Observer<'_>,
    ) -> Result<Self, Failure> {
        let direction = problem.growth(&y);
        let mut ending = |problem: &mut F, last: &TracedPoint| {
            (norm(problem.motion_metric(), &last.curve.y) < rest).then_some(Stop::Start)
        };
        let continuation = &way.settings.continuation;
        let walked = walk_both(problem, y, &direction, continuation, &way.bounds, observer, &mut ending)?;
        Self::with_crossing(problem, way, walked, observer)
    }

    /// A curve that was walked, and what crosses it where the force does work.
    fn with_crossing<'m, F: Formulation<'m>>(
        problem: &mut F,
        way: &Way<'_>,
        walked: TracedCurve<BranchPoint>,
        observer: &mut Observer<'_>,
    ) -> Result<Self, Failure> {
        let across = match walked.outcome {
            Outcome::Open(_, Stop::Cancelled) => Vec::new(),
            _ => curves_across(problem, way, &walked, observer),
        };
        let mut backbone = Self {
            mode: way.settings.tracked(problem.model()),
            points: Vec::new(),
            outcome: walked.outcome,
            crossing: Vec::new(),
            rejections: walked.rejections,
        };
        backbone.add(problem, way.settings, walked)?;
        for curve in across {
            backbone.crossing.push(curve.outcome);
            backbone.rejections += curve.rejections;
            backbone.add(problem, way.settings, curve)?;
        }
        Ok(backbone)
    }

    /// Adds a piece: locates the extrema of its threshold curve and evaluates every point.
    fn add<'m, F: Formulation<'m>>(
        &mut self,
        problem: &mut F,
        settings: &Settings,
        curve: TracedCurve<BranchPoint>,
    ) -> Result<(), Failure> {
        let criterion = settings.backbone.criterion;
        let first = curve.visited[curve.start].curve.clone();
        let mut continuation = Continuation::start(problem, first.y, &first.tangent, settings.continuation)?;
        let visited = with_threshold_extrema(&mut continuation, curve.visited, criterion);
        let (piece, mut arc) = match self.points.last() {
            Some(last) => (last.piece() + 1, last.arc()),
            None => (0, 0.0),
        };
        self.points.extend(visited.into_iter().map(|visited| {
            arc += visited.curve.step;
            evaluate(problem, visited, (piece, arc), criterion)
        }));
        Ok(())
    }

    /// Whether as many curves cross it as are followed: there may be more.
    pub fn is_crowded(&self) -> bool {
        self.crossing.len() == MOST_CROSSING
    }

    /// Whether no piece ends at the amplitude bound where its threshold is not beyond a forcing amplitude.
    fn is_enough(&self, forcing: f64) -> bool {
        let outcomes = std::iter::once(&self.outcome).chain(&self.crossing);
        outcomes.zip(self.pieces()).all(|(outcome, piece)| {
            let is_cut = |stop: Stop, end: Option<&BackbonePoint>| {
                stop == Stop::AmplitudeBound && end.is_some_and(|end| end.threshold() <= ENOUGH * forcing)
            };
            match *outcome {
                Outcome::Open(first, last) => !is_cut(first, piece.first()) && !is_cut(last, piece.last()),
                Outcome::Closed => true,
            }
        })
    }

    /// The points of every piece.
    pub fn pieces(&self) -> impl Iterator<Item = &[BackbonePoint]> {
        self.points.chunk_by(|a, b| a.piece() == b.piece())
    }

    /// The threshold A* where the first piece ends.
    pub fn last_threshold(&self) -> Option<f64> {
        Some(self.pieces().next()?.last()?.threshold())
    }

    /// Turning points of what has a value at every point (see [`turning_points`]), within pieces.
    pub fn turning_points(&self, values: &[f64], prominence: f64) -> Vec<(usize, bool)> {
        let mut first = 0;
        let turns = self.pieces().flat_map(|piece| {
            let begin = first;
            first += piece.len();
            let turns = turning_points(&values[begin..first], prominence).into_iter();
            let last = piece.len() - 1;
            turns
                .filter(move |(index, _)| (1..last).contains(index))
                .map(move |(index, is_max)| (begin + index, is_max))
        });
        turns.collect()
    }

    /// Lowest and highest frequency, rad/s.
    pub fn frequency_range(&self) -> (f64, f64) {
        self.points
            .iter()
            .map(|p| p.point.omega())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), omega| (low.min(omega), high.max(omega)))
    }

    /// Largest amplitude of the first monitored dof, m.
    pub fn max_amplitude(&self) -> f64 {
        self.points.iter().map(|p| p.point.amplitude()).fold(0.0, f64::max)
    }
}

/// Inserts the minima and maxima of the threshold curve, located along the arc.
fn with_threshold_extrema<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    visited: Vec<TracedPoint>,
    criterion: Criterion,
) -> Vec<TracedPoint> {
    let log_threshold = |problem: &mut F, v: &TracedPoint| {
        Energies::evaluate(problem, &v.curve.y, &v.point.state).threshold(criterion).ln()
    };
    let values: Vec<f64> = visited.iter().map(|v| log_threshold(continuation.problem(), v)).collect();
    let mut maxima = Vec::new();
    for i in 1..visited.len().saturating_sub(1) {
        let (before, here, after) = (values[i - 1], values[i], values[i + 1]);
        let sign = match (here < before && here <= after, here > before && here >= after) {
            (true, _) => -1.0,
            (_, true) => 1.0,
            _ => continue,
        };
        let arcs = (visited[i].curve.step, visited[i + 1].curve.step);
        let values = [before, here, after].map(|v| sign * v);
        let measure = move |problem: &mut F, v: &TracedPoint| sign * log_threshold(problem, v);
        maxima.push(locate_maximum(continuation, &visited, i, arcs, values, &measure));
    }
    insert_maxima(visited, maxima).0
}

fn evaluate<'m>(
    problem: &mut impl Formulation<'m>,
    visited: TracedPoint,
    (piece, arc): (usize, f64),
    criterion: Criterion,
) -> BackbonePoint {
    let energies = Energies::evaluate(problem, &visited.curve.y, &visited.point.state);
    let (aft, state) = (problem.aft(), &visited.point.state);
    let values = Row::of_backbone(OnBackbone { aft, state, energies, criterion, arc, piece });
    BackbonePoint { point: visited.point, values }
}
