//! What the harmonics that were left out change of branches, away from their peaks.

use crate::support::study::{Kind, Study, of_kind, with_harmonics};
use solver::laws::{Contact, PolynomialSpring, Term};
use solver::response::branch::{Outcome, Stop};
use solver::response::certificate::{Change, Standing};
use solver::{Branch, BranchPoint, Model};

/// The main branch of x'' + 0.02 x' + x + x³ = 0.3 cos ωt, with superharmonic resonances.
fn duffing(harmonics: usize) -> Branch {
    main_branch(harmonics, 0.3, (0.15, 3.0))
}

/// The same of any forcing amplitude, within bounds of the frequency.
fn main_branch(harmonics: usize, forcing: f64, (min, max): (f64, f64)) -> Branch {
    let spring = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] };
    let model = Model::builder("duffing").mass([[1.0]]).stiffness([[1.0]]).damping_ratio(0.01).force(0, 1.0);
    let model = model.element("spring", spring, [vec![(0, 1.0)]]).build().unwrap();
    let mut settings = with_harmonics(harmonics);
    (settings.frequency.min, settings.frequency.max) = (Some(min), Some(max));
    let level = Study::of_modes(model, settings).level(forcing);
    let [main] = &of_kind(&level, Kind::Main)[..] else { panic!("{level:#?}") };
    main.branch.clone()
}

/// Relative distance of a point from a branch, in frequency and amplitude.
fn distance(point: &BranchPoint, branch: &Branch) -> f64 {
    let at = |other: &BranchPoint| [other.omega() / point.omega() - 1.0, other.amplitude() / point.amplitude() - 1.0];
    let to = |pair: &[BranchPoint]| {
        let ([ax, ay], [bx, by]) = (at(&pair[0]), at(&pair[1]));
        let (dx, dy) = (bx - ax, by - ay);
        let share = (-(ax * dx + ay * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        (ax + share * dx).hypot(ay + share * dy)
    };
    branch.points.windows(2).map(to).fold(f64::INFINITY, f64::min)
}

/// Where the third harmonic resonates and bends over, harmonics beyond H count that the peak has nothing of.
#[test]
fn superharmonic_resonances_need_more_harmonics_than_the_peak() {
    for (harmonics, least, most) in [(3, 0.02, 0.1), (5, 1e-3, 0.02), (10, 1e-5, 1e-3)] {
        let [few, twice] = [1, 2].map(|factor| duffing(factor * harmonics));
        let peak = few.certificate.doubled.unwrap();
        let change = peak.amplitude / few.peak().amplitude() - 1.0;
        let Change { omega, share } = few.certificate.elsewhere.unwrap();
        let share = share.unwrap();
        // How far the branch with twice the harmonics, traced by itself, ever is from the one with few.
        let apart = twice.points.iter().map(|point| (point.omega(), distance(point, &few)));
        let (at, farthest) = apart.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        println!("H = {harmonics}: {share:e} at {omega} rad/s, {farthest:e} at {at} rad/s, the peak {change:e}");
        assert!(change.abs() < 0.1 * share, "H = {harmonics}: the peak changes by {change:e}");
        assert!((least..most).contains(&share) && omega < 0.5, "H = {harmonics}: {share:e} at {omega} rad/s");
        // The last ones are as near to each other as their chords to the curves.
        let is_much = (0.5..1.1).contains(&(share / farthest));
        assert!(harmonics == 10 || is_much, "H = {harmonics}: {share:e}, {farthest:e} at {at} rad/s");
    }
}

/// A mass that strikes a rigid wall: pressures have all harmonics, and twice as many change the motion by more than Newton's method gets over
/// at once.
#[test]
fn peaks_of_impacts_with_twice_the_harmonics() {
    let model = Model::builder("impact")
        .mass([[2.0]])
        .stiffness([[50.0]])
        .damping_ratio(0.03)
        .force("x1", 1.0)
        .element("wall", Contact { gap: 0.003, epsilon: 50.0, friction: None }, ["x1"])
        .build()
        .unwrap();
    for forcing in [0.02, 0.08] {
        let peak = |harmonics: usize| {
            let level = Study::of_modes(model.clone(), with_harmonics(harmonics)).level(forcing);
            let [main] = &of_kind(&level, Kind::Main)[..] else { panic!("{level:#?}") };
            let peak = main.branch.peak();
            (peak.omega(), peak.amplitude(), main.branch.certificate.doubled)
        };
        let ((few, _, doubled), (omega, amplitude, _)) = (peak(10), peak(20));
        let doubled = doubled.unwrap_or_else(|| panic!("A = {forcing}: no peak with twice the harmonics"));
        assert!((doubled.amplitude / amplitude - 1.0).abs() < 1e-6, "A = {forcing}: {} {amplitude}", doubled.amplitude);
        assert!(((1.0 + doubled.shift) * few / omega - 1.0).abs() < 1e-4, "A = {forcing}: {} {omega}", doubled.shift);
    }
}

/// A branch that is cut off below its peak, and its last step of no length.
#[test]
fn what_is_largest_at_an_end_but_for_rounding_is_no_maximum() {
    let mut cut = duffing(5);
    cut.points.truncate(cut.peak_index() - 5);
    cut.outcome = Outcome::Open(Stop::Start, Stop::FrequencyBound);
    assert_eq!((cut.peak_index() + 1, cut.peak_standing()), (cut.points.len(), Standing::AtLeast));
    cut.outcome = Outcome::Open(Stop::FrequencyBound, Stop::Start);
    cut.points.reverse();
    cut.points.insert(0, cut.points[0].clone());
    assert_eq!((cut.peak_index(), cut.peak_standing()), (1, Standing::AtLeast));
}

/// A main branch that leaves through a bound of the frequency on its way to its resonance: a superharmonic one below is larger than what is
/// within the bounds, and is not the largest there is.
#[test]
fn a_branch_that_leaves_growing_may_be_larger_beyond() {
    let standing = |max: f64| {
        let main = main_branch(7, 1.5, (0.4, max));
        (main.outcome, main.peak().omega() < 0.7, main.peak_standing())
    };
    let (outcome, is_superharmonic, cut) = standing(1.2);
    assert!(matches!(outcome, Outcome::Open(_, Stop::FrequencyBound)) && is_superharmonic, "{outcome}");
    assert_eq!(cut, Standing::AtLeast);
    let (_, is_superharmonic, known) = standing(12.0);
    assert!(!is_superharmonic && known == Standing::At);
}

/// Beside an isola the peak of the main branch is near, which has no more harmonics: what twice as many make of the isola's is not that.
#[test]
fn the_peak_of_an_isola_is_not_that_of_the_main_branch() {
    let model = Model::builder("rocker on a bracket")
        .mass([[2.0, 0.0], [0.0, 0.5]])
        .stiffness([[2.5e5, -5e4], [-5e4, 5e4]])
        .damping_ratio(0.005)
        .force(0, 1.0)
        .monitor(1)
        .element("stop", Contact { gap: 5e-4, epsilon: 5e4, friction: None }, [vec![(1, 1.0), (0, -1.0)]])
        .build()
        .unwrap();
    let isola = |harmonics: usize| {
        let level = Study::new(model.clone(), with_harmonics(harmonics)).level(1.0);
        let [isola] = &of_kind(&level, Kind::Isola)[..] else { panic!("{level:#?}") };
        (isola.branch.peak().amplitude(), isola.branch.certificate.doubled)
    };
    let ((_, doubled), (amplitude, _)) = (isola(20), isola(40));
    let doubled = doubled.unwrap();
    assert!((doubled.amplitude / amplitude - 1.0).abs() < 1e-6, "{} {amplitude}", doubled.amplitude);
}
