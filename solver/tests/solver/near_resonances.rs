//! Motions of three periods of the forcing where they come next to the main branch without meeting it.

use crate::support::ring::quiet;
use crate::support::starts::branches_from_starts;
use solver::laws::PenaltySpring;
use solver::response::branch::{BranchKind, Side};
use solver::{Backbone, Branch, Forced, Matrix, Model, SearchRange, Settings, State};

/// Batches of random starts, which lead to three isolas.
const BATCHES: usize = 6;

/// Two masses, of which the one that the force acts on hits an elastic stop.
fn model() -> Model {
    let stiffness = [[28687.0, -5000.0], [-5000.0, 5000.0]];
    let model = Model::builder("two masses")
        .mass(Matrix::diagonal(&[1.5, 0.2]))
        .stiffness(Matrix::from_fn(2, 2, |i, j| stiffness[i][j]))
        .damping_ratio(0.003);
    let stop = PenaltySpring { stiffness: 3e5, gap: 1e-3 };
    model.force(0, 1.0).harmonic(3).monitor(0).element("stop", stop, [vec![(0, 1.0)]]).build().unwrap()
}

/// Difference of a motion of the first mass from the one a period of the forcing later, relative to the motion.
fn from_image(model: &Model, state: &State) -> f64 {
    const SAMPLES: usize = 3 * 64;
    let motion: Vec<f64> = state.over_period(model, 0, SAMPLES).iter().map(|at| at[0]).collect();
    let later = |i: usize| motion[(i + SAMPLES / 3) % SAMPLES];
    let difference: f64 = motion.iter().enumerate().map(|(i, x)| (x - later(i)).powi(2)).sum();
    (difference / motion.iter().map(|x| x * x).sum::<f64>()).sqrt()
}

/// Where a multiplier of the main branch is near a third root of one, an isola comes as near to it as damping lets it, and turns there by
/// 60°: what is 60° from it on the other side is an image of it. By steps of 1e-4 all along, the nearest motion to its image is at
/// 59.2913 rad/s, and the frequency least at 59.290868 rad/s.
#[test]
fn an_isola_that_nearly_touches_the_main_branch_is_closed() {
    let model = model();
    let mut settings = Settings::default();
    (settings.frequency.min, settings.frequency.max) = (Some(58.0), Some(66.0));
    let range = SearchRange::new(&settings, &Backbone::compute(&model, &settings).unwrap()).unwrap();
    let mut forced = Forced::new(&model, &settings, range, 0.825);
    let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
    let found = branches_from_starts(&mut forced, main, BATCHES);
    let isolas: Vec<&Branch> = found[1..].iter().map(|(_, branch)| branch).collect();
    let told: Vec<_> = isolas.iter().map(|isola| (isola.kind, isola.outcome, isola.frequency_range())).collect();
    assert!(isolas.len() == 3 && isolas.iter().all(|isola| isola.kind == BranchKind::Isola), "{told:?}");
    let nearest = isolas.iter().find(|isola| isola.frequency_range().0 < 59.3).unwrap();
    let distances = nearest.points.iter().map(|point| from_image(&model, &point.state));
    let least = distances.fold(f64::INFINITY, f64::min);
    assert!((1e-4..5e-3).contains(&least), "{least}");
    assert!((nearest.frequency_range().0 / 59.290868 - 1.0).abs() < 1e-5, "{told:?}");
    // It goes round once.
    let (low, high) = nearest.frequency_range();
    let is_low: Vec<bool> = nearest.points.iter().map(|point| point.omega() < 0.5 * (low + high)).collect();
    let changes = (0..is_low.len()).filter(|&i| is_low[i] != is_low[(i + 1) % is_low.len()]);
    assert_eq!(changes.count(), 2, "{told:?}");
}
