//! In which order things are drawn, and in which units.

use super::*;
use crate::figure::Kind;

#[test]
fn what_a_curve_encloses_hides_no_other() {
    let dir = damper();
    let drawn = sheet(&dir.path().join("run"), &["--figure", "response"]).unwrap();
    let svg = drawn.svg(170.0, 110.0).unwrap();
    let lines: Vec<&str> = svg.lines().collect();
    let area = format!("fill=\"{}\"", LIGHT.tint(Color::Level(1.0)));
    let inside = lines.iter().rposition(|line| line.contains(&area)).expect("an isola encloses something");
    let colors = [Color::Level(0.0), Color::Level(1.0)].map(|color| format!("stroke=\"{}\"", LIGHT.of(color)));
    // Lines of the legend stand before the panel.
    let start = lines.iter().position(|line| line.contains(&LIGHT.tint(Color::Level(1.0)).to_string())).unwrap();
    let is_curve = |line: &&&str| colors.iter().any(|color| line.contains(color));
    assert_eq!(lines[start..inside].iter().filter(is_curve).count(), 0);
    assert!(lines[inside..].iter().filter(is_curve).count() >= 3);
}

/// Births as computed and as predicted are at one place, nearly: what is computed lies over, and the other one shows behind it.
#[test]
fn marks_of_one_event_hide_none() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let birth = report.backbone.as_ref().unwrap().events[0];
    let event = Some("birth".to_string());
    let point = CurvePoint { forcing: birth.threshold, omega: birth.omega, event, ..CurvePoint::default() };
    report.curves = vec![CurveRow { points: vec![point], ..CurveRow::default() }];
    let panel = Figures::new(&report.subject()).drawn.remove("map").unwrap().panels.remove(0);
    let mark = |color: Color| {
        let is_mark = |series: &&Series| series.style.color == color && series.style.marker.is_some();
        let place = panel.series.iter().rposition(|series| is_mark(&series)).unwrap();
        (place, panel.series[place].style.marker.unwrap().size)
    };
    let (predicted, computed) = (mark(Color::Ink), mark(Color::Category(3)));
    assert!(predicted.0 < computed.0 && predicted.1 > 1.5 * computed.1, "{predicted:?}, {computed:?}");
    // What is computed is named before what is predicted.
    assert_eq!(panel.labels[0].color, Color::Category(3));
}

#[test]
fn narrow_isolas_have_thin_lines() {
    let dir = damper();
    let mut report = Report::read(&Reader::open(&dir.path().join("run")).unwrap(), &Selection::All).unwrap();
    let drawn = |report: &Report| {
        let mut figure = Figures::new(&report.subject()).drawn.remove("response").unwrap();
        let isola = figure.panels.remove(0).series.into_iter().find(|series| series.kind == Kind::Closed).unwrap();
        (isola.style.width, figure.legend[1].text.clone())
    };
    let (full, name) = drawn(&report);
    assert_eq!(name, "isola");
    let isola = report.branches.iter_mut().find(|branch| branch.kind == "isola").unwrap();
    let top = isola.amplitude_at_peak;
    isola.amplitude[0].values.iter_mut().for_each(|height| *height = top + 0.01 * (*height - top));
    let (width, name) = drawn(&report);
    assert!(width < 0.6 * full, "{width} and {full}");
    assert_eq!(name, "isola, thinner where narrow");
}

#[test]
fn axes_have_the_units_that_were_asked_for() {
    let dir = damper();
    let run = dir.path().join("run");
    let headings = |options: &[&str]| {
        let panel = &sheet(&run, options).unwrap().figure.panels[0];
        (panel.x[0].heading(), panel.y[0].heading())
    };
    let told = |x: &str, y: &str| (x.to_string(), y.to_string());
    let of = |units| headings(&["--figure", "response", "--units", units]);
    assert_eq!(of("mm,Hz"), told("frequency (Hz)", "amplitude of x1 (mm)"));
    // What is not asked for stays as it is.
    assert_eq!(of("Hz"), told("frequency (Hz)", "amplitude of x1 (m)"));
    assert_eq!(of("um"), told("frequency ω (rad/s)", "amplitude of x1 (µm)"));
    let drawn = sheet(&run, &["--figure", "resonance", "--units", "mm,Hz"]).unwrap();
    assert_eq!(drawn.figure.panels[0].y[0].heading(), "frequency (Hz)");
    let unit = &drawn.figure.panels[0].y[0].unit;
    assert!((unit.factor * std::f64::consts::TAU - 1.0).abs() < 1e-15);
}
