//! Windows of the energy balance that no seed lands in, and known branches that pass by.

use crate::support::study::with_harmonics;
use solver::formulation::modal::Modal;
use solver::formulation::state::State;
use solver::laws::{PolynomialSpring, Term};
use solver::response::branch::BranchPoint;
use solver::response::level::WindowAccount;
use solver::response::modes::Backbones;
use solver::response::seeds::{LandingMethod, Phase, Seed};
use solver::response::task::{SeedOutcome, SeedPlace, Task};
use solver::{Branch, Level, Matrix, Model};
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// Up to which relative distance a response is what was predicted.
const NEAR: f64 = 0.3;

/// Four masses of 1 kg in a chain, on stiffening springs, pushed at one end.
fn chain() -> Model {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 0.5 }] };
    let coupling = 0.05;
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 if i == 0 || i == 3 => 1.0 + coupling,
        0 => 1.0 + 2.0 * coupling,
        1 => -coupling,
        _ => 0.0,
    };
    let model = Model::builder("chain").mass(Matrix::diagonal(&[1.0; 4])).stiffness(Matrix::from_fn(4, 4, entry));
    let model = model.damping_ratio(0.005).force_shape(vec![1.0, 0.0, 0.0, 0.0]).monitor(0);
    (0..4).fold(model, |model, i| model.element(format!("s{i}"), spring.clone(), [vec![(i, 1.0)]])).build().unwrap()
}

/// Relative distance of the displacements of two motions, shifted so that the mode moves alike in both. All masses are one: that is the
/// distance in the coordinates of any modes.
fn distance(model: &Model, state: &State, seed: &State, mode: usize) -> f64 {
    let shifted = |state: &State| {
        let series = state.mode(mode);
        let motion = state.shifted(-f64::atan2(-series[2], series[1]));
        motion.displacements(model).concat()
    };
    let (a, b) = (shifted(state), shifted(seed));
    let square = |list: &mut dyn Iterator<Item = f64>| list.map(|x| x * x).sum::<f64>();
    (square(&mut a.iter().zip(&b).map(|(a, b)| a - b)) / square(&mut b.iter().copied())).sqrt()
}

/// The seeds of a window.
fn seeds(account: &WindowAccount, backbones: &[solver::Backbone], model: &Model, forcing: f64) -> Vec<Seed> {
    let backbone = backbones.iter().find(|backbone| backbone.mode == account.window.mode).unwrap();
    let wells = account.window.wells(backbone);
    let place = |well, phase| {
        let place = SeedPlace { window: 0, well, phase, method: LandingMethod::FullForcing };
        Task::Land(place).seeds(&Modal::new(model), backbones, forcing)
    };
    wells.into_iter().flat_map(|well| [Phase::First, Phase::Second].map(|phase| place(well, phase)).concat()).collect()
}

/// Nothing lands in five of the windows; the main branch passes three of them within the limit, and by two of them no branch does.
#[test]
fn windows_that_a_known_branch_passes_by_are_found_on_it() {
    let (model, settings, forcing) = (chain(), with_harmonics(5), 0.02);
    let mut quiet = |_: &BranchPoint| ControlFlow::Continue(());
    let backbones = Backbones::reaching(&model, &settings, forcing, &mut quiet, &AtomicBool::new(false)).unwrap().list;
    let level = Level::compute(&model, &settings, &backbones, forcing).unwrap();
    let nearest = |account: &WindowAccount, branch: &Branch| {
        let seeds = seeds(account, &backbones, &model, forcing);
        let about = account.window.about();
        let inside = branch.points.iter().filter(|point| about.contains(&point.omega()));
        let all = inside.flat_map(|point| seeds.iter().map(move |seed| (point, seed)));
        let distances = all.map(|(point, seed)| distance(&model, &point.state, &seed.state, account.window.mode));
        distances.fold(f64::INFINITY, f64::min)
    };
    let (mut not_found, mut passed) = (0, 0);
    // What begins at rest is of the resonance that the main branch passes, however far from there.
    for account in &level.windows {
        // That a branch passes by is said where no seed landed, and how far away.
        let outcomes = || account.seeds.iter().map(|seed| seed.outcome);
        let landed = outcomes().any(|outcome| matches!(outcome, SeedOutcome::Found(_)));
        let within = outcomes().filter_map(|outcome| match outcome {
            SeedOutcome::Passing(id, distance) => Some((id, distance)),
            _ => None,
        });
        if let Some((id, distance)) = within.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|_| !landed) {
            passed += 1;
            let measured = nearest(account, level.branch(id).unwrap());
            assert!(distance <= NEAR && distance < measured + 1e-3, "{distance}, {measured}: {:?}", account.window);
        }
        let passes = |id| nearest(account, level.branch(id).unwrap()) <= NEAR;
        if account.branches().is_empty() {
            not_found += 1;
            assert!(level.branches().all(|(id, _)| !passes(id)), "{:?}", account.window);
        } else if account.window.first > 0 {
            assert!(account.branches().into_iter().any(passes), "{:?}", account.window);
        }
    }
    assert_eq!((level.windows.len(), not_found, passed), (14, 2, 3));
}
