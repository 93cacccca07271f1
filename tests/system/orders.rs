//! Motions of several orders in one run: those of order m last m periods of the force.

use crate::BRIEF;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::{TempDir, tempdir};
use tests::{complaint, isola, repository};

const STUDY: &str = "models/duffing_subharmonic/study.toml";

/// Bounds of the force, of which a third is that of the motion in the study.
const BOUNDS: &[&str] = &["--set", "frequency.min=0.6", "--set", "frequency.max=7.5"];

fn sweep(folder: &TempDir, name: &str, more: &[&str]) -> (PathBuf, Output) {
    let run = folder.path().join(name);
    let (study, out) = (repository(STUDY), run.to_str().unwrap());
    let output = isola(&[&["sweep", study.to_str().unwrap(), "--out", out, "--workers", "2"], BRIEF, more].concat());
    (run, output)
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", complaint(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Rows of `summary.csv` that are of isolas.
fn isolas(folder: &Path) -> Vec<String> {
    let summary = std::fs::read_to_string(folder.join("summary.csv")).unwrap();
    summary.lines().filter(|line| line.contains(",isola,")).map(String::from).collect()
}

#[test]
fn an_order_has_what_the_structure_forced_on_its_harmonic_has() {
    let folder = tempdir().unwrap();
    let (alone, output) = sweep(&folder, "alone", &["--amplitudes", "1.5,2"]);
    text(&output);
    let (run, output) = sweep(
        &folder,
        "orders",
        &[&["--amplitudes", "1.5", "--orders", "1,3", "--set", "forcing.harmonic=1"], BOUNDS].concat(),
    );
    let table = text(&output);
    assert!(table.contains("Motions that last 3 periods of the force"), "{table}");
    // One window, one isola, to the last bit; none of the force's own period.
    assert_eq!(isolas(&run.join("m3")), isolas(&alone)[..1]);
    assert!(isolas(&run).is_empty(), "{:?}", isolas(&run));
    assert!(run.join("m3/branches/1.5-isola-1.csv").exists() && run.join("branches/1.5-main-1.csv").exists());
    let mains = std::fs::read_to_string(run.join("m3/summary.csv")).unwrap().matches(",main,").count();
    assert_eq!(mains, 0);

    // A level that is added is one of every order.
    let run_text = run.to_str().unwrap();
    text(&isola(&["extend", run_text, "--amplitudes", "2", "--workers", "2"]));
    assert_eq!(isolas(&run.join("m3")), isolas(&alone));

    let report = text(&isola(&["report", run_text]));
    let told = "Of motions that last 3 periods of the force isolas were found at 2 levels, from A = 1.5 to 2";
    assert!(report.contains(told), "{report}");
    assert!(run.join("report.html").exists() && run.join("m3/report.html").exists());
    let picture = folder.path().join("response.svg");
    let plot = |order: &str| {
        isola(&["plot", run_text, "--figure", "response", "--order", order, "-o", picture.to_str().unwrap()])
    };
    text(&plot("3"));
    let drawn = std::fs::read_to_string(&picture).unwrap();
    text(&plot("1"));
    assert_ne!(drawn, std::fs::read_to_string(&picture).unwrap());
    let refused = plot("2");
    assert_eq!(refused.status.code(), Some(2), "{}", complaint(&refused));
    assert!(complaint(&refused).contains("the run looks for motions of order 1, 3"), "{}", complaint(&refused));
}

#[test]
fn orders_that_cannot_be_are_refused() {
    let folder = tempdir().unwrap();
    for (orders, why) in [
        ("0,1", "motions last 1 period of the force or more"),
        ("3,1", "in ascending order"),
        ("1,1", "in ascending order"),
        ("1,22", "harmonics.count = 21 is too few"),
        ("one", "a list of numbers like [1, 2]"),
    ] {
        let (run, output) = sweep(&folder, "refused", &["--orders", orders]);
        assert_eq!(output.status.code(), Some(2), "{orders}: {}", complaint(&output));
        assert!(complaint(&output).contains("search.harmonics"), "{orders}: {}", complaint(&output));
        assert!(complaint(&output).contains(why), "{orders}: {}", complaint(&output));
        assert!(!run.exists());
    }
}
