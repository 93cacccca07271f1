//! Study files: what comes over what, and one message that says what is wrong, where, and what would be right.

use coordinator::check::report;
use coordinator::study::Study;
use proptest::prelude::*;
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

/// Where a message must put the blame.
#[derive(Clone, Copy)]
enum At {
    Study,
    CommandLine,
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

/// A text put into the good study, options, and what the message must say.
type Case<'a> = (At, &'a str, &'a [(&'a str, &'a str)], &'a [&'a str]);

#[test]
fn bad_input() {
    use At::{CommandLine, Study as File};
    let cases: &[Case] = &[
        // Unknown keys.
        (File, "amplitude = 3", &[], &["`amplitude`", "did you mean `amplitudes`"]),
        (File, "[harmonic]\ncount = 3", &[], &["`harmonic`", "did you mean `harmonics`"]),
        (File, "friction = 0", &[], &["`friction`", "did you mean `contact.friction`"]),
        (File, "[harmonics]\ncounts = 3", &[], &["`harmonics.counts`", "did you mean `count`", "`samples`"]),
        (File, "[continuation.newton]\ntol = 3", &[], &["`continuation.newton.tol`", "`tolerance`"]),
        (File, "[contact]\nfricton = 0", &[], &["`contact.fricton`", "did you mean `friction`"]),
        (File, "[backbone]\nequation = \"damped\"", &[], &["`backbone.equation`", "did you mean `damped_mode`"]),
        (CommandLine, "", &[("contact.fricton", "0")], &["--set contact.fricton=0: ", "did you mean `friction`"]),
        (CommandLine, "", &[("friction", "0")], &["--set friction=0: `friction`", "did you mean `contact.friction`"]),
        (CommandLine, "", &[("mass", "2")], &["--set mass=2: `mass`", "did you mean `matrices.mass`"]),
        (CommandLine, "", &[("effort", "2")], &["--set effort=2: `effort`", ".effort`?"]),
        (CommandLine, "", &[("harmonics.cuont", "3")], &["--set harmonics.cuont=3: ", "did you mean `count`"]),
        (CommandLine, LAW, &[("laws.s.limit", "3")], &["--set laws.s.limit=3: ", "did you mean `law.jenkins.limit`"]),
        (CommandLine, LAW, &[("laws.t.law", "3")], &["--set laws.t.law=3: ", "list of 1", "nor the name of one: `s`"]),
        (CommandLine, "", &[("contact..gap", "0")], &["--set contact..gap=0: ", "not a dotted key"]),
        (CommandLine, "", &[("", "0")], &["--set =0: ", "not a dotted key"]),
        (CommandLine, "", &[("contact.nodes.7.gap", "0")], &["--set contact.nodes.7.gap=0: ", "list of 1"]),
        // Wrong types.
        (File, "[harmonics]\ncount = \"ten\"", &[], &["`harmonics.count`", "\"ten\"", "whole number"]),
        (File, "[harmonics]\ncount = 10.5", &[], &["`harmonics.count`", "10.5", "whole number"]),
        (File, "[harmonics]\ncount = -1", &[], &["`harmonics.count`", "-1", "whole number that is not negative"]),
        (File, "harmonics = [20, 512]", &[], &["`harmonics` = [20, 512]", "a section", "[harmonics]"]),
        (File, "continuation.newton = [1e-9]", &[], &["`continuation.newton` = [", "a section"]),
        (File, "damping.rayleigh = [1]", &[], &["`damping.rayleigh` = [1]", "a section"]),
        (File, "contact = [1e-3]", &[], &["`contact` = [0.001]", "a section", "[contact]"]),
        (File, "[contact]\ngap = \"wide\"", &[], &["`contact.gap`", "\"wide\"", "a number"]),
        (File, "name = 67", &[], &["`name`", "67", "string"]),
        (File, "name = \" \"", &[], &["`name`", "give a name, or leave the key out"]),
        (CommandLine, "", &[("frequency.min", "low")], &["--set frequency.min=low: ", "\"low\"", "a number"]),
        (CommandLine, "", &[("contact", "0")], &["--set contact=0: ", "`contact` = 0", "a section"]),
        // Impossible values.
        (File, "[harmonics]\ncount = 0", &[], &["`harmonics.count` = 0", "1 to 400"]),
        (File, "[harmonics]\ncount = 200", &[], &["`harmonics.samples` (set by default) = 512", "at least 800"]),
        (File, "[frequency]\nmin = 3\nmax = 2", &[], &["`frequency.max` = 2", "above frequency.min = 3"]),
        (File, "[frequency]\nmin = nan", &[], &["`frequency.min` = NaN", "finite number above zero"]),
        (File, "[backbone]\nmode = 3", &[], &["`backbone.mode` = 3", "modes 1 to 2"]),
        (File, "[backbone]\nmodes = [1, 5]", &[], &["`backbone.modes` = [1, 5]", "modes 1 to 2"]),
        (File, "[backbone]\nmodes = [2, 2]", &[], &["`backbone.modes` = [2, 2]", "comes twice"]),
        (File, "[backbone]\nmodes = []", &[], &["`backbone.modes` = []", "at least one mode"]),
        (File, "[backbone]\nmodes = \"all\"", &[], &["`backbone.modes`", "\"auto\" or a list of mode numbers"]),
        (File, "[backbone]\nmode = 1\nmodes = [1]", &[], &["`backbone`", "backbone.modes", "only one of them"]),
        (CommandLine, "", &[("backbone.modes", "2,7")], &["--set backbone.modes=2,7: ", "modes 1 to 2"]),
        (File, "[contact]\nfriction = -1", &[], &["`contact.friction` = -1", "zero or positive"]),
        (File, "[contact]\ngap = nan", &[], &["`contact.gap` = NaN", "finite, zero or positive", "in m"]),
        (File, "[contact]\nsense = 2", &[], &["`contact.sense` = 2", "1 or -1"]),
        (File, "[forcing]\nharmonic = 11", &[], &["`harmonics.count` (set by default) = 10", "at least 11"]),
        (File, "monitors = [\"tipp\"]", &[], &["`monitors[0]`", "`tipp`", "did you mean `tip`"]),
        (CommandLine, "", &[("contact.friction", "-1")], &["--set contact.friction=-1: ", "zero or positive"]),
        (CommandLine, "", &[("contact.epsilon", "0")], &["--set contact.epsilon=0: ", "`contact.epsilon` = 0", "N/m"]),
        (CommandLine, "", &[("harmonics.samples", "8")], &["--set harmonics.samples=8: ", "= 8", "at least 40"]),
        (CommandLine, "", &[("frequency.max", "-4")], &["--set frequency.max=-4: ", "= -4", "above zero"]),
        // The model and its files.
        (File, "model = \"../nowhere\"", &[], &["`model` = \"../nowhere\"", "no folder", "relative to"]),
        (File, "model = \"model.toml\"", &[], &["`model` = \"model.toml\"", "no folder", "that holds model.toml"]),
        (File, "model = \"empty\"", &[], &["`model` = \"empty\"", "no model.toml in", "that holds model.toml"]),
        (CommandLine, "", &[("model", "x")], &["--set model=x: ", "`model` = \"x\"", "no folder"]),
        (File, "[matrices]\nstiffness = \"soft.mtx\"", &[], &["soft.mtx: `matrices.stiffness` (set by ", "beside"]),
        (
            CommandLine,
            "",
            &[("matrices.stiffness", "soft.mtx")],
            &["soft.mtx: `matrices.stiffness` (set by --set matrices.stiffness=soft.mtx)", "beside model.toml"],
        ),
        (
            CommandLine,
            "",
            &[("damping.ratios.0.x", "1")],
            &["damping.ratios[0]", "`x`", "known here: `modes`, `ratio`"],
        ),
        // Amplitudes.
        (File, "amplitudes = \"20:150:20\"", &[], &["`amplitudes` = 20:150:20", "140 and 160", "20:140:20"]),
        (File, "amplitudes = [20, -1]", &[], &["`amplitudes` = -1", "above zero"]),
        (File, "amplitudes = [20, nan]", &[], &["`amplitudes` = nan", "finite"]),
        (File, "amplitudes = []", &[], &["`amplitudes` = []", "at least one"]),
        (File, "amplitudes = {a = 1}", &[], &["`amplitudes` = (table)", "give a list"]),
        (CommandLine, "", &[("amplitudes.0", "5")], &["--set amplitudes.0=5: ", "all amplitudes at once"]),
        (CommandLine, "", &[("amplitudes", "1:2")], &["--set amplitudes: `amplitudes` = 1:2", "start:stop:step"]),
    ];
    for &(at, extra, set, parts) in cases {
        let amplitudes = if extra.starts_with("amplitudes") { "" } else { "amplitudes = 20\n" };
        let dir = folder(&format!("{amplitudes}{extra}"));
        fs::create_dir(dir.path().join("empty")).unwrap();
        let message = Study::load(dir.path(), &pairs(set), None).expect_err(extra).to_string();
        says(&message, parts);
        match at {
            File => says(&message, &["study.toml"]),
            CommandLine => {
                says(&message, &["--set "]);
                assert!(!message.contains("study.toml"), "{message} blames the study");
            }
        }
    }
}

#[test]
fn more_bad_input() {
    let missing = Study::load(folder("").path(), &[], None).unwrap_err().to_string();
    says(&missing, &["study.toml", "`amplitudes` is not given", "20:140:20", "--amplitudes"]);
    let below =
        Study::load(folder("[frequency]\nmin = 1\namplitudes = [1, 2]").path(), &[], None).unwrap_err().to_string();
    says(&below, &["`amplitudes` is not given", "stands in the section [frequency]: move it above the first section"]);
    let typed = Study::load(folder(STUDY).path(), &[], Some("5:1:1")).unwrap_err().to_string();
    says(&typed, &["--amplitudes: `amplitudes` = 5:1:1", "5:1:-1"]);
    // What is wrong in the model is the model's fault, whatever the study sets beside it.
    let dir = folder("amplitudes = 20\n[contact]\ngap = 0");
    fs::write(dir.path().join("model.toml"), MODEL.replace("friction = 0.2", "friction = -2")).unwrap();
    let error = Study::load(dir.path(), &pairs(&[("contact.sense", "1")]), None).unwrap_err().to_string();
    says(&error, &["model.toml: `contact.friction` = -2", "zero or positive"]);
    fs::write(dir.path().join("model.toml"), format!("harmonics = 3\n{MODEL}")).unwrap();
    says(
        &Study::load(dir.path(), &[], None).unwrap_err().to_string(),
        &["model.toml: `harmonics`: this belongs to a study: move it to study.toml"],
    );
    // Not TOML: the place is shown below the message.
    for text in ["amplitudes = [20,\n", "amplitudes = 20\n[contact\n", "amplitudes = 1\namplitudes = 2"] {
        let error = Study::load(folder(text).path(), &[], None).unwrap_err().to_string();
        let parts = ["study.toml: not valid TOML", "line ", "column "];
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
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
    assert_eq!(differ(STUDY, &[("contact.nodes.0.radius", "0.5")]), ["contact.nodes.0.radius: 0.25 → 0.5"]);
    assert_eq!(differ(STUDY, &[("frequency.max", "9")]), ["frequency.max: not given → 9.0"]);
    assert_eq!(differ(&STUDY.replace("min = 0.5", ""), &[]), ["frequency.min: 0.5 → not given"]);
    let both = differ(STUDY, &[("harmonics.count", "9"), ("amplitudes", "20,40")]);
    assert_eq!(both, ["amplitudes: [\"20\", \"40\", \"60\"] → [\"20\", \"40\"]", "harmonics.count: 7 → 9"]);
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

proptest! {
    /// Whatever is typed, the answer is a study or an error.
    #[test]
    fn nothing_panics(at in 0.0..1.0_f64, length in 0..20_usize, text in "[-a-z0-9 .=:\\[\\]{}\"\n]{0,12}", key in "[a-z. ]{0,16}") {
        let start = (at * STUDY.len() as f64) as usize;
        let study = format!("{}{text}{}", &STUDY[..start], &STUDY[(start + length).min(STUDY.len())..]);
        let refused = Study::load(folder(&study).path(), &[], None).err();
        prop_assert!(refused.is_none_or(|error| !error.to_string().is_empty()));
        let dir = folder(STUDY);
        let _ = Study::load(dir.path(), &pairs(&[(&key, &text), ("contact.gap", &text)]), Some(&text));
        let _ = Study::load(dir.path(), &pairs(&[("harmonics.count", &text), ("amplitudes", &text)]), None);
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
