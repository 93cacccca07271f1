//! Isolas of sub-harmonic motion, against Newton's method on the equations of motion over a period of the response: of a Duffing
//! oscillator by Runge–Kutta integration, of a mass before an elastic stop by its exact piecewise linear motion.

use crate::support::fold_curves::{all, folds, quiet};
use crate::support::study::{Kind, Study, of_kind, shipped, with_harmonics};
use solver::Settings;
use solver::response::folds::{Critical, CriticalKind, Extent, Quantity};

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
