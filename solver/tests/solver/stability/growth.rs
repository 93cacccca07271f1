//! Small deviations of marched orbits follow their monodromy matrix: laws with memory.

use super::common::main_branch;
use super::models::{chain, jenkins, tanh_friction};
use solver::stability::polish::{Around, PolishSettings, polish};
use solver::{Model, Settings};

/// Polishes the peak of the main branch, moves its orbit and compares what is left after so many periods with Φ^periods.
fn compare(model: &Model, forcing: f64, periods: usize) {
    let mut settings = Settings::default();
    (settings.frequency.min, settings.frequency.max) = (Some(12.0), Some(30.0));
    let branch = main_branch(model, &settings, forcing);
    let at = branch.points.iter().position(|point| point == branch.peak()).unwrap();
    let between = Some([&branch.points[at - 1].state, &branch.points[at + 1].state]);
    let found =
        polish(model, &PolishSettings::default(), &branch.points[at].state, Around { between, neighbour: None });
    println!("{:?} {:?} {:?}", found.verdict, found.reason, found.periods);
    let orbit = found.polished.unwrap();
    println!("{:?} distance {} impacts {}", orbit.multipliers[0], orbit.distance, orbit.impacts);

    let mut marching = orbit.orbit.marching(model).unwrap();
    let mut along = orbit.orbit.marching(model).unwrap();
    let tangent = marching.monodromy().unwrap();
    let state = &orbit.orbit.state;
    let mut deviation: Vec<f64> = state.iter().map(|x| 1e-6 * x).collect();
    let start: Vec<f64> = state.iter().zip(&deviation).map(|(x, d)| x + d).collect();
    marching.restart(&start).unwrap();
    let n = model.size();
    let size = |z: &[f64]| z[..n].iter().map(|x| x * x).sum::<f64>().sqrt();
    let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
    for _ in 0..periods {
        marching.period().unwrap();
        along.period().unwrap();
        deviation = tangent.mul_vec(&deviation);
    }
    let left = apart(&marching.state(), &along.state());
    let apart = apart(&left, &deviation);
    // A step is affine as long as the slider sticks and slides in the same steps.
    assert!(size(&apart) < 1e-4 * size(&deviation), "{:e} of {:e}", size(&apart), size(&deviation));
}

#[test]
fn deviations_from_hysteretic_orbits_follow_the_monodromy_matrix() {
    let slider = (jenkins(800.0, 2.0), vec![vec![(0, 1.0), (1, -1.0)]]);
    compare(&chain(vec![slider.clone()]), 4.0, 20);
    compare(&chain(vec![slider, (tanh_friction(1.0, 1.0), vec![vec![(1, 1.0)]])]), 4.0, 20);
}
