//! What legends explain.

use super::damper;
use crate::curves::{Curve, Peak, Touch};
use crate::figure::{Figures, Series, Shape, Style};
use crate::fixture::Study;
use crate::overview::{BranchRow, Level};
use crate::report::{Report, Selection};
use crate::store::{CurvePoint, CurveRow, Reader, WindowOutcome};
use tempfile::tempdir;

/// Cusps have marks in figures of fold curves and in the map, and labels with a number that is one with twice the harmonics are explained.
#[test]
fn marks_of_fold_curves_are_explained() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let point = |forcing, event: Option<&str>, doubled| CurvePoint {
        forcing,
        omega: 1.0,
        amplitude: 1.0,
        event: event.map(String::from),
        doubled,
    };
    let mut legends = |doubled| {
        let points =
            vec![point(4e-3, Some("birth"), doubled), point(5e-3, Some("cusp"), None), point(4.5e-3, None, None)];
        report.curves = vec![CurveRow { points, ..CurveRow::default() }];
        let mut drawn = Figures::new(&report.subject()).drawn;
        ["folds", "map"].map(|name| {
            let figure = drawn.remove(name).unwrap();
            let labels: Vec<String> = figure.panels[0].labels.iter().map(|label| label.text.clone()).collect();
            (figure.legend.iter().map(|entry| entry.text.clone()).collect::<Vec<_>>(), labels)
        })
    };
    for (legend, labels) in legends(None) {
        assert!(legend.iter().any(|text| text == "births, computed; 2H: with twice the harmonics"), "{legend:?}");
        assert!(legend.iter().any(|text| text == "cusps, computed (two folds meet)"), "{legend:?}");
        assert!(
            labels.iter().any(|text| text == "born at 4e-3 (2H: not found)" || text == "born at 0.004 (2H: not found)"),
            "{labels:?}"
        );
        assert!(!labels.iter().any(|text| text.contains("cusp")), "{labels:?}");
    }
    for (legend, _) in legends(Some((4e-3, 1.0))) {
        assert!(legend.iter().any(|text| text == "births, computed"), "{legend:?}");
    }
}

/// Of many levels not all have room for a label: which colours they have is in the legend.
#[test]
fn colours_of_many_levels_are_in_the_legend() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let legend = |report: &Report| {
        let figure = Figures::new(&report.subject()).drawn.remove("response").unwrap();
        figure.legend.into_iter().map(|entry| entry.text).collect::<Vec<_>>()
    };
    assert!(!legend(&report).iter().any(|text| text.contains("lowest")));
    let (level, branch) = (report.overview.levels[1].clone(), report.branches[0].clone());
    for (k, amplitude) in (2..).zip(["0.007", "0.008", "0.009", "0.010"]) {
        report.overview.levels.push(Level { amplitude: amplitude.into(), ..level.clone() });
        report.branches.push(Curve { level: k, ..branch.clone() });
    }
    let told = legend(&report);
    assert_eq!(told[..2], ["A = 3e-3, the lowest of 6 levels", "A = 0.010, the highest of 6 levels"]);
}

/// One's solid line would fill the other's dashes.
#[test]
fn curves_that_lie_on_each_other_are_drawn_once() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let isola = report.branches.iter().find(|branch| branch.kind == "isola").unwrap().clone();
    let alone = Figures::new(&report.subject()).drawn.remove("response").unwrap().panels.remove(0);
    report.branches.push(Curve { number: 2, name: "isola 2".into(), ..isola });
    let panel = Figures::new(&report.subject()).drawn.remove("response").unwrap().panels.remove(0);
    let isolas: Vec<&str> =
        panel.labels.iter().map(|label| label.text.as_str()).filter(|t| t.contains("isola")).collect();
    assert_eq!(isolas, ["isola 1 and 2, A = 0.006"]);
    let is_named = |series: &Series| series.name.first().is_some_and(|name| name == "A = 0.006, isola 1 and 2");
    assert_eq!(panel.series.iter().filter(|series| is_named(series)).count(), 1);
    // Neither are its marks and gaps; it can be selected all the same.
    let (drawn, hidden): (Vec<&Series>, Vec<&Series>) = panel.series.iter().partition(|series| series.is_drawn(0));
    assert_eq!(drawn.len(), alone.series.len());
    assert!(hidden.len() > 1 && hidden.iter().any(|series| series.branch == Some(report.branches.len() - 1)));
}

/// What is not known of main branches alone is drawn as thin in the legend as they are in the figure.
#[test]
fn samples_are_as_thin_as_what_they_stand_for() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let unknown = |report: &Report| {
        let figure = Figures::new(&report.subject()).drawn.remove("response").unwrap();
        let width = |text: &str| figure.legend.iter().find(|entry| entry.text == text).unwrap().style.width;
        [width("main branch"), width("isola"), width("stability not known")]
    };
    for branch in &mut report.branches {
        branch.stable = vec![branch.kind == "isola"; branch.size];
        branch.unstable = vec![false; branch.size];
    }
    let [main, isola, of_mains] = unknown(&report);
    assert!(main < of_mains && of_mains < isola, "{main}, {isola}, {of_mains}");
    for branch in &mut report.branches {
        branch.stable = vec![branch.kind == "main"; branch.size];
    }
    let [_, isola, of_isola] = unknown(&report);
    assert!(of_isola > isola, "{isola}, {of_isola}");
}

/// A curve beside what the map shows is in its legend nevertheless, as such.
#[test]
fn curves_beyond_the_map_are_named_so() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let first = |report: &Report| {
        let map = Figures::new(&report.subject()).drawn.remove("map").unwrap();
        map.legend[0].text.clone()
    };
    assert_eq!(first(&report), "threshold A* of the backbone");
    let backbone = report.backbone.as_mut().unwrap();
    backbone.omega.values.iter_mut().for_each(|omega| *omega *= 100.0);
    backbone.events.clear();
    assert_eq!(first(&report), "threshold A* of the backbone (beyond these frequencies)");
}

/// What is marked beside what the map shows is named so, and the backbone is in the legend of responses where it is in their figure.
#[test]
fn what_lies_beyond_a_figure_is_not_named_as_if_it_were_in_it() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let names = |report: &Report, figure: &str| {
        let figure = Figures::new(&report.subject()).drawn.remove(figure).unwrap();
        figure.legend.into_iter().map(|entry| entry.text).collect::<Vec<String>>()
    };
    assert!(names(&report, "response").contains(&"backbone".into()));
    let point = |event: &str, omega| CurvePoint {
        forcing: 5e-3,
        omega,
        amplitude: 1.0,
        event: Some(event.into()),
        ..CurvePoint::default()
    };
    // Cusps do not say what the map is about.
    let curve = |omega| vec![CurveRow { points: vec![point("cusp", omega)], ..CurveRow::default() }];
    let inside = report.overview.levels[1].isolas().next().unwrap().omega_at_max;
    let name = "cusps, computed (two folds meet)";
    for (omega, expected) in [(inside, name.to_string()), (1e3, format!("{name} (beyond these frequencies)"))] {
        report.curves = curve(omega);
        let names = names(&report, "map");
        assert!(names.contains(&expected), "{names:?}");
    }
    report.backbone.as_mut().unwrap().omega.values.iter_mut().for_each(|omega| *omega *= 100.0);
    assert!(!names(&report, "response").contains(&"backbone".into()));
}

/// The largest response may be of a branch that branches off.
#[test]
fn what_else_is_found_is_called_what_it_is() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let second = |report: &Report| {
        let figure = Figures::new(&report.subject()).drawn.remove("resonance").unwrap();
        figure.legend.into_iter().find(|entry| entry.text.starts_with("with ")).unwrap().text
    };
    assert_eq!(second(&report), "with isolas");
    let isola = |report: &Report| report.overview.levels[1].isolas().next().unwrap().clone();
    let larger = BranchRow { kind: "branched".into(), amplitude_max: 1e3, ..isola(&report) };
    report.overview.levels[1].branches.push(larger);
    assert_eq!(second(&report), "with isolas and others");
    report.overview.levels.iter_mut().for_each(|level| level.branches.retain(|branch| branch.kind != "isola"));
    assert_eq!(second(&report), "with other branches");
}

/// Fold curves go along the gap where something begins to touch.
#[test]
fn the_gap_is_in_the_figure_of_folds() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let point = |forcing| CurvePoint { forcing, omega: 1.0, amplitude: 1.0, ..CurvePoint::default() };
    report.curves = vec![CurveRow { points: vec![point(4e-3), point(5e-3)], ..CurveRow::default() }];
    let panel = |report: &Report| Figures::new(&report.subject()).drawn.remove("folds").unwrap().panels.remove(0);
    assert!(panel(&report).spans.is_empty());
    for (is_gap, name) in [(true, "gap"), (false, "contact begins")] {
        report.monitors[0].touch = Some(Touch { at: 0.5, is_gap });
        let panel = panel(&report);
        assert_eq!(panel.spans[0].at, [Some(0.5)]);
        assert!(panel.labels.iter().any(|label| label.text == name), "{:?}", panel.labels);
    }
}

#[test]
fn what_was_not_found_is_not_still_to_come() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    report.branches.clear();
    let why = |report: &Report| Figures::new(&report.subject()).nothing["response"].clone();
    report.run.stage = Some(protocol::to_everyone::Stage::Sweep);
    assert!(why(&report).ends_with("has been computed yet"), "{}", why(&report));
    report.run.stage = Some(protocol::to_everyone::Stage::Finished);
    assert_eq!(why(&report), "no branch was found at these levels");
    report.harmonic = 2;
    assert_eq!(why(&report), "no motions of 2 periods of the force were found at these levels");
}

#[test]
fn forcing_has_its_unit_on_axes() {
    let dir = damper();
    let report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let unit = report.forcing_unit.clone().unwrap();
    let figures = Figures::new(&report.subject());
    let axis = |name: &str| &figures.drawn[name].panels[0];
    let headings = [axis("map").y[0].heading(), axis("resonance").x[0].heading()];
    let expected =
        ["forcing amplitude A, threshold A*", "forcing amplitude A"].map(|title| format!("{title} ({unit})"));
    assert!(unit.contains("N at "), "{unit}");
    assert_eq!(headings, expected);
}

/// Whatever is marked in a figure is named in its legend.
#[test]
fn marks_have_their_entries() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let windows = report.overview.levels.iter_mut().flat_map(|level| &mut level.windows);
    windows.for_each(|window| window.outcome = WindowOutcome::NotFound("nowhere".into()));
    let of_modes = tempdir().unwrap();
    let (store, _) = Study::new("nltva", 3, &["0.1"]).begin(&of_modes.path().join("run"));
    let mut other = Report::read(&store, &Selection::All).unwrap();
    let peak = Peak { mode: 1, index: 3, omega: 1.0, share: 0.1, harmonic: 3, ratio: 1.0, resonant: true };
    other.backbone.as_mut().unwrap().peaks = vec![peak];
    let figures = [&report, &other].map(|report| Figures::new(&report.subject()).drawn);
    let marker = |style: &Style| style.marker.map(|marker| (marker.shape, marker.open));
    let mut shapes = Vec::new();
    for figure in figures.iter().flat_map(|drawn| drawn.values()) {
        let marks = figure.panels.iter().flat_map(|panel| &panel.series).filter(|series| series.style.width == 0.0);
        for mark in marks.filter_map(|series| marker(&series.style)) {
            assert!(figure.legend.iter().any(|entry| marker(&entry.style) == Some(mark)), "{}: {mark:?}", figure.name);
            shapes.push((figure.name, mark.0));
        }
    }
    assert!(shapes.contains(&("map", Shape::Cross)) && shapes.contains(&("modes", Shape::Circle)), "{shapes:?}");
}
