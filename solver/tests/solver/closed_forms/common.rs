//! Models and settings that the closed forms share.

use solver::files;
use solver::formulation::state::State;
use solver::response::backbone::Backbone;
use solver::response::branch::{Branch, BranchPoint};
use solver::response::forced::Forced;
use solver::settings::{BackboneEquation, HarmonicSettings, Settings};
use solver::structure::Model;
use solver::structure::laws::{Contact, LawKind};
use std::ops::ControlFlow;
use std::path::Path;

pub fn load(name: &str) -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name);
    files::load(&folder).unwrap_or_else(|error| panic!("{error}"))
}

pub fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub fn contact(gap: f64, epsilon: f64) -> LawKind {
    LawKind::Contact(Contact { gap, epsilon, friction: None })
}

/// One mass of 1 kg with modal damping, forced by 1 N per unit of amplitude.
pub fn oscillator(stiffness: f64, ratio: f64, law: LawKind) -> Model {
    Model::builder("oscillator")
        .mass([[1.0]])
        .stiffness([[stiffness]])
        .damping_ratio(ratio)
        .force("x1", 1.0)
        .element("element", law, ["x1"])
        .build()
        .unwrap()
}

pub fn with_harmonics(count: usize) -> Settings {
    Settings { harmonics: HarmonicSettings { count, ..Default::default() }, ..Settings::default() }
}

pub fn conservative(count: usize) -> Settings {
    let mut settings = with_harmonics(count);
    settings.backbone.equation = BackboneEquation::ConservativeMode;
    settings
}

pub fn backbone(model: &Model, settings: &Settings) -> Backbone {
    Backbone::compute(model, settings).unwrap()
}

/// Displacement of a dof.
pub fn displacement(model: &Model, state: &State, dof: usize) -> Vec<f64> {
    state.displacement(model, dof)
}

/// Converged states of a branch at one frequency, in the order of the arc.
pub fn states_at(forced: &mut Forced<'_>, branch: &Branch, omega: f64) -> Vec<State> {
    let crossing = |pair: &&[BranchPoint]| (pair[0].omega() - omega) * (pair[1].omega() - omega) < 0.0;
    let pairs: Vec<_> = branch.points.windows(2).filter(crossing).collect();
    let between = pairs.into_iter().map(|pair| {
        let share = (omega - pair[0].omega()) / (pair[1].omega() - pair[0].omega());
        State { omega, ..pair[0].state.interpolate(&pair[1].state, share) }
    });
    between.map(|state| forced.converge(&state).unwrap()).collect()
}

/// Root of a function with a sign change between `low` and `high`.
pub fn bisect(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let sign = function(low) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (function(middle) > 0.0) == sign { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
