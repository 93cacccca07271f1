//! What goes wrong before anything is computed: units that slipped, matrices exchanged, levels at which nothing touches.

use super::touch::{FirstTouch, Place, shape};
use super::units::frequencies_between;
use super::{bounds, lengths};
use crate::study::Study;
use protocol::session::MAX_RESULT_BYTES;
use results::words::{self, count, digits, number};
use solver::formulation::harmonics::width;
use solver::linalg::eigenvalues;
use solver::settings::Settings;
use solver::structure::laws::LawKind;
use solver::structure::{ContactElement, Damping, Model};

/// Eigenfrequencies that no structure has, rad/s: all of them below or above.
const ABSURD: (f64, f64) = (1e-3, 1e9);
/// Structures are rarely slower than this, rad/s; if all modes are, and none would be with K and M exchanged, they are.
const SLOW: f64 = 0.1;
/// Share of the largest eigenvalue of a damping matrix that is rounding, also of a file with seven digits.
const UNDAMPED: f64 = 1e-6;
/// A linear response that is so many times as large as what may be before something touches is hardly meant.
const BEYOND: f64 = 300.0;
/// A first touch at so many times the highest level may be one of a gap in millimetres.
const SLIPPED: f64 = 50.0;
/// Numbers that a point of a branch has beside its state, about.
const BESIDE: usize = 64;
/// Between these shares of the condensed stiffness the prediction of contact forces works well.
const EPSILON: (f64, f64) = (0.1, 1e3);

/// Smallest and largest ratio of ε to the static stiffness of the structure at the contacts; `None` if the structure is
/// free to move there.
pub(super) fn epsilon_ratios(model: &Model) -> Option<(f64, f64)> {
    let modes = model.modes();
    let ratio = |contact: ContactElement<'_>| {
        let shape = shape(model, contact.element);
        let is_free = shape.iter().enumerate().any(|(j, b)| *b != 0.0 && modes.is_rigid(j));
        let compliance: f64 = shape.iter().zip(&modes.frequencies).map(|(b, omega)| (b / omega).powi(2)).sum();
        (!is_free).then_some(contact.law.epsilon * compliance)
    };
    let ratios: Vec<f64> = model.contacts().filter_map(ratio).filter(|ratio| ratio.is_finite()).collect();
    let low = ratios.iter().copied().reduce(f64::min)?;
    Some((low, ratios.iter().copied().reduce(f64::max)?))
}

/// Sentences about what is probably not meant.
pub(super) fn warnings(study: &Study, touch: Option<&FirstTouch<'_>>) -> Vec<String> {
    let mut list: Vec<String> = units(study).into_iter().collect();
    list.extend(bounds::warnings(study));
    list.extend(self_excited(&study.model));
    list.extend(nothing_nonlinear(&study.model));
    list.extend(nothing_driven(&study.model));
    list.extend(touch.filter(|touch| touch.left_out.is_empty()).and_then(|touch| nothing_touches(study, touch)));
    list.extend(touch.and_then(|touch| far_beyond(study, touch)));
    list.extend(epsilon_ratios(&study.model).and_then(epsilon));
    list.extend(large_results(study));
    list.extend(study.without_effect.iter().map(|key| {
        format!("{key} has no effect any more: branches close by convergence onto their first points; leave it out")
    }));
    list
}

/// Of structures that are none: units that slipped, or matrices exchanged.
pub(super) fn units(study: &Study) -> Option<String> {
    frequencies(study).or_else(|| lengths::in_millimetres(study))
}

/// Of frequencies that no structure has.
fn frequencies(study: &Study) -> Option<String> {
    let model = &study.model;
    let frequencies = &model.modes().frequencies;
    let highest = *frequencies.last()?;
    let lowest = frequencies[(0..model.size()).find(|&j| !model.modes().is_rigid(j))?];
    let between = frequencies_between(study, lowest, highest);
    if highest < SLOW {
        let exchanged = frequencies_between(study, 1.0 / highest, 1.0 / lowest);
        let absurd = if highest < ABSURD.0 { "no structure has" } else { "hardly a structure has" };
        return Some(format!(
            "{absurd} only modes from {between}: are K and M exchanged? The other way round they lie at {exchanged}"
        ));
    }
    (lowest > ABSURD.1).then(|| {
        format!(
            "no structure has only modes from {between}: are K and M exchanged, or their units others than N/m and kg?"
        )
    })
}

/// That a structure is driven by what should damp it.
pub(super) fn self_excited(model: &Model) -> impl Iterator<Item = String> {
    let linear = negative_damping(model).or_else(|| indefinite_damping(model));
    linear.into_iter().chain(feeding_laws(model))
}

fn negative_damping(model: &Model) -> Option<String> {
    let rates = model.damping().rates();
    let modes = (0..model.size()).filter(|&j| rates[j] < 0.0);
    let list: Vec<String> = modes.map(|j| (j + 1).to_string()).collect();
    let modes = if list.len() == 1 { "mode" } else { "modes" };
    (!list.is_empty()).then(|| {
        format!(
            "{modes} {}: negative linear damping; unless laws take more, the structure can vibrate by itself from rest",
            list.join(", ")
        )
    })
}

/// Of modes that are damped, and into which linear terms of dampers feed more than that takes.
fn feeding_laws(model: &Model) -> Option<String> {
    let mut rates = model.damping().rates();
    let is_damped: Vec<bool> = rates.iter().map(|rate| *rate >= 0.0).collect();
    for element in model.elements() {
        let LawKind::PolynomialDamper(damper) = &element.law else { continue };
        let linear: f64 = damper.terms.iter().filter(|term| term.power == 1).map(|term| term.coefficient).sum();
        rates.iter_mut().zip(shape(model, element)).for_each(|(rate, along)| *rate += linear * along * along);
    }
    let fed: Vec<usize> = (0..model.size()).filter(|&j| is_damped[j] && rates[j] < 0.0).collect();
    (!fed.is_empty()).then(|| {
        format!(
            "{}: linear terms of polynomial_damper laws feed in more than the damping takes; the structure can vibrate by itself from rest",
            words::modes(&fed)
        )
    })
}

/// Of a damping matrix that damps every mode, and drives motions of several.
fn indefinite_damping(model: &Model) -> Option<String> {
    let Damping::Full(matrix) = model.damping() else { return None };
    let mut values: Vec<f64> = eigenvalues(matrix).ok()?.iter().map(|value| value.re).collect();
    values.sort_by(f64::total_cmp);
    let (least, most) = (values.first()?, values.last()?);
    (*least < -UNDAMPED * most).then(|| {
        format!(
            "the damping matrix is indefinite (its eigenvalues in modal coordinates lie from {} to {} 1/s): in some motions it drives the structure; \
             is a sign wrong?",
            digits(*least, 3),
            digits(*most, 3)
        )
    })
}

fn nothing_nonlinear(model: &Model) -> Option<String> {
    model.elements().is_empty().then(|| {
        "nothing is nonlinear: neither contact nodes ([[contact.nodes]]) nor laws ([[laws]]) are given, and there can be no \
         isola"
            .into()
    })
}

/// Of a force that drives no mode that vibrates.
fn nothing_driven(model: &Model) -> Option<String> {
    model.driven().is_empty().then(|| {
        "the force drives rigid-body motions alone; forcing.shape = {mode = N} or {dofs = {NAME = 1}} gives another"
            .into()
    })
}

fn nothing_touches(study: &Study, touch: &FirstTouch<'_>) -> Option<String> {
    let highest = study.amplitudes.iter().map(|amplitude| amplitude.value).reduce(f64::max)?;
    // Where the study leaves out all resonances, isolas may touch long before the linear response does.
    let Place::Resonance(mode) = touch.place else { return None };
    let units = if touch.forcing > SLIPPED * highest { " (lengths are in m: a gap of 2 mm is 0.002)" } else { "" };
    (highest < touch.forcing).then(|| {
        format!(
            "nothing touches in the linear response at the resonance of mode {}: {} up to A = {}, the first touch at A = {}{units}; isolas may \
             be there nevertheless",
            mode + 1,
            count(study.amplitudes.len(), "level"),
            number(highest),
            number(touch.forcing)
        )
    })
}

/// Of levels at which the linear response goes through what it touches many times over, unless units are known to have slipped.
pub(super) fn far_beyond(study: &Study, touch: &FirstTouch<'_>) -> Option<String> {
    if !touch.left_out.is_empty() || units(study).is_some() {
        return None;
    }
    let highest = study.amplitudes.iter().max_by(|a, b| a.value.total_cmp(&b.value))?;
    let Place::Resonance(mode) = touch.place else { return None };
    (touch.forcing > 0.0 && highest.value > BEYOND * touch.forcing).then(|| {
        format!(
            "at A = {} the linear response at the resonance of mode {} is {} times as large as what it may be before {} touches: check the units of \
             forcing and gap",
            highest.text,
            mode + 1,
            digits(highest.value / touch.forcing, 2),
            touch.name
        )
    })
}

/// Of branches that would be too large to be sent if they used up their points.
fn large_results(study: &Study) -> Option<String> {
    let Settings { harmonics, branch, .. } = study.settings;
    let numbers = (study.model.size() + study.model.arguments()) * width(harmonics.count) + BESIDE;
    let bytes = size_of::<f64>() * numbers;
    // Each way from where it begins.
    let most = MAX_RESULT_BYTES / (2 * bytes);
    (branch.max_points > most).then(|| {
        let (each, limit) = (number(bytes as f64 / 1e3), number(MAX_RESULT_BYTES as f64 / 1e6));
        format!(
            "a branch that used up branch.max_points = {} would be too large to be sent: a point has {each} kB, a branch at most \
             {limit} MB; use at most {most}",
            branch.max_points
        )
    })
}

fn epsilon((low, high): (f64, f64)) -> Option<String> {
    let (ratio, what) = match (low, high) {
        (low, _) if low < EPSILON.0 => (low, "soft"),
        (_, high) if high > EPSILON.1 => (high, "stiff"),
        _ => return None,
    };
    Some(format!(
        "contact.epsilon is {what}: {} times the stiffness of the structure at the contact; 0.1 to 1000 times works well",
        number(ratio)
    ))
}
