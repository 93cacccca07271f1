//! What goes wrong before anything is computed: units that slipped, matrices exchanged, levels at which nothing touches.

use super::touch::{FirstTouch, Place, shape};
use crate::study::Study;
use protocol::session::MAX_RESULT_BYTES;
use results::words::{count, digits, number};
use solver::formulation::harmonics::width;
use solver::linalg::eigenvalues;
use solver::settings::Settings;
use solver::structure::{ContactElement, Damping, Model};
use std::f64::consts::TAU;

/// Eigenfrequencies that no structure has, rad/s: all of them below or above.
const ABSURD: (f64, f64) = (1e-3, 1e9);
/// Structures are rarely slower than this, rad/s; if all modes are, and none would be with K and M exchanged, they are.
const SLOW: f64 = 0.1;
/// A force that does less work than this share on all modes that vibrate drives none of them.
const DRIVEN: f64 = 1e-9;
/// Share of the largest eigenvalue of a damping matrix that is rounding, also of a file with seven digits.
const UNDAMPED: f64 = 1e-6;
/// Bounds nearer to a resonance than so many of its half-widths ζω cut it: there it has a fifth of its height.
const FLANK: f64 = 5.0;
/// Resonances whose flanks reach farther than this share of their frequency are too wide to be told from what is beside them.
const SHARP: f64 = 0.25;
/// Orders of superharmonic resonances that a study may be of.
const ORDERS: usize = 5;
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
    let mut list = Vec::new();
    list.extend(units(&study.model));
    list.extend(bounds(study));
    list.extend(negative_damping(&study.model).or_else(|| indefinite_damping(&study.model)));
    list.extend(nothing_nonlinear(&study.model));
    list.extend(nothing_driven(&study.model));
    list.extend(touch.and_then(|touch| nothing_touches(study, touch)));
    list.extend(epsilon_ratios(&study.model).and_then(epsilon));
    list.extend(large_results(study));
    list.extend(study.without_effect.iter().map(|key| {
        format!("{key} has no effect any more: branches close by convergence onto their first points; leave it out")
    }));
    list
}

/// Sentences about bounds of the frequency that are probably not meant.
pub(super) fn bounds(study: &Study) -> Vec<String> {
    hertz(study).into_iter().chain(flanks(study)).collect()
}

fn units(model: &Model) -> Option<String> {
    let frequencies = &model.modes().frequencies;
    let highest = *frequencies.last()?;
    let lowest = frequencies[(0..model.size()).find(|&j| !model.modes().is_rigid(j))?];
    let (low, high) = (number(lowest), number(highest));
    if highest < SLOW {
        let exchanged = format!("{} to {} rad/s", number(1.0 / highest), number(1.0 / lowest));
        let absurd = if highest < ABSURD.0 { "no structure has" } else { "hardly a structure has" };
        return Some(format!(
            "{absurd} only modes from {low} to {high} rad/s: are K and M exchanged? The other way round they lie at \
             {exchanged}"
        ));
    }
    (lowest > ABSURD.1).then(|| {
        format!("no structure has only modes from {low} to {high} rad/s: are K and M exchanged, or their units others than N/m and kg?")
    })
}

/// Of bounds between which no mode resonates, but would if they were Hz.
fn hertz(study: &Study) -> Option<String> {
    let given = study.settings.frequency;
    let (low, high) = (given.min?, given.max?);
    let modes = study.model.modes();
    let mut resonances = (0..study.model.size()).filter(|&j| !modes.is_rigid(j)).map(|j| modes.frequencies[j]);
    let is_between = |omega: f64, unit: f64| (unit * low..=unit * high).contains(&omega);
    let orders = 1..=ORDERS.max(study.model.forcing().harmonic);
    if resonances.clone().any(|omega| orders.clone().any(|order| is_between(omega / order as f64, 1.0))) {
        return None;
    }
    let m = study.model.forcing().harmonic as f64;
    let meant = resonances.find(|omega| is_between(omega / m, TAU))?;
    Some(format!(
        "no mode resonates between frequency.min = {} and frequency.max = {} rad/s, but one does at {} Hz: if Hz are meant, they are {} \
         and {} rad/s",
        number(low),
        number(high),
        number(meant / m / TAU),
        number(TAU * low),
        number(TAU * high)
    ))
}

/// Of bounds that lie on the flank of a resonance that the force drives, so that what responds there is known in part.
fn flanks(study: &Study) -> Vec<String> {
    let (model, given) = (&study.model, study.settings.frequency);
    let (modes, rates, m) = (model.modes(), model.damping().rates(), model.forcing().harmonic as f64);
    let largest = (0..model.size()).map(|j| work(model, j)).fold(0.0, f64::max);
    let is_driven = |j: &usize| !modes.is_rigid(*j) && rates[*j] > 0.0 && work(model, *j) > DRIVEN * largest;
    // In frequencies of the response, of which the force has m times as much.
    let resonance = |j: usize| (j, modes.frequencies[j] / m, 0.5 * rates[j] / m);
    let is_sharp = |(_, omega, half): &(usize, f64, f64)| FLANK * half < SHARP * omega;
    let resonances: Vec<_> = (0..model.size()).filter(is_driven).map(resonance).filter(is_sharp).collect();
    let cut = |(key, bound): (&str, f64)| {
        let distance = |(_, omega, half): &(usize, f64, f64)| (bound - omega).abs() / half;
        let nearest = resonances.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let (j, omega, half) = *nearest;
        (distance(nearest) < FLANK).then(|| {
            format!(
                "{key} = {} rad/s cuts through the resonance of mode {} at {} rad/s, {} of its half-widths from it: branches end on its \
                 flank, and their peaks may lie beyond; a bound below {} or above {} rad/s does not",
                number(bound),
                j + 1,
                number(omega),
                digits(distance(nearest), 2),
                number(omega - FLANK * half),
                number(omega + FLANK * half)
            )
        })
    };
    let bounds = [("frequency.min", given.min), ("frequency.max", given.max)];
    bounds.into_iter().filter_map(|(key, bound)| cut((key, bound?))).collect()
}

/// What a force of its shape does on a mode: its share of modal amplitude.
fn work(model: &Model, j: usize) -> f64 {
    let (modes, shape) = (model.modes(), &model.forcing().shape);
    (0..model.size()).map(|dof| modes.shapes[(dof, j)] * shape[dof]).sum::<f64>().abs()
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
    model
        .elements()
        .is_empty()
        .then(|| "nothing is nonlinear: neither contact nor laws are given, and there can be no isola".into())
}

/// Of a force that drives no mode that vibrates.
fn nothing_driven(model: &Model) -> Option<String> {
    let modes = model.modes();
    let largest = |is_rigid: bool| {
        let of_kind = (0..model.size()).filter(|&j| modes.is_rigid(j) == is_rigid);
        of_kind.map(|j| work(model, j)).fold(0.0, f64::max)
    };
    (largest(false) < DRIVEN * largest(true)).then(|| {
        "the force drives rigid-body motions alone; forcing.shape = {mode = N} or {dofs = {NAME = 1}} gives another"
            .into()
    })
}

fn nothing_touches(study: &Study, touch: &FirstTouch<'_>) -> Option<String> {
    let highest = study.amplitudes.iter().map(|amplitude| amplitude.value).reduce(f64::max)?;
    // Where the study leaves out all resonances, isolas may touch long before the linear response does.
    let Place::Resonance(mode) = touch.place else { return None };
    (highest < touch.forcing).then(|| {
        format!(
            "nothing will touch at the resonance of mode {}: {} up to A = {}, the first touch at A = {}",
            mode + 1,
            count(study.amplitudes.len(), "level"),
            number(highest),
            number(touch.forcing)
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
