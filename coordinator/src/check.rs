//! What `isola check` says of a study before anything is computed.

mod bounds;
mod damping;
mod defaults;
mod early;
mod laws;
mod lengths;
mod slip;
mod small_motion;
mod softening;
mod touch;
mod units;
mod weight;

use crate::study::Study;
use damping::Oscillations;
use protocol::to_everyone::Amplitude;
use results::overview::{modes, undetermined};
use results::summary_table::LengthUnit;
use results::words::{self, count, digits, number};
use solver::formulation::harmonics::width;
use solver::response::modes::ModesFollowed;
use solver::response::orders::{Order, Orders};
use solver::settings::{FrequencySettings, Quadrature, Settings};
use solver::structure::Model;
use solver::structure::laws::{Law, RigidContact};
use std::f64::consts::TAU;

/// Eigenfrequencies shown.
const MODES: usize = 6;

/// Harmonics of the force with fewer of which motions of several of its periods may be missed.
const FEW: usize = 5;

/// Levels from which on a sweep says how many there are.
const MANY: usize = 300;

/// The study in a few aligned lines.
pub fn report(study: &Study) -> String {
    let model = &study.model;
    let mut lines = vec![
        ("study", study.name.clone()),
        ("file", study.file.display().to_string()),
        ("model", format!("{} ({})", model.name(), study.model_dir.display())),
        ("size", size(model)),
    ];
    let choice = ModesFollowed::choose(model, &study.settings);
    let oscillations = Oscillations::of(model, &study.settings);
    let mode = |j: usize| mode(study, &choice, j, &oscillations);
    lines.extend((0..model.size().min(MODES)).map(|j| (if j == 0 { "modes" } else { "" }, mode(j))));
    lines.extend(small_motion::frequencies(study).map(|frequencies| ("", frequencies)));
    lines.extend(modes::sentence(&choice, true).map(|_| ("followed", followed(&choice))));
    lines.extend(defaults::damping(study).or_else(|| defaults::replaced(study)).map(|damping| ("damping", damping)));
    lines.push(("forcing", forcing(study)));
    lines.extend(contact(study).map(|contact| ("contact", contact)));
    let touch = touch::first_touch(study, &choice.followed);
    lines.extend(touch.as_ref().map(|touch| ("touches", touch.told(study))));
    lines.extend(slip::first_slip(study, &choice.followed).map(|slip| ("slips", slip.told(study))));
    let overdamped = oscillations.overdamped();
    let weight = laws_weight(study, &choice.followed, &overdamped);
    let known = weight.as_ref().filter(|weight| weight.forcing.is_finite());
    lines.extend(known.map(|weight| ("laws", weight.to_string())));
    let ratios = early::epsilon_ratios(model).map(|(low, high)| span([low, high].into_iter()));
    lines.extend(ratios.map(|ratio| ("epsilon", format!("{ratio} times the stiffness of the structure there"))));
    let monitors: Vec<&str> = model.monitors().iter().map(|&dof| model.dofs()[dof].as_str()).collect();
    lines.push(("monitored", monitors.join(", ")));
    lines.push(("amplitudes", amplitudes(&study.amplitudes)));
    lines.push(("harmonics", harmonics(study)));
    lines.push(("unknowns", unknowns(study)));
    lines.push(("frequency", frequency(study)));
    lines.extend(bounds::quiet(study).map(|sentence| ("", sentence)));
    lines.extend(orders(study).into_iter().map(|order| ("order", order)));
    let warnings = overdamped
        .into_iter()
        .chain(early::warnings(study, touch.as_ref()))
        .chain(damping::without(study))
        .chain(oscillations.heavy())
        .chain(undetermined(model))
        .chain(softening::warnings(study))
        .chain(laws::warnings(study, weight.as_ref()));
    lines.extend(warnings.map(|warning| ("warning", warning)));
    lines.into_iter().map(|(what, text)| format!("{what:<12}{text}\n")).collect()
}

/// How much laws weigh at the resonances of these modes. Where nothing resonates no law is measured by the response at resonance.
fn laws_weight(study: &Study, followed: &[usize], overdamped: &[String]) -> Option<weight::Weight> {
    weight::Weight::of(study, if overdamped.is_empty() { followed } else { &[] })
}

/// The orders of motions, where several are looked for: where they are, and which resonances they can have.
fn orders(study: &Study) -> Vec<String> {
    let orders = Orders::of(&study.model, &study.settings);
    let list = orders.iter().map(|order| {
        let FrequencySettings { min, max } = order.settings.frequency;
        let is_within = |omega: f64| min.is_none_or(|min| omega >= min) && max.is_none_or(|max| omega <= max);
        let frequencies = &order.model.modes().frequencies;
        let own: Vec<usize> = (0..frequencies.len()).filter(|&mode| is_within(frequencies[mode])).collect();
        let unit = study.frequency_unit();
        let told = |omega: f64| digits(unit.factor() * omega, 6);
        let between = match (min.map(told), max.map(told)) {
            (Some(min), Some(max)) => format!("between {min} and {max} {unit}"),
            (Some(min), None) => format!("from {min} {unit} to 10 % beyond its resonances, which the sweep computes"),
            (None, Some(max)) => format!("from 10 % below its resonances, which the sweep computes, to {max} {unit}"),
            (None, None) => "10 % beyond its resonances, which the sweep computes".into(),
        };
        let modes = match &own[..] {
            [] => "no eigenfrequency there".to_string(),
            own => format!("eigenfrequencies there: {}", words::modes(own)),
        };
        let number = order.number();
        let periods = count(number, "period");
        let harmonics = match number {
            1 => String::new(),
            _ => {
                let (all, own) = (study.settings.harmonics.count, of_the_force(study, number));
                format!(
                    "; of its {} {own} {} of the force",
                    count(all, "harmonic"),
                    if own == 1 { "is" } else { "are" }
                )
            }
        };
        format!("{number}: motions that last {periods} of the force, {between}; {modes}{harmonics}")
    });
    // One alone is what the lines before are about.
    let list: Vec<String> = list.collect();
    if list.len() > 1 { list } else { Vec::new() }
}

/// What a sweep warns of, since it decides what can be found: units, bounds of the frequency, damping, a place that is not determined, a
/// spring that pushes away, laws that hardly do anything, levels far beyond what touches. Sentences.
pub fn warnings_of_sweep(study: &Study) -> Vec<String> {
    let assumed = defaults::damping(study).map(|damping| format!("the damping is {damping}"));
    let (model, settings) = (&study.model, &study.settings);
    let overdamped = Oscillations::of(model, settings).overdamped();
    let followed = ModesFollowed::choose(model, settings).followed;
    let weight = laws_weight(study, &followed, &overdamped);
    let touch = touch::first_touch(study, &followed);
    let far_beyond = touch.and_then(|touch| early::far_beyond(study, &touch));
    let warnings = early::units(study).into_iter().chain(bounds::warnings(study)).chain(damping::without(study));
    let warnings = warnings.chain(early::self_excited(model)).chain(assumed).chain(undetermined(model));
    warnings
        .chain(softening::warnings(study))
        .chain(far_beyond)
        .chain(weight.and_then(|weight| weight.practically_linear(study)))
        .collect()
}

/// What a sweep notes, of what may well be meant: that there are very many levels, that nothing resonates within its bounds, where the force acts if nobody said so, stops
/// that are pressed at rest, laws that are too soft to matter, few harmonics for motions of many periods. Sentences.
pub fn notes_of_sweep(study: &Study) -> Vec<String> {
    (many_levels(study).into_iter())
        .chain(bounds::note(study))
        .chain(defaults::replaced(study))
        .chain(defaults::forcing(study))
        .chain(laws::pressed(study))
        .chain(laws::soft(study))
        .chain(few_harmonics(study))
        .collect()
}

/// How many harmonics of motions of an order are harmonics of the force.
fn of_the_force(study: &Study, order: usize) -> usize {
    study.settings.harmonics.count / order
}

/// That motions of the highest order that is looked for have few harmonics of the force: a sentence.
fn few_harmonics(study: &Study) -> Option<String> {
    let orders = Orders::of(&study.model, &study.settings);
    let longest = orders.iter().map(Order::number).max().filter(|order| *order > 1)?;
    let (all, own) = (study.settings.harmonics.count, of_the_force(study, longest));
    (own < FEW).then(|| {
        format!(
            "harmonics.count = {all}, of which motions that last {longest} periods of the force have {own} of the force: some may be \
             missed, or come out wrong; {} resolves them as {all} does motions of the force's own period",
            longest * all
        )
    })
}

/// That there are many levels, which may not be meant: a sentence.
fn many_levels(study: &Study) -> Option<String> {
    let (amplitudes, orders) = (study.amplitudes.len(), Orders::of(&study.model, &study.settings).iter().count());
    let levels = amplitudes * orders;
    let of_orders = if orders > 1 { format!(" ({amplitudes} of each of {orders} orders)") } else { String::new() };
    (levels >= MANY).then(|| {
        format!(
            "{levels} levels{of_orders}, each of which is searched: how long one takes is known when the first are done, and the progress of \
             the sweep tells what is left then; a run of fewer is extended by isola extend RUN --amplitudes LIST"
        )
    })
}

/// Why the mode that a sweep begins with has no backbone, if that is known before: a sentence.
pub fn without_backbone(model: &Model, settings: &Settings) -> Option<String> {
    Oscillations::of(model, settings).overdamped_primary()
}

fn size(model: &Model) -> String {
    let contacts = match model.contacts().count() {
        0 => "no rigid contact".into(),
        contacts => count(contacts, "contact element"),
    };
    let others = model.elements().iter().filter(|element| element.law.rigid().is_none());
    let names: Vec<&str> = others.map(|element| element.name.as_str()).collect();
    let laws = match names.len() {
        0 => "no other laws".to_string(),
        others => format!("{} ({})", count(others, "other law"), shortened(&names)),
    };
    format!("{}, {contacts}, {laws}", count(model.size(), "dof"))
}

/// The modes followed, as far as that can be, and why others are not: where backbones start only the sweep tells.
fn followed(choice: &ModesFollowed) -> String {
    let rest = modes::left_out(choice);
    let rest = if rest.is_empty() { String::new() } else { format!("; not {}", rest.join(", ")) };
    let start = if choice.followed.len() == 1 { "if its backbone starts" } else { "as far as their backbones start" };
    format!("{}, {start}{rest}", modes::followed(choice))
}

fn mode(study: &Study, choice: &ModesFollowed, j: usize, oscillations: &Oscillations<'_>) -> String {
    let model = &study.model;
    let omega = model.modes().frequencies[j];
    let followed = if choice.followed.contains(&j) { "  followed" } else { "" };
    if model.modes().is_rigid(j) {
        return format!("{:>2}  rigid body{followed}", j + 1);
    }
    let (hertz, damping) = (number(omega / TAU), oscillations.told(j));
    format!("{:>2}  {:>10} rad/s  {hertz:>10} Hz  {damping}{followed}", j + 1, number(omega))
}

fn forcing(study: &Study) -> String {
    let forcing = study.model.forcing();
    let norm = forcing.shape.iter().map(|s| s * s).sum::<f64>().sqrt();
    let assumed = defaults::forcing(study).map(|shape| format!("; {shape}")).unwrap_or_default();
    format!("shape of norm {} N per unit of A, on harmonic {}{assumed}", number(norm), forcing.harmonic)
}

fn contact(study: &Study) -> Option<String> {
    let contacts: Vec<RigidContact<'_>> = study.model.contacts().map(|contact| contact.law).collect();
    if contacts.is_empty() {
        return None;
    }
    // Clearances are millimetres to people.
    let unit = study.units.length.unwrap_or(LengthUnit::Millimetre);
    let gap = span(contacts.iter().map(|contact| unit.factor() * contact.gap));
    let epsilon = span(contacts.iter().map(|contact| contact.epsilon));
    let rubbing = contacts.iter().filter_map(|contact| contact.friction);
    let friction = match span(rubbing.clone().map(|friction| friction.coefficient)) {
        text if text.is_empty() => "no friction".into(),
        text => format!("friction {text}, sense {}", span(rubbing.clone().map(|friction| friction.sense))),
    };
    let some = match rubbing.count() {
        count if 0 < count && count < contacts.len() => format!(" (on {count} of {})", contacts.len()),
        _ => String::new(),
    };
    Some(format!("gap {gap} {unit}, {friction}{some}, epsilon {epsilon} N/m"))
}

fn amplitudes(amplitudes: &[Amplitude]) -> String {
    match amplitudes {
        [] => "none".into(),
        [only] => format!("1: {}", only.text),
        [first, .., last] => format!("{}: {} … {}", amplitudes.len(), first.text, last.text),
    }
}

fn harmonics(study: &Study) -> String {
    let harmonics = study.settings.harmonics;
    let over = match harmonics.quadrature {
        _ if study.model.contacts().next().is_none() => "",
        Quadrature::Arcs => ", contact over its exact arcs",
        Quadrature::Samples => ", contact by its samples",
    };
    format!("{}, {} samples a period{over}", harmonics.count, harmonics.samples)
}

/// Unknowns of a forced response when every element acts.
fn unknowns(study: &Study) -> String {
    let channels = study.model.arguments();
    let coefficients = width(study.settings.harmonics.count);
    format!(
        "at most {} ({} × {coefficients} coefficients), plus the frequency and resonant modal amplitudes",
        channels * coefficients,
        count(channels, "channel")
    )
}

fn frequency(study: &Study) -> String {
    let range = study.settings.frequency;
    let bound = |omega: f64| format!("{} rad/s ({} Hz)", number(omega), number(omega / TAU));
    match (range.min, range.max) {
        (None, None) => {
            "10 % beyond the resonances, which the sweep computes; branches are followed on from there".into()
        }
        (Some(min), None) => format!("{} to 10 % above the backbones", bound(min)),
        (None, Some(max)) => format!("10 % below the backbones to {}", bound(max)),
        (Some(min), Some(max)) => format!("{} to {}", bound(min), bound(max)),
    }
}

fn shortened(names: &[&str]) -> String {
    /// Names shown.
    const SHOWN: usize = 5;
    let more = if names.len() > SHOWN { ", …" } else { "" };
    format!("{}{more}", names[..names.len().min(SHOWN)].join(", "))
}

/// Smallest and largest value, or the only one; empty without values.
fn span(values: impl Iterator<Item = f64>) -> String {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    match (number(low), number(high)) {
        _ if low > high => String::new(),
        (low, high) if low == high => low,
        (low, high) => format!("{low} to {high}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_are_one() {
        assert_eq!(span([0.5, 0.25].into_iter()), "0.25 to 0.5");
        assert_eq!(span([0.5, 0.5].into_iter()), "0.5");
    }
}
