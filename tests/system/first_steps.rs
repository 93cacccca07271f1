//! What a newcomer types: a model from a template, what its keys mean, its sweep.

use crate::FEW;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tests::{complaint, isola, repository};

fn text(path: &Path) -> &str {
    path.to_str().expect("paths are text")
}

/// Writes a template into a new folder.
fn new(folder: &Path, template: &str) -> PathBuf {
    let folder = folder.join(template);
    let output = isola(&["new", text(&folder), "--template", template]);
    assert!(output.status.success(), "{}", complaint(&output));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("model.toml, study.toml") && said.contains("isola sweep"), "{said}");
    folder
}

/// Checks and sweeps a template, with more arguments: kinds of branches, level by level.
fn found(template: &str, more: &[&str]) -> BTreeMap<String, Vec<String>> {
    let folder = tempfile::tempdir().unwrap();
    let model = new(folder.path(), template);
    let check = isola(&["check", text(&model)]);
    assert!(check.status.success(), "{}", complaint(&check));
    let check = String::from_utf8(check.stdout).unwrap();
    assert!(!check.contains("\nwarning"), "{check}");
    let run = folder.path().join("run");
    let sweep = isola(&[&["sweep", text(&model), "--out", text(&run)], more].concat());
    assert!(sweep.status.success(), "{}", complaint(&sweep));
    let mut kinds = BTreeMap::<String, Vec<String>>::new();
    let mut summary = csv::Reader::from_path(run.join("summary.csv")).unwrap();
    for row in summary.deserialize::<BTreeMap<String, String>>() {
        let row = row.unwrap();
        kinds.entry(row["amplitude"].clone()).or_default().push(row["kind"].clone());
    }
    kinds
}

#[track_caller]
fn finds(template: &str, more: &[&str], expected: &[(&str, &[&str])]) {
    let expected = expected
        .iter()
        .map(|(level, kinds)| (level.to_string(), kinds.iter().map(ToString::to_string).collect::<Vec<_>>()));
    assert_eq!(found(template, more), expected.collect(), "{template}");
}

#[test]
fn duffing() {
    finds("duffing", FEW, &[("0.02", &["main"]), ("0.05", &["main"]), ("0.1", &["main"])]);
}

/// Nothing but random starts leads to its isola.
#[test]
fn stop() {
    finds("stop", &[], &[("0.01", &["main"]), ("0.03", &["main"]), ("0.1", &["main", "isola"])]);
}

#[test]
fn friction() {
    finds("friction", FEW, &[("0.005", &["main"]), ("0.02", &["main"]), ("0.1", &["main"])]);
}

#[test]
fn absorber() {
    finds("absorber", FEW, &[("0.11", &["main"]), ("0.13", &["main", "isola"]), ("0.15", &["main", "isola"])]);
}

#[test]
fn blade() {
    finds("blade", FEW, &[("1", &["main"]), ("3", &["main"]), ("10", &["main", "isola", "isola"])]);
}

#[test]
fn what_is_there_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |path: &Path, why: &str| {
        let output = isola(&["new", text(path)]);
        let message = complaint(&output);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains(text(path)) && message.contains(why), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    };
    let file = folder.path().join("notes");
    std::fs::write(&file, "mine").unwrap();
    refused(folder.path(), "this folder has something in it; name a new or an empty folder");
    refused(&file, "this is a file");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
    // An empty folder will do, and without a template it is one with an isola.
    let empty = folder.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    assert!(isola(&["new", text(&empty)]).status.success());
    assert!(std::fs::read_to_string(empty.join("model.toml")).unwrap().contains("absorber"));
    let unknown = isola(&["new", text(&folder.path().join("x")), "--template", "beam"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(complaint(&unknown).contains("duffing, stop, friction, absorber, blade"), "{}", complaint(&unknown));
}

#[test]
fn schemas_and_explanations() {
    let said = |arguments: &[&str]| {
        let output = isola(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", complaint(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let schema = |arguments: &[&str]| -> Value { serde_json::from_str(&said(arguments)).unwrap() };
    let (model, study) = (schema(&["schema", "model"]), schema(&["schema", "study"]));
    assert_eq!(model["properties"]["contact"]["properties"]["gap"]["exclusiveMinimum"], 0);
    assert!(model["properties"]["harmonics"].is_null() && study["properties"]["harmonics"].is_object());
    assert_eq!(schema(&["schema"])["anyOf"].as_array().unwrap().len(), 2);
    for key in ["contact.nodes.radius", "contact.nodes.0.radius", "contact.nodes[0].radius", "radius"] {
        let text = said(&["schema", "--explain", key]);
        assert!(text.starts_with("contact.nodes.radius ") && text.contains("  unit     m\n"), "{text}");
    }
    assert!(said(&["schema", "--explain", "harmonics"]).contains("keys     count, samples, quadrature\n"));
    // The file says at its end where it comes from.
    let (all, file) = (said(&["schema", "--all"]), std::fs::read_to_string(repository("REFERENCE.md")).unwrap());
    assert!(file.strip_prefix(&all).is_some_and(|rest| rest.trim().starts_with("<!--")), "{all}");
    let unknown = isola(&["schema", "--explain", "contact.gapp"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(complaint(&unknown).contains("did you mean `contact.gap`?"), "{}", complaint(&unknown));
}

#[test]
fn runs_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let model = new(folder.path(), "duffing");
    let runs = ["0.01", "0.02"].map(|ratio| {
        let run = folder.path().join(format!("damped {ratio}"));
        let damping = format!("damping.default_ratio={ratio}");
        let more = ["--set", &damping, "--amplitudes", "0.02", "--search", "none", "--verify", "none"];
        let output = isola(&[&["sweep", text(&model), "--out", text(&run)], &more[..]].concat());
        assert!(output.status.success(), "{}", complaint(&output));
        run
    });
    let [first, second] = [text(&runs[0]), text(&runs[1])];
    let output = isola(&["report", first, second]);
    assert!(output.status.success(), "{}", complaint(&output));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("damping.default_ratio") && said.contains("largest response"), "{said}");
    assert!(said.contains(&format!("{first}/compare.html")), "{said}");
    assert!(std::fs::read_to_string(runs[0].join("compare.html")).unwrap().contains("Isola: runs compared"));
    let picture = folder.path().join("both.svg");
    assert!(isola(&["plot", first, second, "--figure", "response", "-o", text(&picture)]).status.success());
    assert!(std::fs::read_to_string(&picture).unwrap().starts_with("<svg"));
    let wrong = isola(&["plot", first, second, "--figure", "map", "-o", text(&picture)]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(complaint(&wrong).contains("response and resonance"), "{}", complaint(&wrong));
}
