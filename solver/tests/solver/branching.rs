//! Branches that branch off others, against the multipliers of those by Runge–Kutta integration of the equation of motion linearised
//! about them: of one mass, where all is known that is needed for it.

use crate::support::hill::hill;
use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::curve::outcome::{Outcome, Stop};
use solver::laws::{Jenkins, PenaltySpring, PolynomialSpring, Term};
use solver::response::branch::Standing;
use solver::response::starts::{StartPlace, land};
use solver::settings::Stretch;
use solver::stability::bifurcation::BifurcationKind;
use solver::stability::verification::verify;
use solver::{Branch, Forced, Matrix, Model, ModelBuilder, SearchRange, Settings, State};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

const RATIO: f64 = 0.02;
/// Points over the period of a response.
const SAMPLES: usize = 40_000;
/// Relative difference of frequencies: the branches have as many harmonics as the settings say, the multipliers all.
const CLOSE: f64 = 1e-5;
/// The same where stiffness jumps between samples: a period has 40,000.
const JUMPS: f64 = 3e-5;

/// A mass of 1 kg on a spring of 1 N/m, driven at a multiple of the frequency of its response.
fn mass(harmonic: usize) -> ModelBuilder {
    let model = Model::builder("one mass")
        .mass(Matrix::diagonal(&[1.0]))
        .stiffness(Matrix::diagonal(&[1.0]))
        .damping_ratio(RATIO);
    model.force(0, 1.0).harmonic(harmonic).monitor(0)
}

/// The same before an elastic stop.
pub fn before_a_stop(harmonic: usize, gap: f64, stiffness: f64) -> Model {
    mass(harmonic).element("stop", PenaltySpring { stiffness, gap }, [vec![(0, 1.0)]]).build().unwrap()
}

pub fn settings(harmonics: usize, low: f64, high: f64) -> Settings {
    let mut settings = with_harmonics(harmonics);
    (settings.frequency.min, settings.frequency.max) = (Some(low), Some(high));
    settings
}

fn forced(study: &Study, forcing: f64) -> Forced<'_> {
    let range = SearchRange::new(&study.settings, &study.backbones[0]).unwrap();
    Forced::new(&study.model, &study.settings, range, forcing)
}

/// A mass with its spring, and the multiplier over half the period of a response with which motions of less symmetry branch off: −1
/// if the response may have two periods of the forcing in its own, of which motions of one are twice through; 1 if the structure is
/// symmetric, and half a period later the motion is its mirror image.
struct Case<'c> {
    study: &'c Study,
    slope: fn(f64) -> f64,
    multiplier: f64,
}

/// det(Φ − μI) over half the period of the response.
fn characteristic(case: &Case<'_>, state: &State) -> f64 {
    let motion: Vec<f64> = state.over_period(&case.study.model, 0, SAMPLES).iter().map(|at| at[0]).collect();
    hill(&motion, state.omega, SAMPLES / 2, 2.0 * RATIO, |x| 1.0 + (case.slope)(x), case.multiplier)
}

/// Frequencies at which it passes through zero along a branch.
fn passages(case: &Case<'_>, branch: &Branch) -> Vec<f64> {
    let mut forced = forced(case.study, branch.forcing);
    let values: Vec<f64> = branch.points.iter().map(|point| characteristic(case, &point.state)).collect();
    let mut list = Vec::new();
    for i in (1..values.len()).filter(|&i| values[i - 1] * values[i] < 0.0) {
        let [mut low, mut high] = [i - 1, i].map(|i| branch.points[i].state.clone());
        while (low.omega / high.omega - 1.0).abs() > 1e-8 {
            let middle = forced.converge(&low.interpolate(&high, 0.5)).unwrap();
            let is_beyond = characteristic(case, &middle) * values[i] > 0.0;
            *(if is_beyond { &mut high } else { &mut low }) = middle;
        }
        list.push(high.omega);
    }
    list
}

/// A branch leads from one of these frequencies to the other, and no farther.
fn assert_between(branch: &Branch, ends: &[f64], close: f64) {
    let (low, high) = branch.frequency_range();
    let is_close = |a: f64, b: f64| (a / b - 1.0).abs() < close;
    assert_eq!(branch.kind, Kind::Branched);
    assert_eq!(branch.outcome, Outcome::Open(Stop::Branching, Stop::Branching));
    assert_eq!(branch.peak_standing(), Standing::At);
    let at_ends = [branch.points.first(), branch.points.last()].map(|end| end.unwrap().omega());
    assert!(at_ends.iter().all(|end| is_close(*end, low) || is_close(*end, high)), "{at_ends:?} of {low} to {high}");
    assert!(
        ends.len() == 2 && is_close(ends[0].min(ends[1]), low) && is_close(ends[0].max(ends[1]), high),
        "{ends:?}, {low} to {high}"
    );
}

#[test]
fn a_period_doubled_branch_goes_from_one_multiplier_of_minus_one_to_the_other() {
    let study = Study::of_modes(before_a_stop(2, 0.5, 2.0), settings(20, 0.9, 1.6));
    let level = study.level(3.0);
    let (mains, branched) = (of_kind(&level, Kind::Main), of_kind(&level, Kind::Branched));
    assert!(mains.len() == 1 && branched.len() == 1 && level.len() == 2, "{level:#?}");
    let (main, branched) = (&mains[0].branch, &branched[0].branch);
    let case = Case { study: &study, slope: |x| if x > 0.5 { 2.0 } else { 0.0 }, multiplier: -1.0 };
    assert_between(branched, &passages(&case, main), CLOSE);
    // It is what the structure moves by: several times as much as the motions that it branches off.
    assert!(branched.peak().amplitude() > 5.0 * main.peak().amplitude(), "{level:#?}");
}

/// The motions of two periods that branch off turn into their own images where they do. That is no fold: of folds there are three, by a
/// balance of 14 harmonics of another program.
#[test]
fn the_ends_of_a_branch_are_branch_points_and_no_folds() {
    let terms = [(2, 0.6), (3, 0.3)].map(|(power, coefficient)| Term { power, coefficient }).to_vec();
    let builder = Model::builder("one mass").mass([[1.0]]).stiffness([[1.0]]).damping_ratio(0.02);
    let model = builder.force("x1", 1.0).harmonic(2).element("spring", PolynomialSpring { terms }, ["x1"]).build();
    let study = Study::of_modes(model.unwrap(), settings(10, 0.5, 1.6));
    let level = study.level(0.4);
    let branched = &of_kind(&level, Kind::Branched)[0].branch;
    let found =
        verify(&study.model, branched, Stretch::Whole, &mut |_| ControlFlow::Continue(())).unwrap().bifurcations;
    let of = |kind: BifurcationKind| -> Vec<f64> {
        let mut list: Vec<f64> = found.iter().filter(|found| found.kind == kind).map(|found| found.omega).collect();
        list.sort_by(f64::total_cmp);
        list
    };
    let (folds, branch_points) = (of(BifurcationKind::Fold), of(BifurcationKind::BranchPoint));
    let is_close = |(a, b): (&f64, f64)| (a / b - 1.0).abs() < 1e-5;
    assert!(folds.len() == 3 && folds.iter().zip([0.961106, 1.014943, 1.048379]).all(is_close), "{folds:?}");
    let case = Case { study: &study, slope: |x| 1.2 * x + 0.9 * x * x, multiplier: -1.0 };
    let mut passages = passages(&case, &of_kind(&level, Kind::Main)[0].branch);
    passages.sort_by(f64::total_cmp);
    assert!(
        branch_points.len() == passages.len() && branch_points.iter().zip(passages.iter().copied()).all(is_close),
        "{branch_points:?}, {passages:?}"
    );
}

#[test]
fn asymmetric_motions_of_a_symmetric_structure_branch_off_where_symmetric_ones_lose_their_stability() {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] };
    let model = mass(1).element("spring", spring, [vec![(0, 1.0)]]).build().unwrap();
    let study = Study::of_modes(model, settings(21, 0.8, 1.4));
    asymmetric_motions_branch_off(&study, |x| 3.0 * x * x, 5.0, CLOSE);
}

/// Two stops on either side are symmetric as well, though none of them is.
#[test]
fn asymmetric_motions_between_two_stops_branch_off_where_symmetric_ones_lose_their_stability() {
    let stop = PenaltySpring { stiffness: 9.0, gap: 0.5 };
    let model = mass(1).element("right", stop.clone(), [vec![(0, 1.0)]]).element("left", stop, [vec![(0, -1.0)]]);
    let study = Study::of_modes(model.build().unwrap(), settings(21, 0.7, 2.2));
    asymmetric_motions_branch_off(&study, |x| if x.abs() > 0.5 { 9.0 } else { 0.0 }, 3.0, JUMPS);
}

/// Random starts lead to motions of one branch that goes from one multiplier of 1 over half the period to the other.
fn asymmetric_motions_branch_off(study: &Study, slope: fn(f64) -> f64, forcing: f64, close: f64) {
    let level = study.level(forcing);
    let main = &of_kind(&level, Kind::Main)[0].branch;
    let mut forced = forced(study, forcing);
    let ends = passages(&Case { study, slope, multiplier: 1.0 }, main);
    let mut found = 0;
    for batch in 0..32 {
        for state in
            land(&mut forced, &StartPlace::random(batch)).unwrap_or_default().iter().map(|landing| &landing.state)
        {
            if found < 8 && !forced.lies_on(state, main) {
                let branch = forced.branch_through(state, &mut |_| ControlFlow::Continue(())).unwrap();
                assert_between(&branch, &ends, close);
                found += 1;
            }
        }
    }
    assert!(found > 1, "{found} starts led there");
}

/// Two masses, each on a slider behind a spring, one of them on a cubic spring as well: nothing of it is one-sided.
#[test]
fn what_branches_off_a_main_branch_with_sliders_is_no_second_one() {
    let cubic = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 0.5 }] };
    let model = Model::builder("two sliders")
        .mass(Matrix::diagonal(&[1.0, 1.0]))
        .stiffness([[1.1, -0.1], [-0.1, 1.1]])
        .damping_ratios([0.002, 0.002 / 1.2_f64.sqrt()])
        .force(0, 1.0)
        .monitor(1)
        .element("slider a", Jenkins { stiffness: 0.4, limit: 0.1 }, [vec![(0, 1.0)]])
        .element("slider b", Jenkins { stiffness: 0.3, limit: 0.05 }, [vec![(1, 1.0)]])
        .element("spring", cubic, [vec![(1, 1.0)]])
        .build()
        .unwrap();
    let study = Study::of_modes(model, settings(9, 0.6, 3.0));
    let level = study.level(0.3);
    let [main] = &of_kind(&level, Kind::Main)[..] else { panic!("one main branch") };
    let mut forced = forced(&study, 0.3);
    let symmetric = &main.branch.peak().state;
    let (width, eighth) = (symmetric.modal.len() / 2, TAU / 8.0);
    let mut found = 0;
    // The second harmonic of b, which symmetric motions have not: in both its channels, and in both modes.
    for phase in 0..8 {
        let (mut pushed, (sin, cos)) = (symmetric.clone(), (f64::from(phase) * eighth).sin_cos());
        for (modal, share) in [(0, 0.5_f64.sqrt()), (1, -0.5_f64.sqrt())] {
            pushed.modal[modal * width + 3] += 0.6 * share * cos;
            pushed.modal[modal * width + 4] += 0.6 * share * sin;
        }
        for channel in [1, 2] {
            pushed.arguments[channel * width + 3] += 0.6 * cos;
            pushed.arguments[channel * width + 4] += 0.6 * sin;
        }
        let Ok(state) = forced.converge(&pushed) else { continue };
        if forced.lies_on(&state, &main.branch) {
            continue;
        }
        let branch = forced.branch_through(&state, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(branch.kind, Kind::Branched, "{}", branch.outcome);
        // By Runge–Kutta integration with the sliders' forces instant by instant, at 1.0465 rad/s: 2.4520 one way, 2.4463 the other.
        let peak = branch.peak().amplitude();
        assert!((peak - 2.4523).abs() < 1e-3 && peak > 1.03 * main.branch.peak().amplitude(), "{peak}");
        found += 1;
    }
    assert!(found > 0, "no push led there");
}
