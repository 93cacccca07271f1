//! Bounds of the frequency that are probably not meant, and what lies between them.

use super::small_motion;
use super::units::frequency;
use crate::study::Study;
use results::overview::is_within;
use results::words::{digits, number, times};
use solver::response::forced::SearchRange;
use solver::response::modes::ModesFollowed;
use std::f64::consts::TAU;

/// Bounds nearer to a resonance than so many of its half-widths ζω cut it: there it has a fifth of its height.
const FLANK: f64 = 5.0;
/// Resonances whose flanks reach farther than this share of their frequency are too wide to be told from what is beside them.
const SHARP: f64 = 0.25;
/// Orders of superharmonic resonances that a study may be of.
const ORDERS: usize = 3;

/// Sentences about bounds that are probably not meant.
pub(super) fn warnings(study: &Study) -> Vec<String> {
    hertz(study).into_iter().chain(flanks(study)).chain(below_backbones(study)).collect()
}

/// What a sweep notes of bounds that may well be meant: nothing resonates between them, of no order that is looked at.
pub(super) fn note(study: &Study) -> Option<String> {
    let is_told = resonates(study, 1..=ORDERS) || !warnings(study).is_empty();
    if is_told { None } else { quiet(study) }
}

/// That the linear structure resonates nowhere between the bounds, and where it does next to them.
pub(super) fn quiet(study: &Study) -> Option<String> {
    let (given, m) = (study.settings.frequency, study.model.forcing().harmonic);
    let all = study.model.driven().into_iter().map(|mode| (mode, study.model.resonance(mode).0 / m as f64));
    if all.clone().any(|(_, omega)| is_within(given, omega)) {
        return None;
    }
    let below = all.clone().rfind(|(_, omega)| given.min.is_some_and(|min| *omega < min));
    let above = all.clone().find(|(_, omega)| given.max.is_some_and(|max| *omega > max));
    let place = |(mode, omega): (usize, f64)| format!("that of mode {} at {}", mode + 1, frequency(study, omega));
    let nearest: Vec<String> = [below, above].into_iter().flatten().map(place).collect();
    let are = if nearest.len() == 1 { "one is" } else { "ones are" };
    let whose =
        if m == 1 { String::new() } else { format!(" of the response, the force having {} that frequency", times(m)) };
    (!nearest.is_empty()).then(|| {
        format!(
            "no linear resonance that the force drives lies within the bounds: the nearest {are} {}{whose}",
            nearest.join(" and ")
        )
    })
}

/// Where modes that vibrate resonate, rad/s.
fn resonances(study: &Study) -> Vec<f64> {
    let model = &study.model;
    (0..model.size()).filter(|&mode| !model.modes().is_rigid(mode)).map(|mode| model.resonance(mode).0).collect()
}

/// Whether the response has a frequency within the bounds at which one of these harmonics, or that of the force, meets a mode.
fn resonates(study: &Study, harmonics: std::ops::RangeInclusive<usize>) -> bool {
    let (mut harmonics, places) = (harmonics.chain([study.model.forcing().harmonic]), resonances(study));
    harmonics.any(|k| places.iter().any(|omega| is_within(study.settings.frequency, omega / k as f64)))
}

/// Of bounds between which no mode resonates with the force, but would if they were Hz.
fn hertz(study: &Study) -> Option<String> {
    let (given, m) = (study.settings.frequency, study.model.forcing().harmonic);
    let (low, high) = (given.min?, given.max?);
    let places = resonances(study);
    if places.iter().any(|omega| is_within(given, omega / m as f64)) {
        return None;
    }
    // Where superharmonics resonate it may be these that are looked for.
    let has_others = resonates(study, 1..=ORDERS);
    let (orders, with) = if has_others { (0, " with the force itself") } else { (ORDERS, "") };
    let harmonics = [m].into_iter().chain(1..=orders);
    let mut all = harmonics.flat_map(|k| places.iter().map(move |omega| omega / k as f64));
    let meant = all.find(|omega| (TAU * low..=TAU * high).contains(omega))?;
    Some(format!(
        "no mode resonates{with} between frequency.min = {} and frequency.max = {} rad/s, but one does at {} Hz: if Hz are meant, they are {} \
         and {} rad/s",
        number(low),
        number(high),
        number(meant / TAU),
        number(TAU * low),
        number(TAU * high)
    ))
}

/// Of an upper bound below all resonances, without a lower one: the sweep refuses it unless a backbone bends down there.
fn below_backbones(study: &Study) -> Option<String> {
    let (model, given) = (&study.model, study.settings.frequency);
    let max = given.max.filter(|_| given.min.is_none())?;
    let followed = ModesFollowed::choose(model, &study.settings).followed;
    let frequencies = followed.into_iter().map(|mode| (mode, model.resonance(mode).0));
    let (mode, omega) = frequencies.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (max <= (1.0 - SearchRange::MARGIN) * omega).then(|| {
        format!(
            "frequency.max = {} lies below the backbones, which begin at {} (mode {}), and a sweep refuses it unless one of them bends down \
             to there: give a higher one, or frequency.min as well",
            frequency(study, max),
            frequency(study, omega),
            mode + 1
        )
    })
}

/// Of bounds that lie on the flank of a resonance that the force drives, so that what responds there is known in part.
fn flanks(study: &Study) -> Vec<String> {
    let (model, given) = (&study.model, study.settings.frequency);
    let m = model.forcing().harmonic as f64;
    // In frequencies of the response, of which the force has m times as much.
    let resonance = |j: usize| {
        let (omega, decay) = model.resonance(j);
        (j, omega / m, decay / m)
    };
    let is_sharp = |(_, omega, half): &(usize, f64, f64)| FLANK * half < SHARP * omega;
    let resonances: Vec<_> =
        model.driven().into_iter().map(resonance).filter(|(.., half)| *half > 0.0).filter(is_sharp).collect();
    let told = |omega: f64| frequency(study, omega);
    // Joints that stick, say, make others of small motions.
    let alone = if small_motion::frequencies(study).is_some() { " (of the matrices alone)" } else { "" };
    let cut = |key: &str, bound: f64, outwards: f64| {
        let distance = |(_, omega, half): &(usize, f64, f64)| (bound - omega).abs() / half;
        let nearest = resonances.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let (j, omega, half) = *nearest;
        (distance(nearest) < FLANK).then(|| {
            format!(
                "{key} = {} cuts through the resonance of mode {}{alone} at {}, {} of its half-widths from it: branches end on its \
                 flank, and their peaks may lie beyond; the bound at {} takes it in, at {} leaves it out",
                told(bound),
                j + 1,
                told(omega),
                digits(distance(nearest), 2),
                told(omega + outwards * FLANK * half),
                told(omega - outwards * FLANK * half)
            )
        })
    };
    let bounds = [("frequency.min", given.min, -1.0), ("frequency.max", given.max, 1.0)];
    bounds.into_iter().filter_map(|(key, bound, outwards)| cut(key, bound?, outwards)).collect()
}
