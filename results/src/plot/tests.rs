//! What figures show of small runs, and what they say when they cannot.

mod legends;
mod looks;
mod ranges;
mod windows;

use super::*;
use crate::curves::BackboneCurve;
use crate::figure::{Color, Figures, LIGHT, Ref, Series, Style, run_points};
use crate::fixture::Study;
use crate::report::{Report, Selection};
use crate::store::{BranchRow, CurvePoint, CurveRow, Reader};
use solver::response::branch::BranchKind;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// A request as `isola plot` would make it of these options.
fn request(options: &[&str]) -> Request {
    let mut request = Request::whole(FigureName::Response);
    for pair in options.chunks(2) {
        let value = || Some(pair[1].to_string());
        match pair[0] {
            "--figure" => request.figure = FigureName::ALL.into_iter().find(|figure| figure.name() == pair[1]).unwrap(),
            "--monitor" => request.monitor = value(),
            "--amplitude" => request.amplitude = value(),
            "--mode" => request.mode = pair[1].parse().ok(),
            "--at" => request.at = value(),
            "--along" => request.along = Some(if pair[1] == "omega" { Along::Omega } else { Along::Amplitude }),
            "--frequency" => request.frequency = range(pair[1]),
            "--response" => request.response = range(pair[1]),
            "--forcing" => request.forcing = range(pair[1]),
            "--units" => request.units = pair[1].parse().unwrap(),
            option => panic!("{option}"),
        }
    }
    request
}

fn range(ends: &str) -> Option<(f64, f64)> {
    let (low, high) = ends.split_once(' ')?;
    Some((low.parse().unwrap(), high.parse().unwrap()))
}

fn sheet(run: &Path, options: &[&str]) -> Result<Sheet, String> {
    let reader = Reader::open(run).unwrap();
    compose(&reader, &request(options)).map(|(sheet, _)| sheet).map_err(|error| error.to_string())
}

/// What the labels of a panel say, windows included.
fn labels(sheet: &Sheet, panel: usize) -> Vec<&str> {
    let panel = &sheet.figure.panels[panel];
    let runs = run_points(panel, sheet.view()).into_iter().map(|(_, name)| name);
    panel.labels.iter().map(|label| label.text.as_str()).chain(runs).collect()
}

/// What the entries of the legend say.
fn legend(sheet: &Sheet) -> Vec<&str> {
    sheet.figure.legend.iter().map(|entry| entry.text.as_str()).collect()
}

/// The damper: two levels, an isola at the second.
fn damper() -> TempDir {
    let dir = tempdir().unwrap();
    Study::damper().finished(&dir.path().join("run"));
    dir
}

#[test]
fn the_backbone_of_any_mode_is_drawn() {
    let dir = tempdir().unwrap();
    let study = Study::of_modes("two_masses_stop", 3, &["0.01", "0.02"], 2);
    drop(study.finished(dir.path()));
    let drawn = |options: &[&str]| sheet(dir.path(), &[&["--figure", "balance"], options].concat());
    for (number, backbone) in [("2", 0), ("1", 1)] {
        let sheet = drawn(&["--mode", number]).unwrap();
        let points = study.backbones()[backbone].points.len();
        let name = format!("windows of mode {number} at A = ");
        assert!(sheet.figure.title.as_ref().is_some_and(|title| title.starts_with(&name)), "{:?}", sheet.figure.title);
        let omega = sheet.columns.values(&Ref::to(0), 1.0);
        assert_eq!(omega.len(), points);
    }
    let why = drawn(&["--mode", "3"]).unwrap_err();
    assert_eq!(why, "mode 3 has no backbone in this run: there are those of modes 2, 1");
    assert!(sheet(dir.path(), &["--figure", "map", "--mode", "1"]).is_err());
}

#[test]
fn response_has_branches_backbone_and_labels() {
    let dir = damper();
    let drawn = sheet(&dir.path().join("run"), &["--figure", "response"]).unwrap();
    let panel = &drawn.figure.panels[0];
    assert_eq!(panel.series.iter().filter(|series| series.branch.is_some()).count(), 3);
    assert_eq!(panel.series.iter().filter(|series| series.switch.is_some() && !series.along_runs).count(), 1);
    assert_eq!(labels(&drawn, 0), ["isola 1, A = 0.006", "A = 0.006", "A = 3e-3"]);
    let unverified = "stability not known: nothing was verified";
    assert_eq!(legend(&drawn), ["main branch", "isola", unverified, "backbone", "peak", "fold"]);
    assert_eq!(panel.y[0].heading(), "amplitude of x1 (m)");
    let (x, isola) = (&panel.x[0], panel.labels[0].x[0].unwrap());
    assert!((0.0..1.0).contains(&x.share(isola)) && x.range.1 - x.range.0 < 0.1, "{x:?}");
}

#[test]
fn what_is_cut_is_no_isola() {
    let dir = tempdir().unwrap();
    let run = dir.path().join("run");
    Study::damper().finished_with_cuts(&run);
    let drawn = sheet(&run, &["--figure", "response"]).unwrap();
    assert_eq!(legend(&drawn)[..2], ["main branch", "cut off by a bound"]);
    assert_eq!(labels(&drawn, 0)[0], "cut 1, A = 0.006");
    assert_eq!(legend(&sheet(&run, &["--figure", "map"]).unwrap())[2], "cut off by a bound");
    assert!(sheet(&run, &["--figure", "motion", "--at", "0.006/cut 1/3"]).is_ok());
}

#[test]
fn map_and_resonance_show_levels() {
    let dir = damper();
    let run = dir.path().join("run");
    let drawn = sheet(&run, &["--figure", "map"]).unwrap();
    assert_eq!(
        legend(&drawn),
        ["threshold A* of the backbone", "main branches", "isolas", "births, predicted", "merges, predicted"]
    );
    assert_eq!(labels(&drawn, 0).len(), 2);
    // Every kind has its own look and name; what hangs on the amplitude looked at is named where one is, on the page.
    let mut report = Report::read(&Reader::open(&run).unwrap(), &Selection::All).unwrap();
    let isola = report.overview.levels[1].others().next().unwrap().clone();
    for kind in BranchKind::ALL.into_iter().skip(2) {
        let other = BranchRow { kind: kind.name().into(), closed: false, ..isola.clone() };
        report.overview.levels[1].branches.push(other);
    }
    let map = Figures::new(&report.subject()).drawn.remove("map").unwrap();
    let names: Vec<&str> = map.legend.iter().map(|entry| entry.text.as_str()).collect();
    assert_eq!(names[1..3], ["amplitude chosen: drag the line", "windows there, a colour each"]);
    let kinds =
        ["main branches", "open branches", "isolas", "cut off by a bound", "unfinished", "branches off another"];
    assert_eq!(names[3..9], kinds);
    let looks: Vec<&Style> = map.legend[3..9].iter().map(|entry| &entry.style).collect();
    assert!((1..looks.len()).all(|i| !looks[..i].contains(&looks[i])), "{looks:?}");
    assert!(looks[2].dash.is_empty() && looks[2].width > looks[5].width, "{looks:?}");
    // Of further modes as well, where they are near the levels.
    let mut report = Report::read(&Reader::open(&run).unwrap(), &Selection::All).unwrap();
    let primary = report.backbone.clone().unwrap();
    report.further = vec![BackboneCurve { mode: 1, ..primary.clone() }];
    let map = Figures::new(&report.subject()).drawn.remove("map").unwrap();
    assert!(map.legend.iter().any(|entry| entry.text == "threshold A* of further modes"), "{:?}", map.legend);
    assert_eq!(map.panels[0].labels.len(), 4);
    let mut far = primary;
    far.threshold.values.iter_mut().for_each(|threshold| *threshold *= 1e6);
    report.further = vec![BackboneCurve { events: Vec::new(), ..far }];
    let map = Figures::new(&report.subject()).drawn.remove("map").unwrap();
    assert!(!map.legend.iter().any(|entry| entry.text.contains("further")), "{:?}", map.legend);
    let drawn = sheet(&run, &["--figure", "resonance"]).unwrap();
    assert_eq!(drawn.figure.panels.iter().map(|panel| panel.series.len()).collect::<Vec<_>>(), [3, 3]);
}

/// The map is drawn around the isola, however far curves of another mode go, and shows what lies beside it.
#[test]
fn the_map_is_about_isolas_and_frequencies_are_chosen() {
    let dir = damper();
    let run = dir.path().join("run");
    let mut report = Report::read(&Reader::open(&run).unwrap(), &Selection::All).unwrap();
    let isola = report.overview.levels[1].others().next().unwrap().omega;
    let range = |report: &Report| Figures::new(&report.subject()).drawn["map"].panels[0].x[0].range;
    let (before, width) = (range(&report), isola.1 - isola.0);
    assert!(before.0 < isola.0 && isola.1 < before.1, "{before:?} around {isola:?}");
    let mut other = report.backbone.clone().unwrap();
    other.omega.values.iter_mut().for_each(|omega| *omega *= 7.0);
    report.further = vec![BackboneCurve { mode: 1, ..other }];
    let fold = |omega| CurvePoint { forcing: 0.005, omega, amplitude: 1.0, ..CurvePoint::default() };
    report.curves = vec![CurveRow { points: vec![fold(0.1), fold(9.0)], ..CurveRow::default() }];
    let (low, high) = range(&report);
    assert!(low <= before.0 && before.1 <= high && high - low < 3.5 * width, "{low} to {high}, {before:?}");
    // Curves that leave the figure go on beyond its frame, where they are cut.
    let far = [1e-9, 0.005, 1e3];
    let fold = |forcing| CurvePoint { forcing, omega: 1.0, amplitude: 1.0, ..CurvePoint::default() };
    report.curves.push(CurveRow { points: far.map(fold).to_vec(), ..CurveRow::default() });
    let figures = Figures::new(&report.subject());
    let is_curve = |series: &&Series| series.style.color == Color::Category(3) && series.style.width > 0.0;
    let folds = figures.drawn["map"].panels[0].series.iter().find(is_curve).unwrap();
    assert_eq!(figures.columns.values(&folds.y[0], 1.0)[3..6], far);
    // Where nothing is there but main branches, and nothing happens, folds and thresholds are what it is about.
    report.overview.levels[1].branches.retain(BranchRow::is_main);
    report.further[0].events.clear();
    report.backbone.iter_mut().for_each(|backbone| backbone.events.clear());
    let (low, high) = range(&report);
    assert!(low < 0.1 && 9.0 < high, "{low} to {high}");

    let cut = |figure| sheet(&run, &["--figure", figure, "--frequency", "0.99 1.005"]).unwrap();
    for figure in ["map", "response", "backbone"] {
        assert_eq!(cut(figure).figure.panels[0].x[0].range, (0.99, 1.005), "{figure}");
    }
    // Beside the peaks amplitudes are smaller.
    let top = |sheet: Sheet| sheet.figure.panels[0].y[0].range.1;
    let beside = sheet(&run, &["--figure", "response", "--frequency", "0.5 0.9"]).unwrap();
    assert!(0.0 < top(beside.clone()) && top(beside) < 0.5 * top(cut("response")));
}

#[test]
fn motion_at_any_point() {
    let dir = damper();
    let run = dir.path().join("run");
    let title = |at: &str| sheet(&run, &["--figure", "motion", "--at", at]).map(|sheet| sheet.figure.title.unwrap());
    let highest = sheet(&run, &["--figure", "motion"]).unwrap();
    assert!(
        highest.figure.title.as_deref().unwrap().starts_with("A = 0.006, isola 1, point "),
        "{:?}",
        highest.figure.title
    );
    // Without contact there are displacements and spectrum only.
    assert_eq!(highest.figure.panels.len(), 2);
    assert_eq!(title("6e-3/isola 1/peak").unwrap(), highest.figure.title.unwrap());
    assert!(title("3e-3/main/0").unwrap().starts_with("A = 3e-3, main, point 0, ω = "));
    // In Hz where that was asked for.
    let of = |units: &[&str]| {
        let options = [&["--figure", "motion", "--at", "3e-3/main/0"], units].concat();
        let title = sheet(&run, &options).unwrap().figure.title.unwrap();
        let (symbol, rest) = title.split_once("point 0, ").unwrap().1.split_once(" = ").unwrap();
        let (value, rest) = rest.split_once(' ').unwrap();
        (symbol.to_string(), value.parse::<f64>().unwrap(), rest.split(';').next().unwrap().to_string())
    };
    let ((omega, rate, radians), (f, frequency, hertz)) = (of(&[]), of(&["--units", "Hz"]));
    assert_eq!([omega, radians, f, hertz], ["ω", "rad/s", "f", "Hz"]);
    assert!((rate / frequency / std::f64::consts::TAU - 1.0).abs() < 1e-5, "{rate} and {frequency}");
    assert_eq!(
        title("0.006/isola 2").unwrap_err(),
        "--at 0.006/isola 2: A = 0.006 has no such branch, but main, isola 1"
    );
    let beyond = title("0.006/isola 1/9999").unwrap_err();
    assert!(beyond.starts_with("--at: isola 1 has no point 9999, but 0 to "), "{beyond}");
    assert!(title("0.006/main/first").unwrap_err().contains("write A/branch/index"));
}

#[test]
fn what_is_not_there_is_named() {
    let dir = damper();
    let run = dir.path().join("run");
    let error = |options: &[&str]| sheet(&run, options).unwrap_err();
    for none in ["0", "-1", "nan", "large"] {
        let said = error(&["--figure", "balance", "--amplitude", none]);
        assert_eq!(said, format!("--amplitude {none}: a number above zero is needed"));
    }
    for figure in ["response", "map", "backbone"] {
        let beside = error(&["--figure", figure, "--units", "Hz", "--frequency", "1 2"]);
        assert!(
            beside.starts_with("--frequency 1 2: nothing is drawn there; what is goes from 0."),
            "{figure}: {beside}"
        );
        assert!(beside.ends_with(" Hz, the unit of the axis"), "{figure}: {beside}");
    }
    assert_eq!(
        error(&["--figure", "response", "--monitor", "tip"]),
        "--monitor tip: the run monitors no such dof, but x1"
    );
    assert_eq!(
        error(&["--figure", "map", "--along", "omega"]),
        "--along: not for the figure map, but for balance, modes"
    );
    assert_eq!(error(&["--figure", "modes"]), "nothing to draw: one mode alone makes the backbone");
    let extension = FileFormat::of(Path::new("figure.jpg")).unwrap_err().to_string();
    assert_eq!(extension, "-o figure.jpg: end it in .svg, .png or .pdf");
}

#[test]
fn figures_at_every_stage() {
    let (study, dir) = (Study::damper(), tempdir().unwrap());
    let bare = dir.path().join("bare");
    drop(crate::store::Store::create(&bare, &study.header()).unwrap());
    for figure in ["balance", "backbone", "map", "modes"] {
        assert_eq!(sheet(&bare, &["--figure", figure]).unwrap_err(), "nothing to draw: the run has no backbone yet");
    }
    for figure in ["response", "resonance", "motion"] {
        assert!(sheet(&bare, &["--figure", figure]).unwrap_err().starts_with("nothing to draw: "), "{figure}");
    }
    let begun = dir.path().join("begun");
    let (store, _) = study.begin(&begun);
    let drawn = sheet(&begun, &["--figure", "balance", "--amplitude", "0.006"]).unwrap();
    assert_eq!(labels(&drawn, 0), ["window 1, pending", "window 2, pending"]);
    let drawn = sheet(&begun, &["--figure", "map"]).unwrap();
    assert_eq!(
        legend(&drawn),
        ["threshold A* of the backbone", "windows pending", "births, predicted", "merges, predicted"]
    );
    drop(store);
}

#[test]
fn damage_is_named() {
    let dir = damper();
    let run = dir.path().join("run");
    let database = rusqlite::Connection::open(run.join("run.sqlite")).unwrap();
    let damage = |sql: &str| assert!(database.execute(sql, []).unwrap() > 0);
    damage("UPDATE results SET sha256 = 'x' WHERE task = (SELECT task FROM branches WHERE kind = 'isola')");
    let reader = Reader::open(&run).unwrap();
    let (drawn, missing) = compose(&reader, &request(&["--figure", "response"])).unwrap();
    assert_eq!(labels(&drawn, 0), ["A = 0.006", "A = 3e-3"]);
    assert!(missing.sentences().any(|sentence| sentence.starts_with("The branch of task")), "{missing:?}");
    damage("UPDATE results SET sha256 = 'x'");
    let error = sheet(&run, &["--figure", "response"]).unwrap_err();
    assert!(error.starts_with("nothing to draw: The branch of task"), "{error}");
    assert!(sheet(&run, &["--figure", "motion"]).is_err());
}

#[test]
fn modes_of_several() {
    let dir = tempdir().unwrap();
    let study = Study::new("nltva", 3, &["0.1"]);
    let (store, _) = study.begin(&dir.path().join("run"));
    let drawn = sheet(store.dir(), &["--figure", "modes"]).unwrap();
    assert_eq!(drawn.figure.legend.len(), study.model.size());
}

#[test]
fn motion_in_contact() {
    let dir = tempdir().unwrap();
    let (store, _) = Study::new("two_masses_stop", 5, &["0.1"]).finished(&dir.path().join("run"));
    let drawn = sheet(store.dir(), &["--figure", "motion"]).unwrap();
    // How far the gap closes, pressures, monitored dofs and spectrum; one contact node has no shape.
    assert_eq!(drawn.figure.panels.len(), 4);
}

#[test]
fn files_begin_right_and_repeat() {
    let dir = damper();
    let run = dir.path().join("run");
    let bytes = |format: FileFormat| {
        let figure = sheet(&run, &["--figure", "response"]).unwrap().svg(170.0, 110.0).unwrap();
        format.bytes(figure).unwrap()
    };
    for (format, start) in
        [(FileFormat::Svg, &b"<svg"[..]), (FileFormat::Png, b"\x89PNG\r\n"), (FileFormat::Pdf, b"%PDF-")]
    {
        let first = bytes(format);
        assert!(first.starts_with(start), "{format:?}");
        assert!(first == bytes(format), "{format:?} is another one every time");
    }
    let svg = String::from_utf8(bytes(FileFormat::Svg)).unwrap();
    assert!(svg.contains("width=\"170mm\"") && svg.contains("height=\"110mm\""), "{}", &svg[..200]);
    let small = sheet(&run, &["--figure", "resonance"]).unwrap().svg(30.0, 30.0).unwrap_err().to_string();
    assert!(small.contains("use larger --width and --height"), "{small}");
}

/// Whatever numbers a run has, figures leave gaps.
#[test]
fn damaged_numbers_leave_gaps() {
    let dir = damper();
    let reader = Reader::open(&dir.path().join("run")).unwrap();
    let mut report = crate::report::Report::read(&reader, &crate::report::Selection::All).unwrap();
    let damage = |values: &mut [f64]| {
        let wrong = [f64::NAN, 1e300, -1e300, f64::INFINITY, 0.0];
        values.iter_mut().skip(2).step_by(3).zip(wrong.iter().cycle()).for_each(|(value, wrong)| *value = *wrong);
    };
    for branch in &mut report.branches {
        damage(&mut branch.omega.values);
        branch.amplitude.iter_mut().for_each(|column| damage(&mut column.values));
    }
    let backbone = report.backbone.as_mut().unwrap();
    for column in [&mut backbone.threshold, &mut backbone.needed, &mut backbone.work, &mut backbone.arc] {
        damage(&mut column.values);
    }
    let figures = crate::figure::Figures::new(&report.subject());
    let subject = report.subject();
    let frame = crate::figure::Frame::at(&subject, subject.backbone.unwrap(), 0.006);
    assert!(figures.drawn.len() > 4, "{:?}", figures.nothing);
    for figure in figures.drawn.values().filter(|figure| figure.name != "motion") {
        let (figure, columns) = (figure.clone(), figures.columns.clone());
        for choice in 0..3 {
            let (figure, columns, frame) = (figure.clone(), columns.clone(), Some(frame.clone()));
            let svg = Sheet { figure, columns, choice, frame }.svg(170.0, 110.0).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            assert!(!FileFormat::Png.bytes(svg).unwrap().is_empty());
        }
    }
}

/// The colours of a file are those of the palette for the roles that the description names.
#[test]
fn files_have_the_colours_of_the_description() {
    let dir = damper();
    for figure in ["response", "map", "resonance", "balance", "backbone"] {
        let sheet = sheet(&dir.path().join("run"), &["--figure", figure]).unwrap();
        let svg = sheet.svg(170.0, 110.0).unwrap();
        let panels = &sheet.figure.panels;
        let series = panels.iter().flat_map(|panel| &panel.series).filter(|series| !series.along_runs);
        for color in series.map(|series| series.style.color).chain(sheet.figure.legend.iter().map(|e| e.style.color)) {
            assert!(
                svg.contains(&LIGHT.of(color).to_string()) || svg.contains(&LIGHT.tint(color).to_string()),
                "{color:?}"
            );
        }
        assert!(!svg.contains("opacity"));
    }
}
