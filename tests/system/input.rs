//! Bad input: one clear message, exit code not zero, nothing lost.

use crate::DAMPER;
use protocol::from_worker::LeaseRequest;
use protocol::ids::WorkerId;
use protocol::session::request;
use protocol::to_worker::LeaseReply;
use std::net::TcpListener;
use std::process::Output;
use tests::{PATIENCE, System, block_on, complaint, isola, isola_each, repository};

/// A level of which only what is needed is computed.
const QUICK: [&str; 6] = ["--amplitudes", "0.004", "--search", "none", "--verify", "none"];

/// Ends with an error whose message has all of these parts.
fn refused(arguments: &[&str], parts: &[&str]) {
    assert_refused(&isola(arguments), arguments, parts);
}

fn assert_refused(output: &Output, arguments: &[&str], parts: &[&str]) {
    let complaint = complaint(output);
    assert!(!output.status.success(), "{arguments:?} is accepted");
    for part in parts {
        assert!(complaint.contains(part), "{arguments:?}: {part:?} is not in:\n{complaint}");
    }
    assert!(!complaint.contains("panicked"), "{complaint}");
}

fn study() -> String {
    repository(DAMPER).display().to_string()
}

#[test]
fn studies() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run").display().to_string();
    let sweep = |more: &[&str], parts: &[&str]| {
        refused(&[&["sweep", &study(), "--out", &out], more].concat(), parts);
        assert!(!std::path::Path::new(&out).exists(), "something was left in {out}");
    };
    sweep(&["--amplitudes", ""], &["amplitude"]);
    sweep(&["--amplitudes", "-1"], &["amplitudes", "-1"]);
    sweep(&["--amplitudes", "20:10:5"], &["amplitudes", "20:10:5"]);
    sweep(&["--set", "contact.frictoin=0"], &["contact.frictoin", "did you mean `friction`"]);
    sweep(&["--set", "harmonics.count=0"], &["harmonics.count", "0"]);
    sweep(&["--set", "harmonics.count"], &["key=value"]);
    sweep(&["--lease", "0"], &["--lease", "use 0.5 to 86400 seconds"]);
    sweep(&["--namespace", "a/*"], &["--namespace"]);
    sweep(&["--listen", "7447"], &["7447", "tcp/HOST:7447"]);
    refused(&["sweep", "nowhere.toml"], &["nowhere.toml"]);
}

#[test]
fn a_port_in_use() {
    let holder = TcpListener::bind("127.0.0.1:0").unwrap();
    let endpoint = format!("tcp/{}", holder.local_addr().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run").display().to_string();
    refused(&["sweep", &study(), "--out", &out, "--listen", &endpoint], &[&endpoint, "in use"]);
    assert!(!std::path::Path::new(&out).exists());
}

#[test]
fn no_coordinator() {
    let closed = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let endpoint = format!("tcp/{closed}");
    refused(&["status", "--connect", &endpoint], &[&endpoint, "isola sweep"]);
    refused(&["worker", "--connect", &endpoint, "--wait", "1"], &[&endpoint]);
}

#[test]
fn folders_that_are_no_runs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().display().to_string();
    for command in ["resume", "status", "export", "watch", "cancel", "retry-dead"] {
        refused(&[command, &path], &[&path]);
    }
    let store = folder.path().join("run.sqlite");
    std::fs::write(&store, "not a database, but long enough to be taken for one by whoever does not look closely")
        .unwrap();
    for command in ["resume", "status", "export"] {
        refused(&[command, &path], &["run.sqlite"]);
    }
    std::fs::remove_file(&store).unwrap();
    rusqlite::Connection::open(&store).unwrap().execute_batch("CREATE TABLE a (b)").unwrap();
    for command in ["resume", "status", "export"] {
        refused(&[command, &path], &["run.sqlite"]);
    }
}

#[test]
fn a_run_that_is_there_already() {
    let mut system = System::sweep_with(DAMPER, &[&QUICK[..], &["--workers", "1"]].concat());
    system.expect_complete();
    let directory = system.directory_text();
    refused(&["sweep", &study(), "--out", &directory], &[&directory, "resume"]);
    tests::results::assert_stored_once(&system.directory());
}

#[test]
fn a_study_edited_between_run_and_resume() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("model");
    std::fs::create_dir(&model).unwrap();
    for file in ["model.toml", "study.toml"] {
        std::fs::copy(repository("models/nonlinear_damper").join(file), model.join(file)).unwrap();
    }
    let study = model.join("study.toml").display().to_string();
    let run = folder.path().join("run").display().to_string();
    let swept = isola(&[&["sweep", &study, "--out", &run, "--workers", "1"], &QUICK[..]].concat());
    assert!(swept.status.success(), "{}", complaint(&swept));
    let edited = std::fs::read_to_string(model.join("model.toml")).unwrap().replace("default_ratio", "# default_ratio");
    std::fs::write(model.join("model.toml"), edited).unwrap();
    refused(&["resume", &run], &["study.toml", "changed", "--as-started"]);
    let resumed = isola(&["resume", &run, "--as-started", "--workers", "1"]);
    assert!(resumed.status.success(), "{}", complaint(&resumed));
}

#[test]
fn a_run_that_is_going_on() {
    let system = System::sweep(DAMPER, &QUICK);
    let directory = system.directory_text();
    refused(&["resume", &directory], &[&directory]);
}

#[test]
fn a_worker_of_another_run_or_version() {
    let mut system = System::sweep(DAMPER, &QUICK);
    let (address, secret) = (system.address(), system.secret_file().display().to_string());
    let worker = ["worker", "--connect", &address, "--secret-file", &secret, "--wait", "15"];
    let elsewhere = [["--run", "elsewhere"], ["--namespace", "other"]];
    let commands = elsewhere.map(|place| [&worker[..], &place].concat());
    for ((output, arguments), [_, name]) in isola_each(&commands).iter().zip(&commands).zip(elsewhere) {
        assert_refused(output, arguments, &[name, &address]);
    }
    let _worker = system.worker();
    system.expect_complete();
}

/// A worker of another version is told so, and gets no work.
#[test]
fn a_worker_that_speaks_another_version() {
    let mut system = System::sweep(DAMPER, &QUICK);
    block_on(async {
        let (session, keys, _) = system.viewer().await;
        let question = LeaseRequest {
            protocol: protocol::VERSION + 1,
            program: "99.0.0".into(),
            worker: WorkerId::new("newer").unwrap(),
            slot: 0,
        };
        let LeaseReply::Stop { reason } = request(&session, &keys.lease(), &question, PATIENCE).await.unwrap() else {
            panic!("it got work");
        };
        let [own, other] = [0, 1].map(|by| format!("version {}", protocol::VERSION + by));
        for part in ["newer", &own, "99.0.0", &other, protocol::PROGRAM] {
            assert!(reason.contains(part), "{reason}");
        }
    });
    let _worker = system.worker();
    system.expect_complete();
}
