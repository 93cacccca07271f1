//! Study files: what comes over what.

mod refused;

use coordinator::check::report;
use coordinator::study::Study;
use protocol::to_everyone::Amplitude;
use results::resolved_study::differences;
use solver::files;
use solver::settings::{ModeChoice, NumberList, Settings};
use solver::structure::Damping;
use solver::structure::laws::{Law, LawKind};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const MODEL: &str = r#"
name = "stopped mass"
dofs = ["tip", "root"]
[matrices]
mass = [[1, 0], [0, 1]]
stiffness = "K.mtx"
[damping]
ratios = [{ modes = "1-2", ratio = 1e-3 }]
[contact]
gap = 1e-3
friction = 0.2
[[contact.nodes]]
name = "stop"
normal = "tip"
tangential = ["root"]
radius = 0.25
"#;

const K: &str = "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n1 1 2\n2 1 -1\n2 2 2\n";

const STUDY: &str = r#"
amplitudes = "20:60:20"
[harmonics]
count = 7
[frequency]
min = 0.5
[contact]
gap = 2e-3
"#;

fn folder(study: &str) -> TempDir {
    let dir = TempDir::new().unwrap();
    for (name, text) in [("study.toml", study), ("model.toml", MODEL), ("K.mtx", K)] {
        fs::write(dir.path().join(name), text).unwrap();
    }
    dir
}

fn pairs(set: &[(&str, &str)]) -> Vec<(String, String)> {
    set.iter().map(|(key, value)| (key.to_string(), value.to_string())).collect()
}

#[track_caller]
fn load(study: &str, set: &[(&str, &str)], amplitudes: Option<&str>) -> Study {
    Study::load(folder(study).path(), &pairs(set), amplitudes).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
    assert_eq!(message.lines().count(), 1, "{message:?} is not one line");
}

fn contact(study: &Study) -> (f64, f64, f64) {
    let LawKind::Contact(contact) = &study.model.elements()[0].law else { panic!("no contact") };
    let friction = contact.friction.as_ref();
    (contact.gap, friction.map_or(0.0, |f| f.coefficient), friction.map_or(0.0, |f| f.sense))
}

fn texts(study: &Study) -> Vec<&str> {
    study.amplitudes.iter().map(|amplitude| amplitude.text.as_str()).collect()
}

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

#[test]
fn the_command_line_comes_over_the_study_and_the_study_over_the_model() {
    let study = load(STUDY, &[], None);
    assert_eq!((study.name.as_str(), study.model.name()), ("stopped mass", "stopped mass"));
    assert_eq!(contact(&study), (2e-3, 0.2, 1.0));
    let mut expected = Settings::default();
    (expected.harmonics.count, expected.frequency.min) = (7, Some(0.5));
    assert_eq!(study.settings, expected);
    assert_eq!(texts(&study), ["20", "40", "60"]);
    assert_eq!(study.amplitudes[1], Amplitude { text: "40".into(), value: 40.0 });

    let set = [
        ("contact.gap", "3e-3"),
        ("contact.friction", "0.1"),
        ("contact.sense", "-1"),
        ("harmonics.count", "20"),
        ("harmonics.count", "9"),
        ("harmonics.samples", "256"),
        ("frequency.max", "4"),
        ("continuation.newton.max_iterations", "12"),
        ("amplitudes", "5:10:5"),
        ("name", "typed"),
    ];
    let study = load(STUDY, &set, None);
    assert_eq!(contact(&study), (3e-3, 0.1, -1.0));
    (expected.harmonics.count, expected.harmonics.samples) = (9, 256);
    (expected.frequency.max, expected.continuation.newton.max_iterations) = (Some(4.0), 12);
    assert_eq!(study.settings, expected);
    assert_eq!((texts(&study), study.name.as_str()), (vec!["5", "10"], "typed"));

    assert_eq!(texts(&load(STUDY, &set, Some("7,3"))), ["7", "3"]);
    assert_eq!(texts(&load(STUDY, &[("\"amplitudes\"", "8"), ("\"contact\".gap", "1")], None)), ["8"]);
    // What the study lacks, the command line may give.
    assert_eq!(texts(&load("", &[], Some("1e-3"))), ["1e-3"]);
    // It reaches into the lists of the model.
    let LawKind::Contact(node) =
        &load(STUDY, &[("contact.nodes.0.epsilon", "5")], None).model.elements()[0].law.clone()
    else {
        panic!("no contact")
    };
    assert_eq!(node.epsilon, 5.0);
}

#[test]
fn lists_inline_tables_and_ways_of_damping_are_replaced() {
    let other =
        "amplitudes = [1]\nmonitors = [\"root\"]\nforcing.shape = {dofs = {root = 2}}\ndamping.default_ratio = 0.1";
    let study = load(other, &[], None);
    assert_eq!((study.model.monitors(), &study.model.forcing().shape), (&[1][..], &vec![0.0, 2.0]));
    let study = load("amplitudes = [1]\ndamping.rayleigh = {mass = 0.5}", &[], None);
    let Damping::Modal(damping) = study.model.damping() else { panic!("Rayleigh damping is modal") };
    assert!(damping.iter().all(|d| (d - 0.5).abs() < 1e-12), "{damping:?}");
    let laws = "amplitudes = [1]\n[[laws]]\ndof = \"tip\"\nlaw = {polynomial_spring = {terms = [{power = 3, coefficient = 1}]}}";
    assert_eq!(load(laws, &[], None).model.elements().len(), 2);
}

#[test]
fn a_study_is_a_file_or_a_folder_and_its_model_may_be_elsewhere() {
    let dir = folder(STUDY);
    let studies = dir.path().join("studies");
    fs::create_dir(&studies).unwrap();
    fs::write(studies.join("low.toml"), "model = \"..\"\namplitudes = 0.5\n").unwrap();
    let study = Study::load(&studies.join("low.toml"), &[], None).unwrap();
    assert_eq!((texts(&study), &study.model_dir), (vec!["0.5"], &studies.join("..")));
    let study = Study::load(dir.path(), &[], None).unwrap();
    assert_eq!((study.file, study.model_dir), (dir.path().join("study.toml"), dir.path().to_path_buf()));
}

#[test]
fn what_is_no_study() {
    let dir = folder(STUDY);
    fs::write(dir.path().join("low.toml"), "").unwrap();
    let refused = |path: &Path| Study::load(path, &[], None).unwrap_err().to_string();
    let name = dir.path().display().to_string();
    says(&refused(&dir.path().join("lwo.toml")), &[&name, "lwo.toml: no such file", "low.toml, study.toml"]);
    says(&refused(&dir.path().join("model.toml")), &["model.toml: a model, not a study; write a study.toml"]);
    fs::remove_file(dir.path().join("study.toml")).unwrap();
    let parts = [
        "a model, but no study.toml that says what to compute; write",
        "amplitudes = \"20:140:20\"",
        "studies in this folder: low.toml",
    ];
    says(&refused(dir.path()), &parts);
    fs::remove_file(dir.path().join("model.toml")).unwrap();
    says(&refused(dir.path()), &["neither study.toml nor model.toml", "low.toml"]);
    fs::write(dir.path().join("low.toml"), [b'a', 0xff]).unwrap();
    says(&refused(&dir.path().join("low.toml")), &["low.toml: the file cannot be read", "UTF-8"]);
}

/// A law that has a name.
const LAW: &str = "[[laws]]\nname = \"s\"\ndof = \"tip\"\nlaw = { jenkins = { stiffness = 1, limit = 1 } }";

#[test]
fn a_law_is_reached_by_its_name() {
    let study = load(&format!("amplitudes = 20\n{LAW}"), &[("laws.s.law.jenkins.limit", "3")], None);
    let limits: Vec<f64> =
        study.model.elements().iter().filter_map(|element| Some(element.law.slider()?.limit)).collect();
    assert_eq!(limits, [3.0]);
}

#[test]
fn a_resolved_study_is_the_same_study() {
    let dir = folder(STUDY);
    let set = [("contact.friction", "0.1"), ("amplitudes", "[0.5, 1e-3]"), ("name", "typed")];
    let study = Study::load(dir.path(), &pairs(&set), None).unwrap();
    let parts = ["max_points = 6000", "tolerance = ", "amplitudes = [\"0.5\", \"1e-3\"]", "gap = 0.002"];
    assert!(parts.iter().all(|part| study.resolved.contains(part)), "{}", study.resolved);
    fs::write(dir.path().join("again.toml"), &study.resolved).unwrap();
    let again = Study::load(&dir.path().join("again.toml"), &[], None).unwrap();
    assert_eq!((&again.name, &again.settings, &again.amplitudes), (&study.name, &study.settings, &study.amplitudes));
    assert_eq!(contact(&again), contact(&study));
    assert_eq!(again.resolved, study.resolved);
}

#[test]
fn differences_name_the_keys_that_differ() {
    let differ = |study: &str, set: &[(&str, &str)]| -> Vec<String> {
        let (old, new) = (load(STUDY, &[], None), load(study, set, None));
        differences(&old.resolved, &new.resolved).iter().map(ToString::to_string).collect()
    };
    assert!(differ(&format!("# edited\n{STUDY}"), &[("harmonics.samples", "512")]).is_empty());
    assert_eq!(differ(STUDY, &[("contact.friction", "0")]), ["contact.friction: 0.2 → 0"]);
    assert_eq!(differ(STUDY, &[("contact.nodes.0.radius", "0.5")]), ["contact.nodes.stop.radius: 0.25 → 0.5"]);
    assert_eq!(differ(STUDY, &[("frequency.max", "9")]), ["frequency.max: not given → 9.0"]);
    assert_eq!(differ(&STUDY.replace("min = 0.5", ""), &[]), ["frequency.min: 0.5 → not given"]);
    let both = differ(STUDY, &[("harmonics.count", "9"), ("amplitudes", "20,40")]);
    assert_eq!(both, ["amplitudes: [20, 40, 60] → [20, 40]", "harmonics.count: 7 → 9"]);
}

#[test]
fn every_study_of_the_repository_loads() {
    let mut names = Vec::new();
    for folder in fs::read_dir(models()).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()) {
        for file in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            if file.extension().is_some_and(|e| e == "toml") && file.file_name().is_some_and(|n| n != "model.toml") {
                let study = Study::load(&file, &[], None).unwrap_or_else(|error| panic!("{error}"));
                assert!(fs::read_to_string(&file).unwrap().starts_with("# "), "{} says what it shows", file.display());
                let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
                names.push(format!("{}/{}: {}", name(&folder), name(&file), study.amplitudes.len()));
            }
        }
    }
    names.sort();
    let expected = [
        "cantilever_stop/study.toml: 3",
        "chain_subharmonic/study.toml: 4",
        "chain_subharmonic/third_mode.toml: 3",
        "damper_two_isolas/study.toml: 7",
        "duffing/study.toml: 10",
        "duffing_subharmonic/orders.toml: 3",
        "duffing_subharmonic/study.toml: 3",
        "friction_mass/study.toml: 4",
        "impact_subharmonic/study.toml: 3",
        "nltva/study.toml: 7",
        "nonlinear_damper/study.toml: 9",
        "rotor67/damping_heavy.toml: 2",
        "rotor67/damping_light.toml: 2",
        "rotor67/frictionless.toml: 7",
        "rotor67/paper.toml: 7",
        "rotor67/study.toml: 7",
        "rotor67_thickness/study.toml: 7",
        "stop_subharmonic/study.toml: 4",
        "two_blades/study.toml: 5",
        "two_dampers/study.toml: 6",
        "two_masses_stop/study.toml: 3",
    ];
    assert_eq!(names, expected);
}

#[test]
fn the_blade_has_the_scenario_that_its_studies_state() {
    let load = |name: &str| Study::load(&models().join("rotor67").join(name), &[], None).unwrap();
    let (blade, smooth, paper) = (load("study.toml"), load("frictionless.toml"), load("paper.toml"));
    assert_eq!((contact(&blade), contact(&smooth).1, contact(&paper)), ((4e-4, 0.15, -1.0), 0.0, (4e-4, 0.15, -1.0)));
    assert!((paper.model.modes().frequencies[0] - 2039.8).abs() < 0.1);
    let model = files::load(&models().join("rotor67")).unwrap();
    assert_eq!(blade.model.modes().frequencies, model.modes().frequencies);
    let changed: Vec<String> = differences(&blade.resolved, &paper.resolved).into_iter().map(|d| d.key).collect();
    assert_eq!(changed, ["matrices.stiffness", "name"]);
}

#[test]
fn the_report_says_what_will_be_computed() {
    let report = |name: &str, file: &str| report(&Study::load(&models().join(name).join(file), &[], None).unwrap());
    let blade = report("rotor67", "study.toml");
    let lines = [
        "study       NASA rotor 67, friction 0.15\n",
        "size        39 dofs, 9 contact elements, no other laws\n",
        "modes        1     2333.33 rad/s     371.361 Hz  damping ratio 0.001  followed\n",
        "contact     gap 0.4 mm, friction 0.15, sense -1, epsilon 1e7 N/m\n",
        "monitored   b0.r\n",
        "amplitudes  7: 20 … 140\n",
        "harmonics   10, 512 samples a period, contact over its exact arcs\n",
        "unknowns    at most 567 (27 channels × 21 coefficients)",
        "frequency   10 % beyond the resonances",
    ];
    for line in lines {
        assert!(blade.contains(line), "{blade}\ndoes not say {line:?}");
    }
    assert!(report("rotor67", "frictionless.toml").contains("gap 0.4 mm, no friction, epsilon"));
    let damper = report("nonlinear_damper", "study.toml");
    for part in ["1 dof, no rigid contact, 1 other law (damper)", "0.9 rad/s", "at most 11 (1 channel"] {
        assert!(damper.contains(part), "{damper}\ndoes not say {part:?}");
    }
}

#[test]
fn modes_are_a_word_a_list_or_one() {
    let modes = |extra: &str, set: &[(&str, &str)]| {
        let dir = folder(&format!("amplitudes = 20\n{extra}"));
        let study = Study::load(dir.path(), &pairs(set), None).unwrap();
        // What was resolved says the same.
        fs::write(dir.path().join("study.toml"), &study.resolved).unwrap();
        let again = Study::load(dir.path(), &[], None).unwrap();
        assert_eq!(again.settings, study.settings);
        study.settings.backbone.modes
    };
    let these = |numbers: &[usize]| ModeChoice::These(NumberList::new(numbers).unwrap());
    assert_eq!(modes("", &[]), ModeChoice::Auto);
    assert_eq!(modes("[backbone]\nmode = 2", &[]), these(&[2]));
    assert_eq!(modes("[backbone]\nmodes = [2, 1]", &[]), these(&[2, 1]));
    // What is typed replaces what stands in the file, under either name.
    assert_eq!(modes("[backbone]\nmode = 2", &[("backbone.modes", "1,2")]), these(&[1, 2]));
    assert_eq!(modes("[backbone]\nmodes = [2, 1]", &[("backbone.mode", "1")]), these(&[1]));
    assert_eq!(modes("[backbone]\nmodes = [2]", &[("backbone.modes", "auto")]), ModeChoice::Auto);
}
