//! Fold curves that end, or begin, where motions branch off others.

use crate::support::fold_curves::{Study, all, assert_close, folds, quiet};
use crate::support::starts::branches_from_starts;
use crate::support::study::with_harmonics;
use solver::laws::PenaltySpring;
use solver::response::branch::BranchKind;
use solver::response::folds::{CriticalKind, Extent};
use solver::{Forced, Model};

/// Batches of random starts.
const BATCHES: usize = 16;

/// A bracket before an elastic stop on a pump; motions of two periods of the force.
fn pump() -> Model {
    Model::builder("pump and bracket")
        .mass([[80.0, 0.0], [0.0, 6.0]])
        .stiffness([[3.4e6, -2e5], [-2e5, 2e5]])
        .damping_ratio(0.01)
        .force("x1", 1.0)
        .harmonic(2)
        .monitor("x2")
        .element("stop", PenaltySpring { stiffness: 1e6, gap: 5e-4 }, [[("x2", 1.0), ("x1", -1.0)]])
        .build()
        .unwrap()
}

/// The curve of both folds of the isola at A = 300 comes to branch points at both ends. Levels at 270 and 352 have the isola, or what it
/// merges with, 370 has none.
#[test]
fn extrema_along_a_curve_from_branch_point_to_branch_point_are_located() {
    let mut settings = with_harmonics(15);
    (settings.frequency.min, settings.frequency.max) = (Some(70.0), Some(100.0));
    let study = Study::new(pump(), settings);
    let mut forced = Forced::new(&study.model, &settings, study.reach, 300.0);
    let found = branches_from_starts(&mut forced, study.main(300.0), BATCHES);
    let isola = found.iter().map(|(_, branch)| branch).find(|branch| branch.kind == BranchKind::Isola).unwrap();
    let extent = Extent { forcing: (50.0, 600.0), frequency: (60.0, 220.0), points: 2000 };
    let mut critical = study.folds(extent);
    let curve = critical.curve(&folds(isola)[0], &mut quiet).unwrap();
    // Wherever on it the walk begins.
    let quarters = [1, 2, 3].map(|k| k * curve.points.len() / 4);
    for at in quarters {
        let curve = critical.curve(&curve.points[at].state, &mut quiet).unwrap();
        let [death] = all(&curve, CriticalKind::Death)[..] else { panic!("{:?}, {}", curve.events, curve.outcome) };
        assert_close(death, 356.504, 1e-5);
        let merges = all(&curve, CriticalKind::Merge);
        assert!(merges.iter().any(|merge| (merge / 291.3195 - 1.0).abs() < 1e-5), "{merges:?}");
    }
}
