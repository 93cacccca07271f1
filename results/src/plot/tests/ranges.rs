//! What of its axes a figure shows.

use super::{damper, sheet};
use crate::figure::Figures;
use crate::report::{Report, Selection};
use crate::store::Reader;

#[test]
fn axes_show_what_is_asked_of_them() {
    let dir = damper();
    let run = dir.path().join("run");
    let drawn = |options: &[&str]| sheet(&run, options).unwrap().figure.panels;
    let figure = drawn(&["--figure", "response", "--response", "0.1 0.4", "--frequency", "0.99 1.005"]);
    assert_eq!((figure[0].x[0].range, figure[0].y[0].range), ((0.99, 1.005), (0.1, 0.4)));
    // In the units of the axes.
    let figure =
        drawn(&["--figure", "response", "--response", "100 400", "--units", "mm,Hz", "--frequency", "0.15 0.17"]);
    let (low, high) = figure[0].y[0].range;
    assert!((low - 0.1).abs() < 1e-12 && (high - 0.4).abs() < 1e-12, "{low} {high}");
    assert!((figure[0].x[0].range.0 / (0.15 * std::f64::consts::TAU) - 1.0).abs() < 1e-12, "{:?}", figure[0].x[0]);
    assert_eq!(drawn(&["--figure", "map", "--forcing", "0.001 0.01"])[0].y[0].range, (0.001, 0.01));
    let figure =
        drawn(&["--figure", "resonance", "--forcing", "0.001 0.01", "--frequency", "0.9 1.1", "--response", "0.1 2"]);
    assert_eq!([0, 1].map(|panel| figure[panel].x[0].range), [(0.001, 0.01); 2]);
    assert_eq!([0, 1].map(|panel| figure[panel].y[0].range), [(0.9, 1.1), (0.1, 2.0)]);
    assert_eq!(drawn(&["--figure", "backbone", "--response", "0.1 2"])[0].y[0].range, (0.1, 2.0));
}

#[test]
fn what_is_no_range_is_refused() {
    let dir = damper();
    let run = dir.path().join("run");
    let error = |options: &[&str]| sheet(&run, options).unwrap_err();
    assert_eq!(
        error(&["--figure", "map", "--frequency", "2 1"]),
        "--frequency 2 1: the lowest and the highest frequency shown, in the unit of the axis, the first below the second"
    );
    assert_eq!(error(&["--figure", "map", "--forcing", "0 1"]), "--forcing 0 1: both ends have to be above zero");
    assert_eq!(
        error(&["--figure", "map", "--response", "0 1"]),
        "--response: not for the figure map, but for response, backbone, folds, resonance"
    );
    let elsewhere = error(&["--figure", "folds", "--frequency", "1 2"]);
    assert_eq!(elsewhere, "--frequency: not for the figure folds, but for response, map, backbone, resonance");
}

/// Levels that lie close together are told apart: what the balance predicts far below them is not shown.
#[test]
fn resonances_of_close_levels_stay_apart() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let along =
        |report: &Report| Figures::new(&report.subject()).drawn.remove("resonance").unwrap().panels[0].x[0].range;
    assert_eq!(along(&report).0, 0.0);
    for (level, value) in report.overview.levels.iter_mut().zip([0.0058, 0.006]) {
        level.value = value;
    }
    for curve in [&mut report.resonance.continuation, &mut report.resonance.isolas] {
        curve.value = vec![0.0058, 0.006];
    }
    let (low, high) = along(&report);
    assert!(low > 0.0045 && low < 0.0058 && high > 0.006, "{low} to {high}");
}
