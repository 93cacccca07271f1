//! Computing a backbone: where it begins, and how far it is followed.

use super::error::drifting;
use super::way::{Rest, Way};
use super::{Backbone, BackboneError, BackbonePoint};
use crate::curve::continuation::Continuation;
use crate::curve::problem::{Failure, norm};
use crate::curve::walk::{Bounds, TracedCurve, walk, walk_both};
use crate::formulation::linear;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::formulation::{Formulation, FormulationError};
use crate::response::branch::{Observer, Outcome, Stop, TracedPoint};
use crate::response::symmetry::up_to_branch_point;
use crate::settings::{BackboneEquation, Settings, SettingsError, told_frequency};
use crate::structure::Model;
use std::iter;
use std::ops::ControlFlow;

/// How many times as large as in the linear range the motion may be that a backbone starts with: dry friction may keep smaller ones
/// from swinging.
const LARGER: [f64; 3] = [10.0, 100.0, 1000.0];

/// Amplitude up to which a backbone is followed, reference lengths, unless the settings say so.
const FOLLOWED: f64 = 8.0;

/// Frequency up to which it is, over that of the mode, unless the settings say so; and its inverse, down to which.
const SPAN: f64 = 4.0;

/// How many times as far it is followed again where that is not far enough for the forcing, and how often.
const FARTHER: (f64, usize) = (4.0, 5);

/// Share of the farthest amplitude, or frequency, beyond which it has been followed as far as it ever is.
const NEARLY: f64 = 0.99;

/// It is far enough once its threshold is this many times the forcing.
const ENOUGH: f64 = 2.0;

pub(super) fn system<'m, F: Formulation<'m>>(
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

/// Bounds of a backbone that is followed up to so many reference lengths, and up to a frequency as far in proportion, unless the settings
/// say otherwise.
fn bounds(settings: &Settings, scales: &Scales, followed: f64) -> Bounds {
    let limits = &settings.backbone;
    let (lowest, highest) = (scales.frequency / SPAN, scales.frequency * SPAN * (followed / FOLLOWED));
    Bounds {
        frequency: (limits.min_frequency.unwrap_or(lowest), limits.max_frequency.unwrap_or(highest)),
        amplitude: limits.max_amplitude.unwrap_or(followed * scales.length),
        points: limits.max_points,
        closes: false,
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

    /// The same, as far as responses to forcing amplitudes up to `forcing` go, with the curves that cross it where it matters for these, and
    /// the mode's motions of shorter periods: unless the settings give a largest amplitude, a backbone whose threshold is not beyond that
    /// where it ends is followed farther.
    ///
    /// # Errors
    /// Those of [`Backbone::compute`].
    pub fn reaching(
        model: &Model,
        settings: &Settings,
        forcing: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Self, BackboneError> {
        let own = Self::of_own_order(model, settings, forcing, observer)?;
        Ok(own.with_shorter(model, settings, forcing, observer))
    }

    /// The same without motions of shorter periods.
    pub(super) fn of_own_order(
        model: &Model,
        settings: &Settings,
        forcing: f64,
        observer: &mut Observer<'_>,
    ) -> Result<Self, BackboneError> {
        let mut compute =
            |followed| Self::compute_for::<PressureForm<'_>>(model, settings, (forcing, followed), observer);
        let mut followed = FOLLOWED;
        let mut backbone = compute(followed)?;
        let (farther, times) = FARTHER;
        for _ in 0..times {
            if backbone.is_enough(model, settings, forcing) {
                break;
            }
            followed *= farther;
            backbone = compute(followed)?;
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
        Self::compute_for::<F>(model, settings, (0.0, FOLLOWED), observer)
    }

    /// The same for forcing amplitudes up to `forcing`, followed up to so many reference lengths.
    fn compute_for<'m, F: Formulation<'m>>(
        model: &'m Model,
        settings: &Settings,
        (forcing, followed): (f64, f64),
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
        let bounds = bounds(settings, problem.scales(), followed);
        let (low, high) = bounds.frequency;
        if !(low..=high).contains(&start.omega) {
            let remedy = format!("mode {} starts at {}: choose bounds round it", mode + 1, told_frequency(start.omega));
            let (key, value) =
                if start.omega < low { ("backbone.min_frequency", low) } else { ("backbone.max_frequency", high) };
            return Err(SettingsError { key, value: told_frequency(value), remedy }.into());
        }
        let way = Way { settings, bounds, forcing };
        let begin = |problem: &mut F, observer: &mut Observer<'_>| {
            let mut continuation = Continuation::start(problem, y.clone(), &direction, settings.continuation)?;
            // Beyond rest, and beyond a motion that is its own image, as at the end of a tongue, are the same motions half a period later.
            let (mut visited, stop) = up_to_branch_point(&mut continuation, |continuation, branches_off| {
                let mut rest = Rest::default();
                let mut ending = |problem: &mut F, last: &TracedPoint| match () {
                    () if rest.is_passed(problem, &last.curve.y) => Some(Stop::Start),
                    () if way.forcing > 0.0 && way.is_beyond(problem, last) => Some(Stop::ForcingBound),
                    () => branches_off(problem, last),
                };
                walk(continuation, &way.bounds, observer, &mut ending)
            });
            if stop == Stop::Start {
                visited.pop();
            }
            let (outcome, rejections) = (Outcome::Open(Stop::Start, stop), continuation.rejections());
            let walked = TracedCurve { visited, start: 0, outcome, rejections };
            Ok(Self::with_crossing(problem, &way, walked, observer))
        };
        let first = Continuation::start(&mut problem, y.clone(), &direction, settings.continuation);
        let failure = match first.map(|started| started.current().y.clone()) {
            Ok(first) if way.is_within(&mut problem, &first) => {
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
            let first = way.larger(problem, start, factor)?;
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
        let bounds = Bounds { closes: true, ..bounds(settings, problem.scales(), FOLLOWED) };
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
        Ok(Self::with_crossing(problem, way, walked, observer))
    }

    /// Whether it ends where it does for want of forcing: of levels up to `forcing` a sweep follows it farther from the first.
    pub fn falls_short(&self, model: &Model, settings: &Settings, forcing: f64) -> bool {
        let (farther, times) = FARTHER;
        let (scales, most) = (Scales::new(model, self.mode), farther.powi(times as i32));
        let is_far = self.max_amplitude() > NEARLY * most * FOLLOWED * scales.length
            || self.frequency_range().1 > NEARLY * most * SPAN * scales.frequency;
        !self.is_enough(model, settings, forcing) && !is_far
    }

    /// Whether no piece ends at a bound that may be moved where its threshold is not beyond a forcing amplitude. At low frequencies the
    /// threshold falls, and beyond frequencies that are not looked at it does not matter.
    fn is_enough(&self, model: &Model, settings: &Settings, forcing: f64) -> bool {
        let (limits, own) = (&settings.backbone, model.modes().frequencies[self.mode]);
        let is_cut = |stop: Stop, end: &BackbonePoint| {
            let omega = end.point.omega();
            let is_fixed = match stop {
                Stop::AmplitudeBound => limits.max_amplitude.is_some(),
                Stop::ForcingBound => false,
                Stop::FrequencyBound => {
                    omega < own
                        || limits.max_frequency.is_some()
                        || settings.frequency.max.is_some_and(|max| omega > max)
                }
                _ => true,
            };
            !is_fixed && end.threshold() <= ENOUGH * forcing
        };
        let outcomes = iter::once(&self.outcome).chain(&self.crossing);
        outcomes.zip(self.pieces()).all(|(outcome, piece)| match (*outcome, piece) {
            (Outcome::Open(first, last), [begin, .., end]) => !is_cut(first, begin) && !is_cut(last, end),
            _ => true,
        })
    }
}
