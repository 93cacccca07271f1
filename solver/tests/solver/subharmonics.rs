//! Isolas of sub-harmonic motion, against Newton's method on the equations of motion over a period of the response: of a Duffing
//! oscillator by Runge–Kutta integration, of a mass before an elastic stop by its exact piecewise linear motion.

use crate::support::fold_curves::{all, folds, quiet};
use crate::support::study::{Kind, Listed, Study, of_kind, shipped, with_harmonics};
use solver::laws::{PolynomialSpring, Term};
use solver::response::branch::Side;
use solver::response::folds::{Critical, CriticalKind, Extent, Quantity};
use solver::response::orders::Orders;
use solver::response::task::{Task, TaskResult, plan};
use solver::response::trace::{Given, execute};
use solver::settings::{HarmonicSettings, Quadrature, SearchSettings};
use solver::{Backbone, Forced, Model, NumberList, SearchRange, Settings, State};

/// Relative difference of frequencies.
const CLOSE: f64 = 1e-5;

/// Levels with their isola, if there is one, and the forcing at its birth.
fn check(name: &str, settings: Settings, levels: &[(f64, Option<(f64, f64)>)], birth: f64) {
    let study = Study::of_modes(shipped(name, &[]), settings);
    for &(forcing, range) in levels {
        let level = study.level(forcing);
        let what = format!("{name}, A = {forcing}: {level:#?}");
        let isolas = of_kind(&level, Kind::Isola);
        assert_eq!(isolas.len(), usize::from(range.is_some()), "{what}");
        let (Some((low, high)), Some(isola)) = (range, isolas.first()) else { continue };
        let found = isola.branch.frequency_range();
        assert!((found.0 / low - 1.0).abs() < CLOSE && (found.1 / high - 1.0).abs() < CLOSE, "{found:?}, {what}");
        let extent = Extent { forcing: (0.3 * birth, 3.0 * birth), frequency: (0.1, 5.0), points: 5000 };
        let mut critical = Critical::new(&study.model, &settings, Quantity::Frequency, extent).unwrap();
        let curve = critical.curve(&folds(&isola.branch)[0], &mut quiet).unwrap();
        let births = all(&curve, CriticalKind::Birth);
        assert!(births.iter().any(|found| (found / birth - 1.0).abs() < CLOSE), "{births:?}, {what}");
    }
}

fn settings(harmonics: usize, low: f64, high: f64) -> Settings {
    let mut settings = with_harmonics(harmonics);
    (settings.frequency.min, settings.frequency.max) = (Some(low), Some(high));
    settings
}

#[test]
fn a_duffing_oscillator_driven_at_three_times_its_frequency() {
    let levels =
        [(1.0, None), (1.5, Some((1.157_770_851, 1.408_625_575))), (2.0, Some((1.088_198_745, 1.780_832_447)))];
    check("duffing_subharmonic", settings(21, 0.2, 2.5), &levels, 1.417_402);
}

/// An order of motions has the isolas of the structure that is forced on its harmonic, and no motion of the force's own period.
#[test]
fn a_duffing_oscillator_has_an_order_of_three() {
    let mut settings = settings(21, 0.6, 7.5);
    settings.search.harmonics = NumberList::new(&[1, 3]);
    let model = shipped("duffing_subharmonic", &[]);
    let orders = Orders::of(&model, &settings);
    let order = orders.get(Some(3)).unwrap();
    let backbone = Backbone::compute(&order.model, &order.settings).unwrap();
    let (windows, tasks) = plan(&backbone, 1.5, &order.settings.frequency, 40);
    assert_eq!(windows.len(), 1);
    let reach = SearchRange::new(&order.settings, &backbone).unwrap();
    let alone = Settings { search: SearchSettings::default(), ..order.settings };
    let land = |settings: &Settings| {
        let mut forced = Forced::new(&order.model, settings, reach, 1.5);
        let starts = tasks.iter().filter(|task| matches!(task, Task::Start(_)));
        let landed = starts.filter_map(|task| match execute(&mut forced, task, &Given::default(), &mut quiet)? {
            TaskResult::Landings(landings) => Some(landings.into_iter().map(|landing| landing.state)),
            _ => None,
        });
        landed.flatten().collect::<Vec<State>>()
    };
    let is_shorter = |state: &&State| {
        let size = |k: usize| state.modal[2 * k - 1].hypot(state.modal[2 * k]);
        (1..=state.harmonics).filter(|k| k % 3 != 0).all(|k| size(k) < 1e-9 * size(3))
    };
    let (all, own) = (land(&alone), land(&order.settings));
    let shorter = all.iter().filter(is_shorter).count();
    assert!(shorter > 100 && all.len() > shorter, "{shorter} of {}", all.len());
    assert_eq!(own, all.into_iter().filter(|state| !is_shorter(&state)).collect::<Vec<_>>());
}

/// Samples are the same a period of the force later: an ordinary response before a stop is nothing of order 3, however it is integrated.
#[test]
fn samples_tell_orders_apart_as_well() {
    let mut settings = settings(15, 0.8, 5.4);
    settings.harmonics = HarmonicSettings { quadrature: Quadrature::Samples, samples: 128, ..settings.harmonics };
    settings.search.harmonics = NumberList::new(&[1, 3]);
    let model = shipped("stop_subharmonic", &[]);
    let orders = Orders::of(&model, &settings);
    let order = orders.get(Some(3)).unwrap();
    let reach = SearchRange { frequency: (0.27, 1.8), amplitude: 60.0, natural: None, forcing: None };
    let content = |settings: &Settings| {
        // What the ordinary response, converged from a motion of harmonics 3, 6, … has of others.
        let mut forced = Forced::new(&order.model, settings, reach, 0.7);
        let main = forced.main_branch(Side::Below, &mut quiet).unwrap();
        let share = |state: &State| {
            let size = |k: usize| state.modal[2 * k - 1].hypot(state.modal[2 * k]);
            let others = (1..=state.harmonics).filter(|k| k % 3 != 0).map(size).fold(0.0, f64::max);
            others / (1..=state.harmonics).map(size).fold(0.0, f64::max)
        };
        main.points.iter().map(|point| share(&point.state)).fold(0.0, f64::max)
    };
    let as_given = Settings { harmonics: settings.harmonics, ..order.settings };
    // Also with samples that are not: harmonics that such a motion cannot have are left out of its forces.
    assert!(content(&as_given) < 1e-9 && content(&order.settings) < 1e-9);
}

#[test]
fn a_mass_before_a_stop_driven_at_twice_its_frequency() {
    let levels = [
        (0.6, None),
        (0.7, Some((1.087_020_752, 1.164_294_307))),
        (0.8, Some((1.063_765_535, 1.196_722_430))),
        (1.0, Some((1.043_542_781, 1.230_087_607))),
    ];
    check("stop_subharmonic", settings(20, 0.8, 1.8), &levels, 0.656_993);
}

/// A mass on a spring that softens, then stiffens: its resonance leaves the frequencies of the study downwards, and comes back above the
/// ordinary response.
fn comes_back(harmonic: usize) -> Model {
    let terms = [(3, -0.428), (5, 0.0442)].map(|(power, coefficient)| Term { power, coefficient });
    Model::builder("softening, then stiffening")
        .mass([[1.304]])
        .stiffness([[1.657]])
        .damping_matrix([[1.685e-3]])
        .force("x1", 1.0)
        .harmonic(harmonic)
        .element("spring", PolynomialSpring { terms: terms.to_vec() }, [[("x1", 1.0)]])
        .build()
        .unwrap()
}

/// Motions with the period of the force have backbones in a study of twice that period as well: those of the structure forced on its first
/// harmonic, at half the frequency.
#[test]
fn a_resonance_with_the_period_of_the_force_is_found_among_motions_of_two_periods() {
    let one = Study::of_modes(comes_back(1), settings(5, 1.4, 5.4));
    let two = Study::of_modes(comes_back(2), settings(10, 0.7, 2.7));
    let highest = |study: &Study| {
        let level = study.level(0.0141);
        let peak = |listed: &Listed| listed.branch.peak().amplitude();
        let listed = level.into_iter().max_by(|a, b| peak(a).total_cmp(&peak(b))).unwrap();
        (listed.branch.frequency_range(), peak(&listed))
    };
    let (range, peak) = highest(&one);
    let (found, repeated) = highest(&two);
    assert!(peak > 3.5 && (peak / repeated - 1.0).abs() < 1e-8, "{peak}, {repeated}");
    assert!((2.0 * found.0 / range.0 - 1.0).abs() < 1e-8 && (2.0 * found.1 / range.1 - 1.0).abs() < 1e-8);

    let [own, shorter] = two.backbones[0].pieces().collect::<Vec<_>>()[..] else { panic!("two pieces") };
    assert!(own.iter().all(|point| point.threshold() > 1e6));
    assert_eq!(shorter.len(), one.backbones[0].points.len());
    for (at, of_one) in shorter.iter().zip(&one.backbones[0].points) {
        assert!((at.threshold() / of_one.threshold() - 1.0).abs() < 1e-12);
        assert!((2.0 * at.point.omega() / of_one.point.omega() - 1.0).abs() < 1e-15);
        assert!(at.energies().certificate < 1e-9, "{:?}", at.energies());
    }
    // What is looked for as an order of its own is left to that.
    let mut listed = two.settings;
    listed.search.harmonics = NumberList::new(&[1, 2]);
    let backbone = Backbone::reaching(&two.model, &listed, 0.0141, &mut quiet).unwrap();
    assert_eq!(backbone.pieces().count(), 1);
}
