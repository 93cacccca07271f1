//! Shipped models with several isolas. What is known of them comes from a harmonic balance that shares no code with the
//! solver, from thousands of random starts a level; shooting on the equations of motion meets it to 1e-5.

use crate::support::balance::Balance;
use crate::support::geometry::complaints;
use crate::support::study::{Kind, Study, main_peak, of_kind, own, shipped, why_unfinished, with_harmonics};
use solver::response::branch::{BranchPoint, Side, SpecialKind};
use solver::{CriticalCurve, CriticalKind, Forced, Model, Quantity, SearchRange, Settings, State};
use std::ops::ControlFlow;

/// An isola that is known, and a point near it.
struct Known {
    /// Forcing amplitude.
    forcing: f64,
    /// Lowest and highest frequency, rad/s.
    range: (f64, f64),
    /// Largest amplitude of the first dof, m.
    peak: f64,
    /// Whether windows of the backbones lead to it.
    has_window: bool,
    /// Frequency of the point, rad/s.
    near: f64,
    /// Displacements of the point, dof by dof: mean, cosine and sine of the first harmonic, of the second, …; m.
    series: Vec<Vec<f64>>,
}

/// Relative difference of frequencies and amplitudes.
const CLOSE: f64 = 2e-6;

fn quiet(_: &BranchPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn is_close(value: f64, expected: f64) -> bool {
    (value / expected - 1.0).abs() < CLOSE
}

impl Known {
    /// Harmonics of Σ weight · displacement.
    fn combined(&self, count: usize, weights: impl Iterator<Item = (usize, f64)> + Clone) -> Vec<f64> {
        let at = |dof: usize, place: usize| self.series[dof].get(place).copied().unwrap_or(0.0);
        (0..=2 * count).map(|place| weights.clone().map(|(dof, weight)| weight * at(dof, place)).sum()).collect()
    }

    /// The point as a state: q = Φᵀ M x.
    fn state(&self, model: &Model, count: usize) -> State {
        let left = model.modes().shapes.transpose().matmul(model.mass());
        let modal = (0..model.size()).flat_map(|j| self.combined(count, left.row(j).iter().copied().enumerate()));
        let channels = model.elements().iter().flat_map(|element| &element.channels);
        let arguments = channels.flat_map(|channel| self.combined(count, channel.iter().copied()));
        State {
            harmonics: count,
            omega: self.near,
            decay: 0.0,
            forcing: self.forcing,
            arguments: arguments.collect(),
            modal: modal.collect(),
        }
    }

    /// The branch through the point is the isola.
    fn assert_there(&self, model: &Model, settings: &Settings) {
        let reach = SearchRange { frequency: (0.5, 2.5), amplitude: 10.0, natural: None, forcing: None };
        let mut forced = Forced::new(model, settings, reach, self.forcing);
        let what = format!("A = {}, {:?}", self.forcing, self.range);
        let start = forced.converge(&self.state(model, settings.harmonics.count));
        let start = start.unwrap_or_else(|failure| panic!("{what}: {failure}"));
        let branch = forced.branch_through(&start, &mut quiet).unwrap_or_else(|failure| panic!("{what}: {failure}"));
        let (low, high) = branch.frequency_range();
        let numbers = (low, high, branch.peak().amplitude());
        assert!(branch.is_closed(), "{what}: {numbers:?}, {}", branch.outcome);
        assert!(self.is(numbers), "{what}: {numbers:?}, not {}", self.peak);
        let balance = Balance::new(model);
        let worst =
            branch.points.iter().step_by(5).map(|point| balance.residual(&point.state).relative()).fold(0.0, f64::max);
        assert!(worst < 1e-7, "{what}: {worst:e}");
    }

    /// Whether it has these frequencies and this peak.
    fn is(&self, (low, high, peak): (f64, f64, f64)) -> bool {
        is_close(low, self.range.0) && is_close(high, self.range.1) && is_close(peak, self.peak)
    }
}

/// Every isola is there; levels list nothing else beside a whole main branch, and all that windows lead to.
fn check(model: Model, settings: Settings, mains: &[(f64, f64)], isolas: &[Known]) {
    let study = Study::of_modes(model, settings);
    for isola in isolas {
        isola.assert_there(&study.model, &settings);
    }
    for &(forcing, peak) in mains {
        let level = study.level(forcing);
        let what = format!("A = {forcing}: {level:#?}");
        assert_eq!(complaints(&study.model, &level), Vec::<String>::new(), "{what}");
        assert!(of_kind(&level, Kind::Main).iter().all(|main| why_unfinished(&main.branch).is_none()), "{what}");
        assert!((main_peak(&level).1 / peak - 1.0).abs() < 1e-5, "{what}");
        let mut found = Vec::new();
        for listed in level.iter().filter(|listed| listed.kind != Kind::Main) {
            let ((low, high), peak) = (listed.branch.frequency_range(), listed.branch.peak().amplitude());
            let known = isolas.iter().position(|isola| isola.forcing == forcing && isola.is((low, high, peak)));
            assert!(
                listed.kind == Kind::Isola && known.is_some_and(|i| !found.contains(&i)),
                "{}: {what}",
                listed.name
            );
            found.extend(known);
        }
        let of_level = isolas.iter().enumerate().filter(|(_, isola)| isola.forcing == forcing && isola.has_window);
        for (i, isola) in of_level {
            assert!(found.contains(&i), "not {:?}: {what}", isola.range);
        }
    }
}

/// One harmonic without a mean.
fn first(cosine: f64, sine: f64) -> Vec<f64> {
    vec![0.0, cosine, sine]
}

#[test]
fn both_modes_of_two_masses_with_dampers() {
    let isola = |forcing, range, peak, near, series| Known { forcing, range, peak, has_window: true, near, series };
    // In phase; in opposition, the first of these 0.18 % wide.
    let isolas = [
        isola(0.05, (0.9958826, 1.00394848), 2.209503, 0.9996, vec![first(0.15, 2.204), first(0.15, 2.204)]),
        isola(0.068, (0.99272293, 1.00712467), 2.3186366, 0.9992, vec![first(0.22, 2.306), first(0.22, 2.306)]),
        isola(0.08, (0.99077183, 1.00909547), 2.3697112, 0.999, vec![first(0.27, 2.351), first(0.27, 2.351)]),
        isola(0.068, (1.73048151, 1.73351286), 1.1756313, 1.7319, vec![first(0.014, 1.175), first(-0.014, -1.175)]),
        isola(0.08, (1.72638544, 1.73762044), 1.2676876, 1.7322, vec![first(-0.02, 1.267), first(0.02, -1.267)]),
        isola(0.1, (1.72226828, 1.74176407), 1.3348455, 1.7326, vec![first(-0.06, 1.331), first(0.06, -1.331)]),
    ];
    let mains = [
        (0.03, 0.2132304),
        (0.05, 0.3690304),
        (0.068, 0.5350089),
        (0.08, 0.6803762),
        (0.1, 2.4378762),
        (0.11, 2.466945),
    ];
    check(shipped("two_dampers", &[]), with_harmonics(5), &mains, &isolas);
}

#[test]
fn isolas_of_a_blade_on_the_isola_of_another() {
    let isola = |forcing, range, peak, near, series| Known { forcing, range, peak, has_window: true, near, series };
    let off_backbones = |isola| Known { has_window: false, ..isola };
    let isolas = [
        // Of the first blade.
        isola(0.03, (1.14399959, 1.24595466), 1.9294598, 1.24566, vec![first(0.0181, 1.9), first(-0.172, 0.1162)]),
        isola(0.034, (1.13056254, 1.25167079), 1.9543875, 1.25127, vec![first(0.031, 1.9239), first(-0.1865, 0.1141)]),
        isola(0.04, (1.10848124, 1.25877733), 1.9850626, 1.25817, vec![first(0.0606, 1.9527), first(-0.2069, 0.1137)]),
        // Of the second, with the first on the main branch,
        isola(0.034, (1.19948837, 1.20203448), 0.0779542, 1.1995, vec![first(-0.0776, 0.0079), first(0.2403, 1.6214)]),
        isola(0.04, (1.19522731, 1.20631302), 0.0965145, 1.1954, vec![first(-0.0957, 0.0127), first(0.8921, 1.3895)]),
        isola(0.05, (1.19111009, 1.21047081), 0.1238521, 1.1914, vec![first(-0.1223, 0.0197), first(1.2182, 1.1097)]),
        // on the upper side of its isola,
        off_backbones(isola(
            0.034,
            (1.19682482, 1.20466081),
            1.7724611,
            1.20466,
            vec![first(1.362, 1.0959), first(-0.7504, 1.427)],
        )),
        off_backbones(isola(
            0.04,
            (1.19378123, 1.20775607),
            1.7930886,
            1.207741,
            vec![first(1.4901, 0.9515), first(-1.0006, 1.1905)],
        )),
        // and on the lower side, which belongs to the main branch at 0.05.
        off_backbones(isola(
            0.04,
            (1.19671941, 1.20476253),
            1.7025488,
            1.20476,
            vec![first(-1.5359, 0.6833), first(-0.7335, 1.4376)],
        )),
        off_backbones(isola(
            0.05,
            (1.19216587, 1.20931556),
            1.7125347,
            1.20931,
            vec![first(-1.5924, 0.5684), first(-1.0803, 1.1049)],
        )),
    ];
    let mains = [(0.015, 0.2125271), (0.03, 0.4507629), (0.034, 0.5258399), (0.04, 0.661853), (0.05, 2.0256593)];
    check(shipped("two_blades", &[]), with_harmonics(5), &mains, &isolas);
}

#[test]
fn folds_of_a_main_branch_lead_to_isolas_on_the_lower_side_of_another() {
    // At A = 0.06 all isolas of the second blade have merged with the main branch: its folds know them. Random starts find
    // none on the lower side at 0.036 and 0.06, and one at 0.04 and 0.056.
    let (model, settings) = (shipped("two_blades", &[]), with_harmonics(5));
    let reach = SearchRange { frequency: (0.8, 2.0), amplitude: 10.0, natural: None, forcing: Some((0.01, 0.1)) };
    let mut forced = Forced::new(&model, &settings, reach, 0.06);
    let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
    let mut critical = forced.extrema(Quantity::Frequency).unwrap();
    let mut curves: Vec<CriticalCurve> = Vec::new();
    for fold in main.special(SpecialKind::Fold) {
        if !curves.iter().any(|curve| critical.lies_on(&fold.state, curve)) {
            curves.push(critical.curve(&fold.state, &mut quiet).unwrap());
        }
    }
    // Blade 1; blade 2 with it on the upper side, on the lower one and on the main branch.
    let known = [(0.01816674, 0.04576322), (0.03082641, 0.04980816), (0.03645212, 0.05614806), (0.0336271, 0.05327719)];
    for (birth, merge) in known {
        let has = |curve: &CriticalCurve, kind, forcing| {
            curve.events(kind).any(|point: &BranchPoint| is_close(point.state.forcing, forcing))
        };
        let is =
            |curve: &&CriticalCurve| has(curve, CriticalKind::Birth, birth) && has(curve, CriticalKind::Merge, merge);
        let [curve] = curves.iter().filter(is).collect::<Vec<_>>()[..] else { panic!("{birth} to {merge}") };
        if birth == 0.03645212 {
            let mut found = critical.crossings(curve, 0.04).into_iter().map(Result::unwrap);
            let state = found.find(|state| is_close(state.omega, 1.19671941)).unwrap();
            let isola = Forced::new(&model, &settings, reach, 0.04).branch_through(&state, &mut quiet).unwrap();
            assert!(isola.is_closed() && is_close(isola.frequency_range().1, 1.20476253), "{}", isola.outcome);
        }
    }
}

#[test]
fn two_isolas_of_one_mode() {
    let isola = |forcing, range, peak, near, series| Known { forcing, range, peak, has_window: true, near, series };
    let isolas = [
        isola(0.0138, (1.03641759, 1.0467803), 2.0662091, 1.042, vec![first(0.3714, 1.9289)]),
        isola(0.0145, (1.03185866, 1.05220461), 2.1857167, 1.042, vec![first(0.6985, 1.851)]),
        isola(0.0145, (1.09362671, 1.10267191), 3.1087551, 1.098, vec![first(0.7806, 2.9184)]),
        isola(0.016, (1.02593933, 1.06080116), 2.3645789, 1.043, vec![first(1.0537, 1.7217)]),
        isola(0.016, (1.08619709, 1.10614224), 3.1631837, 1.096, vec![first(1.4268, 2.6372)]),
        isola(0.017, (1.02276041, 1.06771242), 2.5005666, 1.045, vec![first(1.2036, 1.6847)]),
        isola(0.017, (1.08002331, 1.1075621), 3.1851304, 1.094, vec![first(1.6168, 2.492)]),
        // One curve that was two.
        isola(0.018, (1.0197261, 1.10870636), 3.2026668, 1.064, vec![first(0.9144, 2.2645)]),
    ];
    let mains = [
        (0.013, 0.431962),
        (0.0138, 0.4653099),
        (0.0145, 0.4960537),
        (0.016, 0.568588),
        (0.017, 0.6243407),
        (0.018, 0.6901011),
        (0.021, 3.24189),
    ];
    check(shipped("damper_two_isolas", &[]), with_harmonics(7), &mains, &isolas);
}

#[test]
fn the_second_mode_of_a_chain_at_half_the_frequency_of_the_force() {
    let isola = |forcing, range, peak, near, series| Known { forcing, range, peak, has_window: true, near, series };
    let isolas = [
        isola(
            1.75,
            (1.30889815, 1.33029344),
            2.4426446,
            1.3212423,
            vec![
                vec![-0.366, -1.581, -0.839, -0.378, 0.142, 0.03, -0.021, -0.014, -0.004],
                vec![-0.366, -0.918, -0.641, 0.076, -0.035, -0.002, 0.002],
                vec![-0.366, 1.304, 0.738, -0.013, 0.006],
            ],
        ),
        isola(
            2.0,
            (1.28941975, 1.35242304),
            3.1806445,
            1.3163461,
            vec![
                vec![-0.371, -1.844, -0.565, -0.391, 0.141, 0.016, -0.032, -0.012, 0.005],
                vec![-0.371, -1.078, -0.479, 0.08, -0.036, -0.001, 0.002],
                vec![-0.371, 1.523, 0.51, -0.013, 0.006],
            ],
        ),
        isola(
            2.25,
            (1.28075016, 1.36314487),
            3.749906,
            1.3132887,
            vec![
                vec![-0.371, -1.963, -0.416, -0.429, 0.136, 0.008, -0.033, -0.009, 0.007],
                vec![-0.371, -1.145, -0.391, 0.088, -0.035, 0.0, 0.003],
                vec![-0.371, 1.621, 0.385, -0.015, 0.006],
            ],
        ),
    ];
    let mut settings = with_harmonics(20);
    (settings.frequency.min, settings.frequency.max) = (Some(1.1), Some(1.8));
    // The linear response at the lower bound.
    let mains = [(1.5, 0.609534), (1.75, 0.711123), (2.0, 0.812712), (2.25, 0.914302)];
    check(shipped("chain_subharmonic", &[]), settings, &mains, &isolas);
}

#[test]
fn the_second_mode_of_a_chain_whose_third_mode_is_driven() {
    // The shape of the second mode is orthogonal to the force, which works on the second harmonic of the motion all the
    // same.
    let isola = |forcing, range, peak, near, series| Known { forcing, range, peak, has_window: true, near, series };
    let isolas = [
        isola(
            2.5,
            (1.29367514, 1.34371755),
            2.8446838,
            1.3149526,
            vec![
                vec![-0.347, -1.743, -0.611, -0.382, 0.143, 0.019, -0.029, -0.012, 0.003],
                vec![-0.347, -1.007, -0.496, 0.495, -0.051, -0.001, 0.002],
                vec![-0.347, 1.436, 0.544, -0.222, 0.016],
            ],
        ),
        isola(
            3.0,
            (1.27895553, 1.36212512),
            3.694197,
            1.3160396,
            vec![
                vec![-0.395, -2.009, -0.414, -0.423, 0.148, 0.007, -0.035, -0.009, 0.008],
                vec![-0.395, -1.187, -0.399, 0.585, -0.056, 0.0, 0.003],
                vec![-0.395, 1.663, 0.387, -0.264, 0.018],
            ],
        ),
    ];
    let mut settings = with_harmonics(20);
    (settings.frequency.min, settings.frequency.max) = (Some(1.1), Some(1.8));
    let model = shipped("chain_subharmonic", &[("forcing.shape", "{ mode = 3 }")]);
    check(model, settings, &[(2.0, 0.738349), (2.5, 0.922936), (3.0, 1.189334)], &isolas);
}

#[test]
fn a_mode_that_is_orthogonal_to_the_force() {
    let isola = |forcing, range, peak, near, series| Known { forcing, range, peak, has_window: true, near, series };
    let isolas = [
        isola(0.4, (1.81269888, 1.83027075), 1.285022, 1.8297, vec![first(0.0646, 1.2733), first(-0.2848, -0.938)]),
        isola(0.6, (1.78524909, 1.86290465), 1.4525039, 1.861, vec![first(-0.0327, 1.4385), first(-0.2919, -0.9779)]),
    ];
    check(own("orthogonal_forcing"), with_harmonics(5), &[(0.4, 1.7181283), (0.6, 1.7848925)], &isolas);
}
