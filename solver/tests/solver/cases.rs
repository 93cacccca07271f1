//! Models on which something false was said once, or something missed, and what is true of them.

use crate::support::balance::{Balance, Matrices};
use crate::support::geometry::{Curve, complaints};
use crate::support::linear::response;
use crate::support::study::{
    Kind, Listed, Study, assert_main_only, main_peak, of_kind, own, shipped, why_unfinished, with_harmonics,
};
use solver::laws::Law;
use solver::{BranchPoint, ModeChoice, Model, Settings};

/// Every point fulfils the balance to `relative` of its largest term, no curve hops, comes twice or is said to be closed
/// without being it, and no response of a structure that nothing acts on (the linear one) is said to be detached.
fn assert_sound(model: &Model, level: &[Listed], relative: f64, what: &str) {
    let balance = Balance::new(model);
    for listed in level {
        for point in &listed.branch.points {
            let (name, omega, share) = (&listed.name, point.omega(), balance.residual(&point.state).relative());
            assert!(share < relative, "{what}, {name} at {omega} rad/s: {share:e}");
            let is_linear = listed.kind != Kind::Main && balance.is_free(&point.state);
            assert!(!is_linear, "{what}, {name} at {omega} rad/s is the linear response: {level:#?}");
        }
    }
    assert_eq!(complaints(model, level), Vec::<String>::new(), "{what}: {level:#?}");
}

fn within(settings: Settings, min: f64, max: f64) -> Settings {
    let mut settings = settings;
    (settings.frequency.min, settings.frequency.max) = (Some(min), Some(max));
    settings
}

fn assert_close(value: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((value - expected).abs() < tolerance, "{what}: {value} is not {expected} to {tolerance:e}");
}

#[test]
fn a_sheet_near_another_is_not_a_curve_that_closes() {
    let mut settings = within(with_harmonics(3), 0.9, 1.1);
    (settings.backbone.modes, settings.backbone.max_amplitude) = (ModeChoice::one(2), Some(3.0));
    let study = Study::new(own("coupled_masses"), settings);
    let level = study.level(0.04);
    assert_sound(&study.model, &level, 1e-7, "coupled masses");
    // The damper alone has an isola at this forcing, with velocities above 2.
    let detached = level.iter().filter(|listed| listed.kind != Kind::Main);
    assert!(detached.map(|listed| listed.branch.peak().amplitude()).any(|a| a > 2.0), "{level:#?}");
}

#[test]
fn a_backbone_that_ends_early_bounds_no_response() {
    let study = Study::new(own("chain_stop"), within(with_harmonics(20), 0.2, 2.8));
    let level = study.level(0.3);
    assert_sound(&study.model, &level, 1e-7, "chain before a stop");
    let (omega, peak) = main_peak(&level);
    assert_close(peak, 15.766, 2e-3, "peak");
    assert_close(omega, 1.33793, 1e-4, "frequency of the peak");
}

#[test]
fn three_masses_with_friction_cubic_springs_and_a_stop() {
    let mut settings = within(with_harmonics(7), 0.5, 2.0);
    settings.harmonics.samples = 1024;
    let study = Study::new(own("three_masses"), settings);
    let level = study.level(1.0);
    // The slider's force is known at samples only: 1024 here, more in the balance that checks.
    assert_sound(&study.model, &level, 1e-4, "three masses");
    let (omega, peak) = main_peak(&level);
    assert_close(peak, 0.287, 5e-4, "peak of q1");
    assert_close(omega, 1.632, 2e-3, "frequency of the peak of q1");
    // Of the vibration. Sliders rest where their history has left them, which a periodic motion does not tell: means, and a
    // little of the rest, depend on what is taken for the beginning.
    for (dof, expected) in [0.16726, 0.20625, 0.69868].into_iter().enumerate() {
        let rms = |point: &BranchPoint| {
            let series = point.state.displacement(&study.model, dof);
            (0.5 * series[1..].iter().map(|c| c * c).sum::<f64>()).sqrt()
        };
        let points = of_kind(&level, Kind::Main).into_iter().flat_map(|listed| &listed.branch.points);
        let largest = points.map(rms).fold(0.0, f64::max);
        assert_close(largest, expected, 1e-2 * expected, &format!("largest rms of q{}", dof + 1));
    }
}

/// What the tests of whole levels look for is found where it is.
#[test]
fn a_branch_shares_a_stretch_with_itself_alone() {
    let study = Study::new(shipped("duffing", &[]), with_harmonics(5));
    let [low, high] = [0.05, 0.06].map(|forcing| {
        let level = study.level(forcing);
        Curve::of(&study.model, &of_kind(&level, Kind::Main)[0].branch)
    });
    assert!(low.shares_a_stretch_of(&low) && !low.shares_a_stretch_of(&high) && !high.shares_a_stretch_of(&low));
}

#[test]
fn the_flank_of_a_resonance_is_not_a_detached_response() {
    let study = Study::new(own("beam_stop"), with_harmonics(20));
    for forcing in [0.5, 1.0] {
        let level = study.level(forcing);
        assert_sound(&study.model, &level, 1e-7, &format!("beam before a stop, A = {forcing}"));
        for listed in of_kind(&level, Kind::Main) {
            assert_eq!(why_unfinished(&listed.branch), None, "A = {forcing}: {level:#?}");
        }
    }
}

#[test]
fn what_a_frequency_bound_cuts_off_a_main_branch_is_main() {
    for forcing in [0.02, 0.05, 0.1] {
        let mut settings = with_harmonics(5);
        settings.frequency.min = Some(1.15);
        let study = Study::new(shipped("duffing", &[]), settings);
        let level = study.level(forcing);
        assert_main_only(&level, &format!("A = {forcing}"));
        assert_sound(&study.model, &level, 1e-7, &format!("A = {forcing}"));
        // The same as without the bound.
        let whole = Study::new(shipped("duffing", &[]), with_harmonics(5)).level(forcing);
        let (peak, expected) = (main_peak(&level).1, main_peak(&whole).1);
        assert_close(peak, expected, 1e-6 * expected, &format!("A = {forcing}: peak"));
    }
}

#[test]
fn seeds_lead_to_nothing_beyond_the_range_of_the_study() {
    // Newton's method with ω free strays far from seeds next to the linear range, where the amplitude is small.
    let mut settings = with_harmonics(7);
    settings.backbone.max_amplitude = Some(2.5);
    let study = Study::new(shipped("duffing", &[]), settings);
    for forcing in [0.01, 0.05, 0.1] {
        let level = study.level(forcing);
        assert_main_only(&level, &format!("A = {forcing}"));
        assert_eq!(level.len(), 1, "A = {forcing}: {level:#?}");
    }
}

#[test]
fn what_a_frequency_bound_cuts_off_a_blade_is_main() {
    let mut settings = Settings::default();
    settings.frequency.max = Some(2700.0);
    let study = Study::new(shipped("rotor67", &[("contact.friction", "0")]), settings);
    let level = study.level(140.0);
    let false_isola = |listed: &&Listed| {
        let (low, high) = listed.branch.frequency_range();
        listed.kind != Kind::Main && low < 2700.0 && high > 2389.0
    };
    assert!(!level.iter().any(|listed| false_isola(&listed)), "{level:#?}");
}

#[test]
fn an_absorber_whose_isola_has_merged() {
    let study = Study::new(shipped("nltva", &[]), Settings::default());
    let level = study.level(0.19);
    assert_sound(&study.model, &level, 1e-7, "absorber, A = 0.19");
    let (omega, peak) = main_peak(&level);
    assert_close(peak, 2.97, 5e-3, "peak");
    assert_close(omega, 2.7351, 1e-3, "frequency of the peak");
}

#[test]
fn an_absorber_whose_isola_is_not_born_or_apart() {
    let study = Study::new(shipped("nltva", &[]), Settings::default());
    assert_main_only(&study.level(0.12), "absorber, A = 0.12");
    // Here there is an isola; whatever is listed beside the main branch must be it.
    for (forcing, low, high) in [(0.15, 1.58329571, 2.30378026), (0.18, 1.4926721, 2.6374968)] {
        let what = format!("absorber, A = {forcing}");
        let level = study.level(forcing);
        assert_sound(&study.model, &level, 1e-7, &what);
        assert!(main_peak(&level).1 < 1.5, "{what}: {level:#?}");
        for listed in level.iter().filter(|listed| listed.kind != Kind::Main) {
            assert_eq!(listed.kind, Kind::Isola, "{what}: {level:#?}");
            let (from, to) = listed.branch.frequency_range();
            assert_close(from, low, 1e-6, &what);
            assert_close(to, high, 1e-6, &what);
        }
    }
}

#[test]
fn a_stop_that_the_mode_followed_never_meets() {
    let study = Study::new(own("second_mode_stop"), within(with_harmonics(20), 1.2, 3.2));
    for forcing in [0.5, 0.8, 1.0] {
        let what = format!("A = {forcing}");
        let level = study.level(forcing);
        assert_sound(&study.model, &level, 1e-7, &what);
        assert!(!of_kind(&level, Kind::Main).is_empty(), "{what}: {level:#?}");
        // Isolas of the second mode, from 0.8 on; no others.
        for listed in level.iter().filter(|listed| listed.kind != Kind::Main) {
            let known = match forcing {
                0.8 => (2.38707, 2.61550),
                1.0 => (2.25195, 2.82043),
                _ => panic!("{what}: {level:#?}"),
            };
            let (low, high) = listed.branch.frequency_range();
            assert_close(low, known.0, 1e-4, &what);
            assert_close(high, known.1, 1e-4, &what);
        }
    }
}

#[test]
fn isolas_of_a_further_mode_are_found() {
    let study = Study::of_modes(own("second_mode_stop"), within(with_harmonics(20), 1.2, 3.2));
    assert_eq!(study.backbones.iter().map(|backbone| backbone.mode).collect::<Vec<usize>>(), [0, 1, 2]);
    for (forcing, known) in [(0.5, None), (0.8, Some((2.38707, 2.61550))), (1.0, Some((2.25195, 2.82043)))] {
        let what = format!("A = {forcing}");
        let level = study.level(forcing);
        assert_sound(&study.model, &level, 1e-7, &what);
        let others = || level.iter().filter(|listed| listed.kind != Kind::Main);
        assert!(others().all(|listed| listed.kind == Kind::Isola), "{what}: {level:#?}");
        assert_eq!(others().count(), known.iter().count(), "{what}: {level:#?}");
        for (listed, known) in others().zip(known) {
            let (low, high) = listed.branch.frequency_range();
            assert_close(low, known.0, 1e-5, &what);
            assert_close(high, known.1, 1e-5, &what);
        }
    }
}

#[test]
fn friction_that_sticks_is_a_spring() {
    let model = shipped("friction_mass", &[]);
    let laws: Vec<(f64, f64)> =
        model.elements().iter().map(|e| (e.law.stiffness_bound(), e.law.damping_bound())).collect();
    // Below its limit the Jenkins element on x1 is a spring of 1 N/m; rubbing on x2 far below v₀ a damper F/v₀.
    assert_eq!(laws, [(1.0, 0.0), (0.0, 2.0)]);
    let mut matrices = Matrices::of(&model);
    matrices.stiffness[(0, 0)] += 1.0;
    matrices.damping[(1, 1)] += 2.0;
    let study = Study::new(model, Settings::default());
    for forcing in [1e-4, 1e-5, 1e-6] {
        let what = format!("A = {forcing:e}");
        let level = study.level(forcing);
        assert_main_only(&level, &what);
        assert_sound(&study.model, &level, 1e-6, &what);
        let force: Vec<f64> = study.model.forcing().shape.iter().map(|s| forcing * s).collect();
        for point in level.iter().flat_map(|listed| &listed.branch.points) {
            let exact = response(&matrices, &force, point.omega())[0].norm();
            // tanh z = z − z³/3, with velocities of A at most.
            let tolerance = 1e-6 + (forcing / 0.01).powi(2);
            let expected = format!("{what}, {} rad/s", point.omega());
            assert_close(point.amplitude() / exact, 1.0, tolerance, &expected);
        }
    }
}

#[test]
fn a_curve_that_closes_is_no_main_branch_though_a_growing_forcing_leads_to_it() {
    let mut settings = Settings::default();
    settings.backbone.modes = ModeChoice::one(2);
    let study = Study::new(own("energy_sink"), settings);
    // Far below the resonances, in the range of frequencies that is given.
    let wide = Study::new(own("energy_sink"), within(settings, 0.2, 1.6));
    for forcing in [0.19, 0.195] {
        let (level, known) = (study.level(forcing), wide.level(forcing));
        assert_sound(&study.model, &level, 1e-7, "energy sink");
        let (mains, isolas) = (of_kind(&level, Kind::Main), of_kind(&level, Kind::Isola));
        assert_eq!((mains.len(), why_unfinished(&mains[0].branch)), (1, None), "{level:#?}");
        assert!((main_peak(&level).1 / main_peak(&known).1 - 1.0).abs() < 1e-6, "{level:#?}");
        let ranges = |list: &[&Listed]| list.iter().map(|listed| listed.branch.frequency_range()).collect::<Vec<_>>();
        let expected = ranges(&of_kind(&known, Kind::Isola));
        assert_eq!(isolas.len(), 1, "{level:#?}");
        let (found, (low, high)) = (ranges(&isolas)[0], expected[0]);
        assert_close(found.0, low, 1e-6, "lower end");
        assert_close(found.1, high, 1e-6, "upper end");
        // Beyond bounds that are given it is none of the study's, and the main branch is the same.
        let above = Study::new(own("energy_sink"), within(settings, 0.9, 1.6)).level(forcing);
        assert_main_only(&above, "above the isola");
        assert!((main_peak(&above).1 / main_peak(&known).1 - 1.0).abs() < 1e-6, "{above:#?}");
    }
}

#[test]
fn folds_beyond_bounds_that_nobody_gave_belong_to_a_main_branch() {
    let mut settings = Settings::default();
    settings.backbone.modes = ModeChoice::one(2);
    let folds = |settings: Settings, above: f64| {
        let level = Study::new(own("energy_sink"), settings).level(0.14);
        let main = &of_kind(&level, Kind::Main)[0].branch;
        let omegas: Vec<f64> = main.folds().map(|fold| main.points[fold].omega()).filter(|at| *at > above).collect();
        (main.frequency_range().0, omegas)
    };
    let (lowest, found) = folds(settings, 0.0);
    let (_, expected) = folds(within(settings, 0.1, 4.4), lowest);
    // Two of them lie below nine tenths of the backbone's lowest frequency.
    assert_eq!(expected.iter().filter(|at| **at < 0.89).count(), 2, "{expected:?}");
    assert_eq!(found.len(), expected.len(), "{found:?}, {expected:?}");
    for (found, expected) in found.iter().zip(&expected) {
        assert_close(*found, *expected, 1e-6, "fold");
    }
}
