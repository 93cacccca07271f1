//! Models, backbones and levels of rotor 67, each computed once for all tests.

use solver::files;
use solver::response::backbone::Backbone;
use solver::response::branch::{Branch, BranchPoint};
use solver::response::level::{BranchId, Level};
use solver::settings::Settings;
use solver::structure::Model;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::OnceLock;

/// Forcing amplitudes of the paper.
pub const AMPLITUDES: [u32; 7] = [20, 40, 60, 80, 100, 120, 140];

/// The gap, m: below it nothing touches.
pub const GAP: f64 = 4e-4;

/// A scenario with what has been computed of it.
pub struct Scenario {
    pub name: &'static str,
    overrides: &'static [(&'static str, &'static str)],
    model: OnceLock<Model>,
    backbone: OnceLock<Backbone>,
    levels: [OnceLock<Level>; AMPLITUDES.len()],
}

impl Scenario {
    const fn new(name: &'static str, overrides: &'static [(&'static str, &'static str)]) -> Self {
        Self {
            name,
            overrides,
            model: OnceLock::new(),
            backbone: OnceLock::new(),
            levels: [const { OnceLock::new() }; AMPLITUDES.len()],
        }
    }

    pub fn model(&self) -> &Model {
        self.model.get_or_init(|| {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/rotor67");
            files::load_with(&folder, self.overrides).unwrap_or_else(|error| panic!("{error}"))
        })
    }

    /// The backbone with the paper's settings.
    pub fn backbone(&self) -> &Backbone {
        self.backbone.get_or_init(|| {
            Backbone::compute(self.model(), &Settings::default())
                .unwrap_or_else(|error| panic!("{}: {error}", self.name))
        })
    }

    /// The level A = `amplitude`, one of [`AMPLITUDES`].
    pub fn level(&self, amplitude: u32) -> &Level {
        let index = AMPLITUDES.iter().position(|&a| a == amplitude).expect("one of the paper's amplitudes");
        self.levels[index].get_or_init(|| self.compute_level(amplitude))
    }

    /// Computes a level afresh.
    pub fn compute_level(&self, amplitude: u32) -> Level {
        Level::compute(self.model(), &Settings::default(), self.backbone(), amplitude.into())
            .unwrap_or_else(|error| panic!("{} at A = {amplitude}: {error}", self.name))
    }
}

pub static FRICTIONLESS: Scenario = Scenario::new("frictionless", &[("contact.friction", "0")]);
pub static BACKWARD: Scenario = Scenario::new("friction, sense -1", &[]);
pub static FORWARD: Scenario = Scenario::new("friction, sense +1", &[("contact.sense", "1")]);
pub static TUNED: Scenario = Scenario::new("tuned, sense -1", &[("matrices.stiffness", "rom_K_tuned.mtx")]);

/// An observer that lets everything go on.
pub fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Whether any node touches during the period.
pub fn touches(point: &BranchPoint) -> bool {
    point.contact().iter().any(|&share| share > 0.0)
}

/// Highest frequency of the branch in contact, rad/s: a main branch goes on to its bound without.
pub fn highest_contact(branch: &Branch) -> f64 {
    branch.points.iter().filter(|p| touches(p)).map(|p| p.omega()).fold(f64::NEG_INFINITY, f64::max)
}

/// The only branch at the frequency `omega` that the windows round it led to.
#[track_caller]
pub fn found_from_window(level: &Level, omega: f64) -> BranchId {
    let round = level.windows.iter().filter(|w| w.window.omega.0 < omega && omega < w.window.omega.1);
    let is_there = |id: &BranchId| {
        let (low, high) = level.branch(*id).unwrap().frequency_range();
        (low..=high).contains(&omega)
    };
    let found: Vec<_> = round.flat_map(|w| w.branches()).filter(is_there).collect();
    assert!(found.windows(2).all(|pair| pair[0] == pair[1]), "round {omega} rad/s: {found:?}");
    *found.first().unwrap_or_else(|| panic!("nothing found round {omega} rad/s: {:?}", level.windows))
}

/// |value/expected − 1| < relative.
#[track_caller]
pub fn assert_close(value: f64, expected: f64, relative: f64, what: &str) {
    assert!((value / expected - 1.0).abs() < relative, "{what}: {value} is not {expected} to {relative}");
}
