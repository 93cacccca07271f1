//! From which forcing on something touches.

use super::work::driven;
use crate::study::Study;
use results::overview::is_within;
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

/// Where the linear structure touches first.
pub(super) struct FirstTouch<'m> {
    /// Forcing amplitude A.
    pub forcing: f64,
    /// The contact or elastic stop.
    pub name: &'m str,
    /// At which frequency.
    pub place: Place,
}

/// A frequency that stands out.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    /// Linear resonance of a mode, from 0.
    Resonance(usize),
    /// A bound of the study, rad/s.
    Bound(f64),
}

impl std::fmt::Display for FirstTouch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "from A = {} on, {} first, ", number(self.forcing), self.name)?;
        match self.place {
            Place::Resonance(mode) => write!(f, "at the linear resonance of mode {}", mode + 1),
            Place::Bound(omega) => {
                write!(
                    f,
                    "at the bound {} rad/s, by the linear response there and at resonances: isolas may touch much earlier",
                    number(omega)
                )
            }
        }
    }
}

/// Where contacts and elastic stops touch first, the forcing growing, in the linear response at its bounds and at the resonances of the
/// modes that are followed and driven. `None` if nothing has a gap, or where the linear response has no bound.
pub(super) fn first_touch<'s>(study: &'s Study, followed: &[usize]) -> Option<FirstTouch<'s>> {
    let (model, settings) = (&study.model, &study.settings);
    let (unknown, scales) = (Unknown::Frequency { forcing: 1.0 }, Scales::new(model, settings.tracked(model)));
    let problem = PressureForm::build(model, settings.harmonics, settings.tracked(model), unknown, scales).ok()?;
    let resonance = |mode: usize| model.modes().frequencies[mode] / model.forcing().harmonic as f64;
    let FrequencySettings { min, max } = settings.frequency;
    // A stop that is pressed at rest changes the linear response.
    let is_pressed = |element: &Element| matches!(&element.law, LawKind::PenaltySpring(spring) if spring.gap < 0.0);
    if model.elements().iter().any(is_pressed) {
        return None;
    }
    let (own, others): (Vec<usize>, Vec<usize>) = driven(model)
        .into_iter()
        .filter(|&mode| is_within(settings.frequency, resonance(mode)))
        .partition(|mode| followed.contains(mode));
    if own.is_empty() && !others.is_empty() {
        return None;
    }
    let resonances = own.into_iter().map(|mode| (Place::Resonance(mode), resonance(mode)));
    let bounds = [min, max].into_iter().flatten().map(|omega| (Place::Bound(omega), omega));
    let places = resonances.chain(bounds);
    let touches = places.filter_map(|(place, omega)| touch_at(&problem, model, place, omega));
    touches.min_by(|a, b| a.forcing.total_cmp(&b.forcing))
}

/// What touches first at a frequency.
fn touch_at<'m>(problem: &PressureForm<'_>, model: &'m Model, place: Place, omega: f64) -> Option<FirstTouch<'m>> {
    let response = forced_response(problem, 1.0, omega).ok()?;
    let touch = |(element, gap): (&'m Element, f64)| {
        let displacement = complex(&response.combine(shape(model, element)), model.forcing().harmonic).norm();
        (gap / displacement, element)
    };
    let first = stops(model).map(touch).filter(|(forcing, _)| forcing.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0));
    first.map(|(forcing, element)| FirstTouch { forcing, name: &element.name, place })
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
