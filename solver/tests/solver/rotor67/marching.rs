//! Time marching from points of the branches: another discretisation, another contact law.
//!
//! The contact law of the marching takes the kinetic energy of the touching nodes at every impact, and harmonic balance
//! truncates at H = 10; both are within 2 % of the amplitude here. A stable solution holds, an unstable one is left.

use super::common::{BACKWARD, FRICTIONLESS, Scenario, found_from_window};
use solver::formulation::harmonics::evaluate;
use solver::formulation::state::State;
use solver::marching::{Marching, MarchingSettings};
use solver::response::branch::Branch;
use solver::response::forced::{Forced, SearchRange};
use solver::settings::Settings;
use std::f64::consts::TAU;

/// Largest |x| of the leading edge over a period, m.
fn leading_edge(scenario: &Scenario, state: &State) -> f64 {
    let model = scenario.model();
    let series = state.displacement(model, model.monitors()[0]);
    (0..4096).map(|j| evaluate(&series, TAU * j as f64 / 4096.0)[0].abs()).fold(0.0, f64::max)
}

/// All solutions of a branch at exactly `omega`, the largest first: interpolated between its points, then converged.
fn solutions(scenario: &Scenario, branch: &Branch, omega: f64) -> Vec<State> {
    let (model, backbone) = (scenario.model(), scenario.backbone());
    let mut forced = Forced::new(
        model,
        &Settings::default(),
        SearchRange::new(&Settings::default(), backbone).unwrap(),
        branch.forcing,
    );
    let mut points: Vec<&State> = branch.points.iter().map(|p| &p.state).collect();
    if branch.is_closed() {
        points.push(points[0]);
    }
    let crossing = points.windows(2).filter(|pair| (pair[0].omega < omega) != (pair[1].omega < omega));
    let mut found: Vec<State> = crossing
        .map(|pair| {
            let share = (omega - pair[0].omega) / (pair[1].omega - pair[0].omega);
            let between = State { omega, ..pair[0].interpolate(pair[1], share) };
            let state = forced.converge(&between).unwrap();
            // Chords of a curve walked in steps of up to a tenth of a gap; other solutions are farther away than this.
            let moved = forced.motion_distance(&state, &between, 0);
            assert!(moved < 0.1, "the solution at {omega} rad/s is {moved} away from the branch");
            state
        })
        .collect();
    found.sort_by(|a, b| leading_edge(scenario, b).total_cmp(&leading_edge(scenario, a)));
    found
}

/// Marches from x(0) and ẋ(0) of a solution.
fn start<'s>(scenario: &'s Scenario, state: &State) -> Marching<'s> {
    let model = scenario.model();
    let (x, xdot): (Vec<f64>, Vec<f64>) = (0..model.size())
        .map(|i| {
            let [x, slope, _] = evaluate(&state.displacement(model, i), 0.0);
            (x, state.omega * slope)
        })
        .unzip();
    let settings = MarchingSettings::default();
    let mut marching = Marching::new(model, &settings, state.forcing, state.omega).unwrap();
    marching.set_state(&x, &xdot).unwrap();
    marching
}

/// The amplitude over the last ten of 100 periods stays within 5 % of the solution's.
#[track_caller]
fn assert_holds(scenario: &Scenario, state: &State) {
    let mut marching = start(scenario, state);
    let expected = leading_edge(scenario, state);
    for period in 1..=100 {
        let ratio = marching.period().unwrap().max[0] / expected;
        if period > 90 {
            assert!((ratio - 1.0).abs() < 0.05, "{} rad/s, period {period}: {ratio} of {expected} m", state.omega);
        }
    }
}

/// Within 500 periods the amplitude is more than 20 % off the solution's.
#[track_caller]
fn assert_leaves(scenario: &Scenario, state: &State) {
    let mut marching = start(scenario, state);
    let expected = leading_edge(scenario, state);
    let leaves = (0..500).any(|_| (marching.period().unwrap().max[0] / expected - 1.0).abs() > 0.2);
    assert!(leaves, "{} rad/s: {expected} m holds for 500 periods", state.omega);
}

/// Frequencies in the middle half of the frictionless isola at A = 60, 2584 to 2662 rad/s.
///
/// Near the lower end of that half (2590 rad/s) the upper solution holds for 100 periods, but the marching leaves it
/// slowly, in a growing modulation, after 150: it is weakly unstable there.
const FRICTIONLESS_MIDDLE: [f64; 3] = [2590.0, 2623.0, 2655.0];

/// The same with friction, sense −1, at A = 20: 2463 to 2485 rad/s.
const BACKWARD_MIDDLE: [f64; 3] = [2466.0, 2474.0, 2482.0];

/// The upper and the lower solution of an isola at frequencies in its middle half.
fn isola_solutions(scenario: &Scenario, amplitude: u32, middle: [f64; 3]) -> Vec<[State; 2]> {
    let level = scenario.level(amplitude);
    let id = found_from_window(level, middle[1]);
    assert!(!id.is_main(), "no isola round {} rad/s", middle[1]);
    let isola = level.branch(id).unwrap();
    let (low, high) = isola.frequency_range();
    let pairs = middle.into_iter().map(|omega| {
        assert!((omega - 0.5 * (low + high)).abs() < 0.25 * (high - low), "{omega} of {low} to {high} rad/s");
        let states = solutions(scenario, isola, omega);
        states.try_into().unwrap_or_else(|_| panic!("an isola has two solutions at {omega} rad/s"))
    });
    pairs.collect()
}

#[test]
fn the_upper_part_of_the_frictionless_isola_holds() {
    for [upper, _] in isola_solutions(&FRICTIONLESS, 60, FRICTIONLESS_MIDDLE) {
        assert_holds(&FRICTIONLESS, &upper);
    }
}

#[test]
fn the_lower_part_of_the_frictionless_isola_is_left() {
    for [_, lower] in isola_solutions(&FRICTIONLESS, 60, FRICTIONLESS_MIDDLE) {
        assert_leaves(&FRICTIONLESS, &lower);
    }
}

#[test]
fn with_friction_too_the_upper_part_holds_and_the_lower_is_left() {
    for [upper, lower] in isola_solutions(&BACKWARD, 20, BACKWARD_MIDDLE) {
        assert_holds(&BACKWARD, &upper);
        assert_leaves(&BACKWARD, &lower);
    }
}

#[test]
fn of_three_main_responses_the_middle_one_is_left() {
    for omega in [2400.0, 2450.0, 2500.0, 2525.0] {
        let states = solutions(&FRICTIONLESS, FRICTIONLESS.level(60).main(), omega);
        assert_eq!(states.len(), 3, "between its folds the main branch has three solutions at {omega} rad/s");
        assert_holds(&FRICTIONLESS, &states[0]);
        assert_leaves(&FRICTIONLESS, &states[1]);
        assert_holds(&FRICTIONLESS, &states[2]);
    }
}
