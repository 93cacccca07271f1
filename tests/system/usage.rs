//! Exit codes: 2 for wrong usage, an option's value included; 1 for everything else that goes wrong.

use crate::{BRIEF, DAMPER, LEVELS};
use tests::{System, complaint, isola, repository};

/// Exits with this code after one message that has these parts.
fn ends(arguments: &[&str], code: i32, parts: &[&str]) {
    let output = isola(arguments);
    let said = complaint(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    assert!(said.starts_with("error: ") && !said.contains("panicked"), "{arguments:?}: {said}");
    for part in parts {
        assert!(said.contains(part), "{arguments:?}: {part:?} is not in:\n{said}");
    }
}

/// A folder that does not come to be.
const NOWHERE: &str = "/nowhere/run";

#[test]
fn options_of_a_sweep() {
    let study = repository(DAMPER).display().to_string();
    let cases: &[(&[&str], &[&str])] = &[
        (&["--lease", "0"], &["--lease", "use 0.5 to 86400 seconds"]),
        (&["--lease", "soon"], &["--lease", "use 0.5 to 86400 seconds"]),
        (&["--namespace", "a/*"], &["--namespace", "letters, digits"]),
        (&["--listen", "7447"], &["7447", "tcp/HOST:7447"]),
        (&["--connect", "host"], &["host", "tcp/HOST:7447"]),
        (&["--workers", "-1"], &["-1"]),
        (&["--workers", "many"], &["--workers", "many"]),
        (&["--amplitudes", ""], &["--amplitudes", "an entry is empty"]),
        (&["--amplitudes", "20:10:5"], &["--amplitudes", "write 20:10:-5"]),
        (&["--set", "harmonics.count"], &["--set", "key=value"]),
        (&["--set", "key=bad"], &["--set key=bad", "known here"]),
        (&["--set", "contact.frictoin=0"], &["--set contact.frictoin=0", "did you mean `friction`"]),
        (&["--set", "harmonics.count=0"], &["--set harmonics.count=0", "1 to 400"]),
        (&["--set", "harmonics.count=ten"], &["--set harmonics.count=ten"]),
        (&["--set", "amplitudes=0"], &["--set amplitudes", "above zero"]),
        (&["--set", "damping.default_ratio=-1"], &["--set damping.default_ratio=-1"]),
        (
            &["--set", "joint.limit=3"],
            &["there is no key `joint`", "a parameter of a law is `laws.NAME.law.KIND.PARAMETER`"],
        ),
        (
            &["--set", "stifness=3"],
            &["there is no key `stifness`; did you mean `matrices.stiffness`? known here: `matrices.stiffness`, "],
        ),
        (
            &["--set", "laws.a b.name=3"],
            &["`laws.a b.name`: not a dotted key", "a name with a space or a dot in quotes"],
        ),
        // The option that was typed is to blame, whichever key it sets.
        (&["--orders", "1/2"], &["--orders 1/2: `search.harmonics`"]),
        (&["--orders", "2,1"], &["--orders 2,1: `search.harmonics`", "in ascending order"]),
        (&["--set", "search.harmonics=[0]"], &["--set search.harmonics=[0]: `search.harmonics`"]),
        (&["--unknown"], &["--unknown"]),
    ];
    for (more, parts) in cases {
        ends(&[&["sweep", &study, "--out", NOWHERE], *more].concat(), 2, parts);
    }
    ends(&["check", &study, "--set", "harmonics.count=0"], 2, &["--set harmonics.count=0"]);
}

#[test]
fn options_of_other_commands() {
    let cases: &[(&[&str], &[&str])] = &[
        (&["nonsense"], &["nonsense"]),
        (&["status"], &["<DIRECTORY>"]),
        (&["status", "--connect", "nonsense"], &["tcp/HOST:7447"]),
        (&["status", "--connect", "tcp/127.0.0.1:1", "--run", "a b"], &["--run", "a b"]),
        (&["cancel", "--connect", "tcp/127.0.0.1:1", "--namespace", "a/*"], &["--namespace"]),
        (&["watch", NOWHERE, "--page", "nonsense"], &["--page", "HOST:PORT"]),
        (&["watch", NOWHERE, "--page", "localhost:99999"], &["--page", "HOST:PORT"]),
        (&["resume", NOWHERE, "--lease", "-3"], &["-3"]),
        (&["export", NOWHERE, "--format", "xls"], &["--format", "csv, mat, npz"]),
        (&["export", NOWHERE, "-o", "results.csv"], &["results.csv", "name a folder"]),
        (&["completions", "abacus"], &["abacus"]),
        (&["worker", "--slots", "0"], &["--slots"]),
        (&["worker", "--namespace", "a/*"], &["--namespace"]),
        (&["worker", "--run", "a b"], &["--run"]),
        (&["worker", "--wait", "-1"], &["-1"]),
        (&["worker", "--connect", "nonsense"], &["tcp/HOST:7447"]),
    ];
    for (arguments, parts) in cases {
        ends(arguments, 2, parts);
    }
}

/// What only the run can tell.
#[test]
fn options_of_what_is_made_of_a_run() {
    let mut system = System::sweep_with(DAMPER, &[LEVELS, BRIEF, &["--workers", "2"]].concat());
    system.expect_complete();
    let run = system.directory_text();
    let file = system.folder().join("figure.svg").display().to_string();
    let balance = ["--figure", "balance"];
    let cases: &[(&[&str], &[&str])] = &[
        (&["--figure", "pie"], &["--figure", "response"]),
        (&["--figure", "response", "--levels", "7"], &["--levels 7", "no such level, but 0.007, 0.009"]),
        (&["--figure", "response", "--levels", "7,0.007,8"], &["--levels 7,8: the run has no such level, but 0.007"]),
        (&["--figure", "response", "--levels", "much"], &["--levels", "not a number"]),
        (&["--figure", "response", "--monitor", "tip"], &["--monitor tip", "no such dof"]),
        (&["--figure", "response", "--along", "omega"], &["--along", "balance, modes"]),
        (&["--figure", "response", "--width", "5"], &["--width", "use 30 to 1000 mm"]),
        (&["--figure", "response", "--height", "wide"], &["--height", "use 30 to 1000 mm"]),
        (&[&balance[..], &["--amplitude", "0"]].concat(), &["--amplitude 0: a number above zero is needed"]),
        (&[&balance[..], &["--amplitude", "much"]].concat(), &["--amplitude much: a number above zero"]),
        (&[&balance[..], &["--along", "time"]].concat(), &["--along", "omega"]),
        (&["--figure", "motion", "--at", "nonsense"], &["--at nonsense", "A/branch/index"]),
        (&["--figure", "motion", "--at", "7/main/1"], &["--at 7", "no such level"]),
        (&["--figure", "motion", "--at", "0.007/isola 9/1"], &["--at", "no such branch"]),
        (&["--figure", "motion", "--at", "0.007/main/1000000"], &["--at", "no point 1000000"]),
    ];
    for (more, parts) in cases {
        ends(&[&["plot", &run, "-o", &file], *more].concat(), 2, parts);
        assert!(!std::path::Path::new(&file).exists());
    }
    ends(&["plot", &run, "--figure", "response", "-o", "figure.jpg"], 2, &["figure.jpg", ".svg, .png or .pdf"]);
    ends(&["report", &run, "--levels", "7"], 2, &["--levels 7: the run has no such level, but"]);
}

/// What is wrong elsewhere is no wrong usage.
#[test]
fn errors_that_no_option_makes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(repository("models/nonlinear_damper/model.toml"), folder.path().join("model.toml")).unwrap();
    let study = folder.path().join("study.toml");
    let file = study.display().to_string();
    for (content, part) in [
        ("amplitudes = 0", "above zero"),
        ("amplitudes = 1\n[harmonics]\ncount = 0", "1 to 400"),
        ("amplitudes = 1\n[contact]\nfrictoin = 0", "frictoin"),
        ("amplitudes = ", "TOML"),
    ] {
        std::fs::write(&study, content).unwrap();
        ends(&["sweep", &file, "--out", NOWHERE], 1, &["study.toml", part]);
    }
    ends(&["sweep", "nowhere.toml"], 1, &["nowhere.toml"]);
    for command in ["resume", "status", "watch", "cancel", "retry-dead", "export", "report"] {
        ends(&[command, NOWHERE], 1, &[NOWHERE]);
    }
    ends(&["status", "--connect", "tcp/127.0.0.1:1"], 1, &["tcp/127.0.0.1:1"]);
}
