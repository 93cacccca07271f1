//! What unstable motions turn into, against a program of its own: Runge–Kutta integration of the equation of motion.

use super::common::{assert_close, main_branch};
use super::stops::two_masses;
use solver::formulation::state::State;
use solver::laws::{LawKind, PolynomialDamper, Term};
use solver::response::task::{BranchId, MarchPlace};
use solver::stability::multipliers::Verdict;
use solver::stability::polish::{Around, PolishSettings, polish};
use solver::stability::settling::{Motion, SettleSettings, Settling, settle};
use solver::stability::verification::Verification;
use solver::{Branch, Model, Settings, Stretch, verify};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

fn whole(model: &Model, branch: &Branch) -> Verification {
    verify(model, branch, Stretch::Whole, &mut |_| ControlFlow::Continue(())).unwrap()
}

fn settled(model: &Model, known: &[(BranchId, &Branch)], branch: &Branch, index: usize, omega: f64) -> Settling {
    let place = MarchPlace { branch: BranchId::MAIN, index, omega };
    let found = settle(model, &SettleSettings::default(), known, branch, &place, &mut |_, _| ControlFlow::Continue(()))
        .unwrap();
    assert!(found.is_sound(&place, model.monitors().len()));
    found
}

/// What the grid of the marcher changes an amplitude by: within cascades of period doublings more than elsewhere.
const GRID: f64 = 3e-3;

/// Accelerations of a system at a time.
type Law<const N: usize> = dyn Fn(f64, [f64; N], [f64; N]) -> [f64; N];

/// Amplitudes of the first mass, one a period, and the displacements and velocities at the end.
fn integrated<const N: usize>(
    law: &Law<N>,
    omega: f64,
    count: usize,
    start: [[f64; N]; 2],
) -> (Vec<f64>, [[f64; N]; 2]) {
    const STEPS: usize = 4096;
    let h = TAU / omega / STEPS as f64;
    let (mut z, mut found, mut largest) = (start, Vec::new(), 0.0f64);
    for i in 0..count * STEPS {
        let t = (i % STEPS) as f64 * h;
        let moved = |by: f64, r: &[[f64; N]; 2]| -> [[f64; N]; 2] {
            std::array::from_fn(|k| std::array::from_fn(|j| z[k][j] + by * r[k][j]))
        };
        let rate = |t: f64, [x, v]: [[f64; N]; 2]| [v, law(t, x, v)];
        let a = rate(t, z);
        let b = rate(t + 0.5 * h, moved(0.5 * h, &a));
        let c = rate(t + 0.5 * h, moved(0.5 * h, &b));
        let d = rate(t + h, moved(h, &c));
        z = std::array::from_fn(|k| {
            std::array::from_fn(|j| z[k][j] + h / 6.0 * (a[k][j] + 2.0 * (b[k][j] + c[k][j]) + d[k][j]))
        });
        largest = largest.max(z[0][0].abs());
        if i % STEPS == STEPS - 1 {
            found.push(largest);
            largest = 0.0;
        }
    }
    (found, z)
}

/// Smallest and largest amplitude that direct integration settles on, and the growth rate of a small deviation per period.
fn direct<const N: usize>(
    law: &Law<N>,
    omega: f64,
    [settling, count]: [usize; 2],
    start: [[f64; N]; 2],
) -> ([f64; 2], f64) {
    let (_, z) = integrated(law, omega, settling, start);
    let (amplitudes, _) = integrated(law, omega, count, z);
    let (mut a, mut b) = (z, z);
    b[0][0] += BESIDE;
    let mut growth = 0.0;
    for i in 0..400 {
        (_, a) = integrated(law, omega, 1, a);
        (_, b) = integrated(law, omega, 1, b);
        let apart = (0..N).map(|j| (a[0][j] - b[0][j]).powi(2) + (a[1][j] - b[1][j]).powi(2)).sum::<f64>().sqrt();
        let nearer = |k: usize| std::array::from_fn(|j| a[k][j] + (b[k][j] - a[k][j]) * BESIDE / apart);
        b = [nearer(0), nearer(1)];
        growth += if i < 200 { 0.0 } else { (apart / BESIDE).ln() / 200.0 };
    }
    let range = amplitudes.iter().fold([f64::INFINITY, 0.0f64], |[low, high], x| [low.min(*x), high.max(*x)]);
    (range, growth)
}

const BESIDE: f64 = 1e-7;

/// Where the masses before a stop double their period, rad/s.
const DOUBLING: f64 = 0.738_783;

fn masses_before_a_stop(omega: f64) -> impl Fn(f64, [f64; 2], [f64; 2]) -> [f64; 2] {
    move |t, [x, y], [v, w]| {
        let (stop, force) = (100.0 * (x - 1.0).max(0.0), 0.1 * (omega * t).cos());
        [-(x - y) - 0.03 * (v - w) - stop, force + x - 2.0 * y + 0.03 * (v - 2.0 * w)]
    }
}

/// Displacements and velocities at t = 0 of the marched orbit at a point.
fn start<const N: usize>(model: &Model, branch: &Branch, index: usize, omega: f64) -> [[f64; N]; 2] {
    let state = State { omega, ..branch.points[index].state.clone() };
    let orbit = polish(model, &PolishSettings::default(), &state, Around::default()).polished.unwrap().orbit;
    let mut marching = orbit.marching(model).unwrap();
    let (x, mut v) = (marching.displacements(), marching.velocities());
    // Velocities of the marcher are those half a step ago.
    marching.step().unwrap();
    v.iter_mut().zip(marching.velocities()).for_each(|(v, next)| *v = 0.5 * (*v + next));
    [std::array::from_fn(|j| x[j]), std::array::from_fn(|j| v[j])]
}

/// The main branch between two frequencies.
fn main_between(model: &Model, bounds: (f64, f64), max_step: f64) -> Branch {
    let mut settings = Settings::default();
    settings.harmonics.count = 30;
    settings.continuation.max_step = max_step;
    (settings.frequency.min, settings.frequency.max) = (Some(bounds.0), Some(bounds.1));
    main_branch(model, &settings, 0.1)
}

#[test]
fn beyond_its_bifurcations_a_motion_is_what_direct_integration_makes_of_it() {
    let model = two_masses();
    let branch = main_between(&model, (0.4, 1.0), 0.1);
    let verification = whole(&model, &branch);
    let mut places = verification.unsettled();
    assert!(places.len() > 5 && places.is_sorted_by(|a, b| a.0 < b.0), "{places:?}");
    for (index, omega) in &places {
        let point = verification.points.iter().find(|point| point.index == *index).unwrap();
        assert_eq!((point.verdict, point.orbit.as_ref().unwrap().omega), (Verdict::Unstable, *omega));
    }
    // Of what is unstable all along, without a bifurcation, some points of all are followed.
    let mut everywhere = verification.clone();
    everywhere.bifurcations.clear();
    assert!(everywhere.unsettled().is_empty());
    everywhere.points.retain(|point| point.verdict == Verdict::Unstable);
    let spread = everywhere.unsettled();
    assert!(spread.len() == 6 && spread[0].0 == everywhere.points[0].index, "{spread:?}");
    // What was stable all along stays on the branch; near a grazing contact not always on the same part of it.
    let unstable = places.len();
    let inside = &verification.points[1..verification.points.len() - 1];
    let stable = inside.iter().filter(|point| point.verdict == Verdict::Stable);
    places.extend(stable.map(|point| (point.index, branch.points[point.index].omega())));
    let (mut counts, mut others) = ([0; 4], 0);
    for (number, (index, omega)) in places.into_iter().enumerate() {
        let found = settled(&model, &[(BranchId::MAIN, &branch)], &branch, index, omega);
        let motion = found.motion.map_or(0, |motion| match motion {
            Motion::Periodic(1) => 1,
            Motion::Periodic(_) => 2,
            Motion::QuasiPeriodic | Motion::Chaotic => 3,
        });
        counts[motion] += 1;
        assert_eq!(found.onto, (motion == 1).then_some(BranchId::MAIN), "{found:?}");
        // Beside a bifurcation what there is depends on the grid.
        let is_beside = (found.omega / DOUBLING - 1.0).abs() < 5e-4;
        if number < unstable && motion > 0 && motion < 3 && !is_beside {
            let law = masses_before_a_stop(found.omega);
            // Near a bifurcation all takes its time.
            let periods = [800.max(4 * found.periods), 32];
            let integrated = |by: f64| {
                let mut start = start(&model, &branch, index, omega);
                start[0][0] += by;
                direct(&law, found.omega, periods, start).0
            };
            let range = integrated(0.0);
            if (range[0] - found.amplitudes[0][0]).abs() < GRID {
                assert_range(&found, range);
            } else {
                // Two motions are there, and the sign of the first deviation decides which of them comes.
                others += 1;
                assert_range(&found, integrated(-1e-5));
            }
        }
    }
    println!("{counts:?}");
    assert!(counts[1] > 5 && counts[2] > 5 && counts[0] <= 3 && others <= 1, "{counts:?}, {others}");
}

#[track_caller]
fn assert_range(found: &Settling, [low, high]: [f64; 2]) {
    assert_close(found.amplitudes[0][0], low, GRID, "smallest amplitude, m");
    assert_close(found.amplitudes[0][1], high, GRID, "largest amplitude, m");
}

/// Below the Neimark–Sacker bifurcation at 0.6186 rad/s four periods lock; doublings lead from there to chaos.
#[test]
fn chaos_begins_where_direct_integration_has_it() {
    let model = two_masses();
    let branch = main_between(&model, (0.6, 0.63), 0.002);
    let mut motions = Vec::new();
    for index in
        (1..branch.points.len() - 1).filter(|&i| (0.606..0.6186).contains(&branch.points[i].omega())).step_by(3)
    {
        let omega = branch.points[index].omega();
        let found = settled(&model, &[], &branch, index, omega);
        let ([low, high], growth) =
            direct(&masses_before_a_stop(omega), omega, [800, 400], start(&model, &branch, index, omega));
        println!("{} rad/s: {:?} {:?}, {low} to {high}, {growth}", found.omega, found.motion, found.growth);
        match found.motion {
            // Extremes of a chaotic motion depend on how long it is watched.
            Some(Motion::Chaotic) => {
                assert!(growth > 0.03, "{growth}");
                assert!(found.growth.unwrap() > 0.03, "{found:?}");
                assert_close(found.amplitudes[0][1], high, 0.02, "largest amplitude, m");
            }
            _ => assert_range(&found, [low, high]),
        }
        motions.push(found.motion);
    }
    assert!(motions.contains(&Some(Motion::Chaotic)) && motions.contains(&Some(Motion::Periodic(4))), "{motions:?}");
}

/// A van der Pol oscillator forced beside the range in which it follows.
#[test]
fn what_does_not_follow_the_forcing_is_quasi_periodic() {
    let terms = vec![Term { power: 1, coefficient: -0.25 }, Term { power: 3, coefficient: 0.1 }];
    let model = Model::builder("van der Pol")
        .mass([[1.0]])
        .stiffness([[1.0]])
        .damping_ratio(0.025)
        .force("x1", 1.0)
        .element("damper", LawKind::PolynomialDamper(PolynomialDamper { terms }), ["x1"])
        .monitor("x1")
        .build()
        .unwrap();
    let mut settings = Settings::default();
    (settings.frequency.min, settings.frequency.max) = (Some(1.2), Some(1.6));
    settings.continuation.max_step = 0.02;
    let branch = main_branch(&model, &settings, 0.3);
    let mut told = 0;
    for index in (1..branch.points.len() - 1).step_by(5) {
        let omega = branch.points[index].omega();
        let found = settled(&model, &[], &branch, index, omega);
        let law = move |t: f64, [x]: [f64; 1], [v]: [f64; 1]| [0.3 * (omega * t).cos() - x + v * (0.2 - 0.1 * v * v)];
        let (range, growth) = direct(&law, omega, [800, 400], start(&model, &branch, index, omega));
        println!("{omega} rad/s: {:?} {:?} {:?}, {range:?}, {growth}", found.motion, found.growth, found.amplitudes);
        if let Some(motion) = found.motion {
            assert_eq!(motion == Motion::QuasiPeriodic, growth.abs() < 0.01, "{omega} rad/s: {motion}");
            // Extremes depend on when one looks.
            assert_close(found.amplitudes[0][0], range[0], 0.03, "smallest amplitude, m");
            assert_close(found.amplitudes[0][1], range[1], 0.01, "largest amplitude, m");
            told += usize::from(motion == Motion::QuasiPeriodic);
        }
    }
    assert!(told > 3, "{told}");
}
