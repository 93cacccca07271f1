//! Output that nobody reads any more, as in `isola status RUN | head -1`: no message, and the exit code of what was done.

use crate::{BRIEF, DAMPER, ENDLESS, LEVELS};
use std::io::{PipeWriter, Read, pipe};
use std::process::{Command, ExitStatus, Stdio};
use tests::{System, program, repository};

/// The end of a pipe whose other end is closed.
fn closed() -> PipeWriter {
    pipe().unwrap().1
}

/// Runs `isola` with its standard output closed; what it says on standard error.
fn without_output(arguments: &[&str]) -> (ExitStatus, String) {
    let mut command = Command::new(program("isola"));
    command.args(arguments).stdin(Stdio::null()).stdout(closed()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    (child.wait().unwrap(), said)
}

/// Runs `isola` with nobody to read anything of it, its log included.
fn unheard(arguments: &[&str]) -> ExitStatus {
    let mut command = Command::new(program("isola"));
    command.args(arguments).env("ISOLA_LOG", "debug").stdin(Stdio::null()).stdout(closed()).stderr(closed());
    command.status().unwrap()
}

#[test]
fn commands_end_quietly() {
    let mut system = System::sweep_with(DAMPER, &[LEVELS, BRIEF, &["--workers", "2"]].concat());
    system.expect_complete();
    let (run, study) = (system.directory_text(), repository(DAMPER).display().to_string());
    let figure = system.folder().join("figure.svg").display().to_string();
    let commands: &[&[&str]] = &[
        &["help"],
        &["--version"],
        &["sweep", "--help"],
        &["completions", "bash"],
        &["check", &study],
        &["status", &run],
        &["watch", &run],
        &["retry-dead", &run],
        &["export", &run],
        &["report", &run],
        &["plot", &run, "--figure", "response", "-o", &figure],
    ];
    for arguments in commands {
        let (status, said) = without_output(arguments);
        assert_eq!((status.code(), said.as_str()), (Some(0), ""), "{arguments:?}");
        assert_eq!(unheard(arguments).code(), Some(0), "{arguments:?}");
    }
    assert!(std::path::Path::new(&figure).exists());
    // What goes wrong is told apart all the same.
    assert_eq!(unheard(&["status", "/nowhere"]).code(), Some(1));
    assert_eq!(unheard(&["check", &study, "--set", "harmonics.count=0"]).code(), Some(2));
    assert_eq!(unheard(&["nonsense"]).code(), Some(2));
}

/// A sweep is not done for what it says: it ends with every task done.
#[test]
fn a_sweep_goes_on() {
    let (folder, study) = (tempfile::tempdir().unwrap(), repository(DAMPER).display().to_string());
    let sweep = |name: &str| {
        let run = folder.path().join(name);
        let start = ["sweep", &study, "--workers", "2", "--out", run.to_str().unwrap()];
        [&start[..], LEVELS, BRIEF].concat().into_iter().map(str::to_string).collect::<Vec<_>>()
    };
    let arguments = sweep("heard");
    let (status, said) = without_output(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(status.code(), Some(0), "{said}");
    assert!(!said.contains("panicked") && !said.contains("pipe"), "{said}");
    let arguments = sweep("unheard");
    assert_eq!(unheard(&arguments.iter().map(String::as_str).collect::<Vec<_>>()).code(), Some(0));
    for name in ["heard", "unheard"] {
        tests::results::assert_stored_once(&folder.path().join(name));
        assert!(folder.path().join(name).join("summary.csv").exists());
    }
}

/// Following a run is for whoever reads it: without anybody it ends, and the run goes on.
#[test]
fn watching_ends() {
    let mut system = System::sweep_with(DAMPER, &[ENDLESS, &["--workers", "1"]].concat());
    system.wait_for_a_branch();
    assert_eq!(unheard(&["watch", &system.directory_text()]).code(), Some(0));
    assert!(system.coordinator.is_running());
}
