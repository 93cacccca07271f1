//! From which forcing on something touches.

use super::units::frequency;
use crate::study::Study;
use results::overview::{acting_at_rest, is_within, pressed_at_rest};
use results::words::number;
use solver::formulation::Formulation;
use solver::formulation::harmonics::complex;
use solver::formulation::linear::forced_response;
use solver::formulation::pressure::PressureForm;
use solver::formulation::scales::Scales;
use solver::formulation::unknown::Unknown;
use solver::settings::FrequencySettings;
use solver::structure::laws::{Law, LawKind};
use solver::structure::{Element, Model};

/// How far about a resonance the response is looked at, in half-widths ζω of it.
const BESIDE: f64 = 6.0;
/// At how many frequencies there.
const LOOKED_AT: usize = 120;
/// How often the interval about the largest response is narrowed.
const NARROWED: usize = 40;

/// What the linear response does not tell.
const ISOLAS: &str = "isolas may be there, and touch, from far lower forcing on, \
                      or be born at several times it, or at tens of times: levels from a third of it to five times it are a start, and, \
                      where these show none, larger ones";

/// Where the linear structure touches first.
pub(super) struct FirstTouch<'m> {
    /// Forcing amplitude A.
    pub forcing: f64,
    /// The contact or elastic stop.
    pub name: &'m str,
    /// Near what.
    pub place: Place,
    /// At which frequency, rad/s.
    pub omega: f64,
    /// Elements that act on small motions and are left out here.
    pub left_out: Vec<&'m str>,
}

/// What stands out among the frequencies.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    /// Linear resonance of a mode, from 0.
    Resonance(usize),
    /// A bound of the study.
    Bound,
}

impl FirstTouch<'_> {
    /// In words.
    pub fn told(&self, study: &Study) -> String {
        let (forcing, omega) = (number(self.forcing), frequency(study, self.omega));
        let names: Vec<String> = self.left_out.iter().map(|name| format!("`{name}`")).collect();
        let linear = if names.is_empty() {
            "in the linear response alone".into()
        } else {
            format!("in the response of the matrices alone; with {} it may be much earlier or later", names.join(", "))
        };
        let place = match self.place {
            Place::Resonance(mode) => format!("at {omega}, at the resonance of mode {}, {linear}", mode + 1),
            Place::Bound => format!("at the bound {omega}, {linear}; looked at there and at resonances"),
        };
        format!("from A = {forcing} on, {} first, {place}; {ISOLAS}", self.name)
    }
}

/// The structure of a study, whose linear responses are looked at.
pub(super) fn linear_problem(study: &Study) -> Option<PressureForm<'_>> {
    let (model, settings) = (&study.model, &study.settings);
    let (unknown, scales) = (Unknown::Frequency { forcing: 1.0 }, Scales::new(model, settings.tracked(model)));
    PressureForm::build(model, settings.harmonics, settings.tracked(model), unknown, scales).ok()
}

/// Where contacts and elastic stops touch first, the forcing growing, in the linear response at its bounds and about the resonances of
/// the modes that are followed and driven. `None` if nothing has a gap, or where the linear response has no bound.
pub(super) fn first_touch<'s>(study: &'s Study, followed: &[usize]) -> Option<FirstTouch<'s>> {
    let (model, settings) = (&study.model, &study.settings);
    let problem = linear_problem(study)?;
    let m = model.forcing().harmonic as f64;
    let resonance = |mode: usize| model.resonance(mode).0 / m;
    let FrequencySettings { min, max } = settings.frequency;
    // A stop that is pressed at rest changes the linear response.
    if pressed_at_rest(model).next().is_some() {
        return None;
    }
    let (own, others): (Vec<usize>, Vec<usize>) = model
        .driven()
        .into_iter()
        .filter(|&mode| is_within(settings.frequency, resonance(mode)))
        .partition(|mode| followed.contains(mode));
    if own.is_empty() && !others.is_empty() {
        return None;
    }
    let at = |omega: f64| touch_at(&problem, model, omega);
    let all: Vec<f64> = model.driven().into_iter().map(resonance).collect();
    let about =
        own.into_iter().filter_map(|mode| {
            let (omega, reach) = (resonance(mode), BESIDE * model.resonance(mode).1.abs() / m);
            // Beyond the middle between two resonances it is that of the other.
            let others = all.iter().filter(|&&other| other != omega).map(|other| f64::midpoint(*other, omega));
            let middle = others.fold((0.0_f64, f64::INFINITY), |(low, high), at| {
                if at < omega { (low.max(at), high) } else { (low, high.min(at)) }
            });
            let low = (omega - reach).max(min.unwrap_or(0.0)).max(middle.0).max(omega / LOOKED_AT as f64);
            let high = (omega + reach).min(max.unwrap_or(f64::INFINITY)).min(middle.1);
            let first = smallest(|omega| at(omega).map(|(forcing, _)| forcing), omega, (low, high))?;
            Some((Place::Resonance(mode), first))
        });
    let bounds = [min, max].into_iter().flatten().map(|omega| (Place::Bound, omega));
    let touches = about.chain(bounds).filter_map(|(place, omega)| {
        let (forcing, name) = at(omega)?;
        Some(FirstTouch {
            forcing,
            name,
            place,
            omega,
            left_out: acting_at_rest(model).map(|element| element.name.as_str()).collect(),
        })
    });
    touches.min_by(|a, b| a.forcing.total_cmp(&b.forcing))
}

/// Where a function is smallest between these ends; nowhere if it has no value at `middle`, a resonance without damping.
pub(super) fn smallest(of: impl Fn(f64) -> Option<f64>, middle: f64, (low, high): (f64, f64)) -> Option<f64> {
    of(middle)?;
    let place = |i: usize| low + (high - low) * i as f64 / LOOKED_AT as f64;
    let value = |x: f64| of(x).unwrap_or(f64::INFINITY);
    let values: Vec<f64> = (0..=LOOKED_AT).map(|i| value(place(i))).collect();
    let best = (0..=LOOKED_AT).min_by(|&i, &j| values[i].total_cmp(&values[j]))?;
    let (mut a, mut b) = (place(best.saturating_sub(1)), place((best + 1).min(LOOKED_AT)));
    for _ in 0..NARROWED {
        let (left, right) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
        if value(left) < value(right) { b = right } else { a = left }
    }
    Some(f64::midpoint(a, b))
}

/// What touches first at a frequency, and from which forcing on.
fn touch_at<'m>(problem: &PressureForm<'_>, model: &'m Model, omega: f64) -> Option<(f64, &'m str)> {
    let response = forced_response(problem, 1.0, omega).ok()?;
    let touch = |(element, gap): (&'m Element, f64)| {
        let displacement = complex(&response.combine(shape(model, element)), model.forcing().harmonic).norm();
        (gap / displacement, element.name.as_str())
    };
    stops(model).map(touch).filter(|(forcing, _)| forcing.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Elements that act once a gap is closed, with their gaps; none that is pressed at rest.
fn stops(model: &Model) -> impl Iterator<Item = (&Element, f64)> {
    model.elements().iter().filter_map(|element| match (&element.law, element.law.rigid()) {
        (_, Some(contact)) => Some((element, contact.gap.max(0.0))),
        (LawKind::PenaltySpring(spring), _) => (spring.gap > 0.0).then_some((element, spring.gap)),
        _ => None,
    })
}

/// Displacement of an element along its first argument in every mode.
pub(super) fn shape(model: &Model, element: &Element) -> Vec<f64> {
    model.modes().along(&element.channels[0]).collect()
}
