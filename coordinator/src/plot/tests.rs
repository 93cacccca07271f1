//! What figures show of small runs, and what they say when they cannot.

use super::*;
use crate::cli::{Cli, Command};
use crate::fixture::Study;
use clap::Parser;
use std::path::Path;
use tempfile::{TempDir, tempdir};

fn args(run: &Path, options: &[&str]) -> PlotArgs {
    let line = ["isola", "plot", run.to_str().unwrap(), "-o", "figure.svg"];
    match Cli::try_parse_from(line.iter().chain(options)).unwrap().command {
        Command::Plot(args) => args,
        _ => unreachable!(),
    }
}

fn sheet(run: &Path, options: &[&str]) -> Result<Sheet, String> {
    let reader = Reader::open(run).unwrap();
    compose(&reader, &args(run, options), &Selection::All).map(|(sheet, _)| sheet).map_err(|error| error.to_string())
}

fn labels(sheet: &Sheet, panel: usize) -> Vec<&str> {
    sheet.panels[panel].labels.iter().map(|label| label.text.as_str()).collect()
}

/// The damper: two levels, an isola at the second.
fn damper() -> TempDir {
    let dir = tempdir().unwrap();
    Study::damper().finished(&dir.path().join("run"));
    dir
}

#[test]
fn response_has_branches_backbone_and_labels() {
    let dir = damper();
    let drawn = sheet(&dir.path().join("run"), &["--figure", "response"]).unwrap();
    assert_eq!(drawn.panels[0].series.len(), 4);
    assert_eq!(labels(&drawn, 0), ["isola 1, A = 0.006", "A = 0.006", "A = 3e-3"]);
    assert_eq!(drawn.panels[0].y.title, "amplitude of x1 (m)");
    let (x, isola) = (&drawn.panels[0].x, &drawn.panels[0].labels[0]);
    assert!((0.0..1.0).contains(&x.share(isola.at.0)) && x.high - x.low < 0.1, "{x:?}");
}

#[test]
fn figures_of_the_backbone_show_windows() {
    let dir = damper();
    let run = dir.path().join("run");
    for figure in ["balance", "backbone"] {
        let drawn = sheet(&run, &["--figure", figure]).unwrap();
        assert_eq!(labels(&drawn, 0), ["main", "isola 1"], "{figure}");
        let drawn = sheet(&run, &["--figure", figure, "--amplitude", "0.003"]).unwrap();
        assert_eq!(labels(&drawn, 0), ["main"], "{figure}");
    }
    let over = |quantity| sheet(&run, &["--figure", "balance", "--along", quantity]).unwrap().panels[0].x.title.clone();
    assert_eq!(over("omega"), "frequency ω (rad/s)");
    assert_eq!(over("amplitude"), "amplitude of x1 (m)");
}

#[test]
fn map_and_resonance_show_levels() {
    let dir = damper();
    let run = dir.path().join("run");
    let drawn = sheet(&run, &["--figure", "map"]).unwrap();
    // Threshold, main branches, isola, birth, merge.
    assert_eq!(drawn.panels[0].series.len(), 5);
    assert_eq!(labels(&drawn, 0).len(), 2);
    let drawn = sheet(&run, &["--figure", "resonance"]).unwrap();
    assert_eq!(drawn.panels.iter().map(|panel| panel.series.len()).collect::<Vec<_>>(), [3, 3]);
}

#[test]
fn motion_at_any_point() {
    let dir = damper();
    let run = dir.path().join("run");
    let title = |at: &str| sheet(&run, &["--figure", "motion", "--at", at]).map(|sheet| sheet.title.unwrap());
    let highest = sheet(&run, &["--figure", "motion"]).unwrap();
    assert!(highest.title.as_deref().unwrap().starts_with("A = 0.006, isola 1, point "), "{:?}", highest.title);
    // Without contact there are displacements and spectrum only.
    assert_eq!(highest.panels.len(), 2);
    assert_eq!(title("6e-3/isola 1/peak").unwrap(), highest.title.unwrap());
    assert!(title("3e-3/main/0").unwrap().starts_with("A = 3e-3, main, point 0, ω = "));
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
    assert_eq!(
        error(&["--figure", "balance", "--amplitude", "7"]),
        "--amplitude 7: the run has no such level, but 3e-3, 0.006"
    );
    assert_eq!(
        error(&["--figure", "response", "--monitor", "tip"]),
        "--monitor tip: the run monitors no such dof, but x1"
    );
    assert_eq!(
        error(&["--figure", "map", "--along", "omega"]),
        "--along: not for the figure map, but for balance, modes"
    );
    assert_eq!(error(&["--figure", "modes"]), "nothing to draw: one mode alone makes the backbone");
    let unknown =
        Cli::try_parse_from(["isola", "plot", "run", "-o", "a.svg", "--figure", "pie"]).unwrap_err().to_string();
    assert!(unknown.contains("response, balance, backbone, map, resonance, modes, motion"), "{unknown}");
    let extension = Format::of(Path::new("figure.jpg")).unwrap_err().to_string();
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
    // Threshold, pending windows, birth, merge.
    assert_eq!(drawn.panels[0].series.len(), 4);
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
    let (drawn, missing) = compose(&reader, &args(&run, &["--figure", "response"]), &Selection::All).unwrap();
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
    assert_eq!(drawn.panels[0].series.len(), study.model.size());
}

#[test]
fn motion_in_contact() {
    let dir = tempdir().unwrap();
    let (store, _) = Study::new("two_masses_stop", 5, &["0.1"]).finished(&dir.path().join("run"));
    let drawn = sheet(store.dir(), &["--figure", "motion"]).unwrap();
    // Displacements, pressures and spectrum; one contact node has no shape.
    assert_eq!(drawn.panels.len(), 3);
}

#[test]
fn files_begin_right_and_repeat() {
    let dir = damper();
    let run = dir.path().join("run");
    let bytes = |format: Format| {
        let figure = sheet(&run, &["--figure", "response"]).unwrap().prepare(170.0, 110.0).unwrap();
        format.bytes(&figure).unwrap()
    };
    for (format, start) in [(Format::Svg, &b"<svg"[..]), (Format::Png, b"\x89PNG\r\n"), (Format::Pdf, b"%PDF-")] {
        let first = bytes(format);
        assert!(first.starts_with(start), "{format:?}");
        assert!(first == bytes(format), "{format:?} is another one every time");
    }
    let svg = String::from_utf8(bytes(Format::Svg)).unwrap();
    assert!(svg.contains("width=\"170mm\"") && svg.contains("height=\"110mm\""), "{}", &svg[..200]);
    let small = sheet(&run, &["--figure", "resonance"]).unwrap().prepare(30.0, 30.0).unwrap_err().to_string();
    assert!(small.contains("use larger --width and --height"), "{small}");
}
