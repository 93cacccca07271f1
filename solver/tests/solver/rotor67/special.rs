//! Special points are located along the arc: they do not depend on the steps of the walk.
//!
//! That takes the exact contact arcs. Sampled 512 times a period, the frictionless isola has several tips within
//! 0.01 rad/s of each other, because the contact changes one sample at a time.

use super::common::{BACKWARD, FRICTIONLESS, Scenario, TUNED, found_from_window, quiet};
use solver::response::branch::{Branch, SpecialKind};
use solver::response::forced::{Forced, SearchRange};
use solver::settings::{Quadrature, Settings};

/// An isola, by the window it is found from.
struct Isola {
    scenario: &'static Scenario,
    amplitude: u32,
    /// A frequency of the window, rad/s.
    omega: f64,
}

const ISOLAS: [Isola; 4] = [
    Isola { scenario: &FRICTIONLESS, amplitude: 60, omega: 2623.0 },
    Isola { scenario: &FRICTIONLESS, amplitude: 60, omega: 2830.0 },
    Isola { scenario: &BACKWARD, amplitude: 20, omega: 2474.0 },
    Isola { scenario: &TUNED, amplitude: 60, omega: 2140.0 },
];

impl Isola {
    /// Traces it with other settings, from a point of it after the share `start` of its points.
    fn traced(&self, settings: &Settings, start: f64) -> Branch {
        let level = self.scenario.level(self.amplitude);
        let id = found_from_window(level, self.omega);
        assert!(!id.is_main(), "{}: no isola round {} rad/s", self.scenario.name, self.omega);
        let points = &level.branch(id).unwrap().points;
        let state = &points[(start * points.len() as f64) as usize].state;
        let (model, backbone) = (self.scenario.model(), self.scenario.backbone());
        let mut forced =
            Forced::new(model, settings, SearchRange::new(settings, backbone).unwrap(), self.amplitude.into());
        let branch = forced.branch_through(state, &mut quiet).unwrap();
        assert!(branch.is_closed(), "{}: {:?} from {start}", self.scenario.name, branch.outcome);
        branch
    }
}

fn steps(max_step: f64, initial_step: f64) -> Settings {
    let mut settings = Settings::default();
    (settings.continuation.max_step, settings.continuation.initial_step) = (max_step, initial_step);
    settings
}

/// Ends of the range in rad/s, and peak in m.
fn figures(branch: &Branch) -> [f64; 3] {
    let (low, high) = branch.frequency_range();
    [low, high, branch.peak().amplitude()]
}

/// Largest relative difference of the figures of two branches.
fn difference(a: &Branch, b: &Branch) -> f64 {
    figures(a).iter().zip(figures(b)).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn steps_do_not_matter() {
    for isola in &ISOLAS {
        let reference = isola.traced(&steps(0.1, 0.02), 0.0);
        for (max_step, initial_step, start) in
            [(0.05, 0.02, 0.0), (0.1, 0.05, 0.0), (0.05, 0.005, 0.3), (0.1, 0.01, 0.7)]
        {
            let branch = isola.traced(&steps(max_step, initial_step), start);
            let what =
                format!("{} with steps up to {max_step}, first {initial_step}, from {start}", isola.scenario.name);
            let differs = difference(&branch, &reference);
            assert!(differs < 1e-6, "{what}: {:?} and {:?}, {differs:e}", figures(&branch), figures(&reference));
            assert_eq!(branch.special(SpecialKind::Fold).count(), 2, "{what}: this isola has two folds");
        }
    }
}

#[test]
fn contact_arcs_are_the_limit_of_fine_sampling() {
    let isola = &ISOLAS[0];
    let arcs = isola.traced(&steps(0.1, 0.02), 0.0);
    let distances = [512, 4096].map(|samples| {
        let mut settings = steps(0.1, 0.02);
        (settings.harmonics.quadrature, settings.harmonics.samples) = (Quadrature::Samples, samples);
        difference(&isola.traced(&settings, 0.0), &arcs)
    });
    // Seen: sampling 512 times moves the tip by 8e-5, 4096 times by 1e-6.
    assert!(distances[0] < 2e-4 && distances[1] < 5e-6, "{distances:?}");
}
