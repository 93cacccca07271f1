//! What is found does not depend on how long the steps are, nor on how far beyond it the frequency bounds lie.

use crate::support::study::{Kind, Listed, Study, shipped, why_unfinished, with_harmonics};
use solver::response::branch::SpecialKind;
use solver::response::forced::SearchRange;
use solver::{BranchPoint, Model, Settings};

/// Folds and peaks are located to this, relative.
const LOCATED: f64 = 1e-6;

/// What is compared of a branch.
#[derive(Debug)]
struct Summary {
    kind: Kind,
    range: (f64, f64),
    /// Frequencies of the folds, ascending.
    folds: Vec<f64>,
    /// Frequency and amplitude of the largest point; `None` if that lies at a bound.
    peak: Option<(f64, f64)>,
    /// Whether it goes on where it ends.
    is_unfinished: bool,
}

/// Lowest and highest frequency of all branches.
fn span(level: &[Listed]) -> (f64, f64) {
    let ranges = level.iter().map(|listed| listed.branch.frequency_range());
    ranges.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), (a, b)| (low.min(a), high.max(b)))
}

/// The branches of a level as far as they lie within a frequency range, in the order of kind and range.
fn summaries(level: &[Listed], (low, high): (f64, f64)) -> Vec<Summary> {
    let inside = |omega: f64| omega > low * (1.0 + 10.0 * LOCATED) && omega < high * (1.0 - 10.0 * LOCATED);
    let summary = |listed: &Listed| {
        let (from, to) = listed.branch.frequency_range();
        let peak = listed.branch.peak();
        let mut folds: Vec<f64> =
            listed.branch.special(SpecialKind::Fold).map(BranchPoint::omega).filter(|&omega| inside(omega)).collect();
        folds.sort_by(f64::total_cmp);
        let peak = inside(peak.omega()).then(|| (peak.omega(), peak.amplitude()));
        let is_unfinished = why_unfinished(&listed.branch).is_some();
        Summary { kind: listed.kind, range: (from.max(low), to.min(high)), folds, peak, is_unfinished }
    };
    let mut list: Vec<Summary> = level.iter().map(summary).filter(|s| s.range.0 < s.range.1).collect();
    list.sort_by(|a, b| a.kind.cmp(&b.kind).then(a.range.0.total_cmp(&b.range.0)));
    list
}

fn is_same(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < LOCATED
}

/// What differs between two levels; nothing, if nothing does.
fn difference(first: &[Listed], second: &[Listed]) -> Option<String> {
    let (a, b) = (span(first), span(second));
    let common = (a.0.max(b.0), a.1.min(b.1));
    let (mine, others) = (summaries(first, common), summaries(second, common));
    let kinds = |list: &[Summary]| list.iter().map(|s| s.kind).collect::<Vec<_>>();
    let agree = |a: &Summary, b: &Summary| {
        let folds = a.folds.len() == b.folds.len() && a.folds.iter().zip(&b.folds).all(|(&a, &b)| is_same(a, b));
        let peak = match (a.peak, b.peak) {
            // At a peak the frequency is known to the root of what the amplitude is.
            (Some(a), Some(b)) => is_same(a.1, b.1) && (a.0 / b.0 - 1.0).abs() < LOCATED.sqrt(),
            (None, None) => true,
            _ => false,
        };
        is_same(a.range.0, b.range.0) && is_same(a.range.1, b.range.1) && folds && peak
    };
    // None of these models has a response that cannot be followed.
    let is_whole = mine.iter().chain(&others).all(|summary| !summary.is_unfinished);
    let is_equal = is_whole && kinds(&mine) == kinds(&others) && mine.iter().zip(&others).all(|(a, b)| agree(a, b));
    (!is_equal).then(|| format!("{mine:#?} became {others:#?}"))
}

/// Compares the levels of a shipped model with those that other steps and wider bounds give.
fn check(name: &str, settings: Settings, forcings: &[f64]) {
    compare(name, settings, forcings, Study::new);
}

/// The same with the backbones of all modes that are reached.
fn check_all_modes(name: &str, settings: Settings, forcings: &[f64]) {
    compare(name, settings, forcings, Study::of_modes);
}

fn compare(name: &str, settings: Settings, forcings: &[f64], study: fn(Model, Settings) -> Study) {
    let study = |settings: Settings| study(shipped(name, &[]), settings);
    let base = study(settings);
    let mut others = Vec::new();
    for factor in [0.5, 2.0] {
        let mut initial = settings;
        initial.continuation.initial_step *= factor;
        others.push((format!("initial step times {factor}"), study(initial)));
        let mut largest = settings;
        largest.continuation.max_step *= factor;
        others.push((format!("largest step times {factor}"), study(largest)));
    }
    let reach = SearchRange::new(&settings, &base.backbones[0]).unwrap();
    let mut wider = settings;
    (wider.frequency.min, wider.frequency.max) = (Some(0.95 * reach.frequency.0), Some(1.05 * reach.frequency.1));
    others.push(("bounds 5 % wider".into(), study(wider)));
    let mut differences = Vec::new();
    for &forcing in forcings {
        let expected = base.level(forcing);
        println!("{name}, A = {forcing}: {expected:#?}");
        for (what, other) in &others {
            if let Some(difference) = difference(&expected, &other.level(forcing)) {
                differences.push(format!("A = {forcing}, {what}: {difference}"));
            }
        }
    }
    assert!(differences.is_empty(), "{name}:\n{}", differences.join("\n"));
}

#[test]
fn duffing() {
    check("duffing", with_harmonics(5), &[0.01, 0.05, 0.1]);
}

#[test]
fn nonlinear_damper() {
    check("nonlinear_damper", with_harmonics(5), &[0.004, 0.006, 0.011, 0.012]);
}

#[test]
fn nltva() {
    check("nltva", with_harmonics(5), &[0.12, 0.19]);
}

#[test]
fn impact_subharmonic() {
    check("impact_subharmonic", with_harmonics(10), &[0.5, 1.0]);
}

#[test]
fn two_masses_stop() {
    let mut settings = with_harmonics(10);
    settings.backbone.modes = solver::ModeChoice::one(2);
    check("two_masses_stop", settings, &[0.002, 0.005, 0.02]);
}

#[test]
fn cantilever_stop() {
    check("cantilever_stop", with_harmonics(10), &[0.1, 0.2]);
}

#[test]
fn friction_mass() {
    // The instants at which the slider sticks fall between samples: with 512 the peak is known to 2e-6 only.
    let mut settings = with_harmonics(3);
    settings.harmonics.samples = 4096;
    check("friction_mass", settings, &[0.2]);
}

#[test]
fn two_dampers() {
    check_all_modes("two_dampers", with_harmonics(5), &[0.05, 0.1]);
}

#[test]
fn damper_two_isolas() {
    check("damper_two_isolas", with_harmonics(7), &[0.0145, 0.018]);
}

#[test]
fn two_blades() {
    check_all_modes("two_blades", with_harmonics(5), &[0.015, 0.034]);
}

#[test]
fn chain_subharmonic() {
    let mut settings = with_harmonics(20);
    (settings.frequency.min, settings.frequency.max) = (Some(1.1), Some(1.8));
    check_all_modes("chain_subharmonic", settings, &[1.75, 2.25]);
}

#[test]
fn duffing_subharmonic() {
    let mut settings = with_harmonics(21);
    (settings.frequency.min, settings.frequency.max) = (Some(0.2), Some(2.5));
    check("duffing_subharmonic", settings, &[1.5]);
}

#[test]
fn stop_subharmonic() {
    let mut settings = with_harmonics(20);
    (settings.frequency.min, settings.frequency.max) = (Some(0.8), Some(1.8));
    check("stop_subharmonic", settings, &[0.7, 1.0]);
}
