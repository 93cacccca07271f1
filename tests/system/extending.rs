//! Levels that are added to a run: what was computed stays, and everything is as if all levels had been there from the beginning.

use crate::{DAMPER, FINE, LONG};
use rustix::process::Signal;
use std::process::Output;
use tests::{Process, System, complaint, isola, results};

/// What is stored of a level, to the byte, and by whom.
fn stored(system: &System, level: &str) -> String {
    let sql = format!(
        "SELECT group_concat(task || ' ' || attempt || ' ' || worker || ' ' || sha256) FROM (SELECT results.* FROM results \
         JOIN tasks ON tasks.id = results.task JOIN levels USING (level) WHERE amplitude = '{level}' ORDER BY task)"
    );
    results::text(&system.directory(), &sql)
}

fn extend(system: &System, amplitudes: &str) -> Output {
    isola(&["extend", &system.directory_text(), "--amplitudes", amplitudes, "--workers", "2"])
}

/// Few harmonics and random starts: these are most of a search, and none of them matters here.
const COARSE: &[&str] = &["--set", "harmonics.count=3", "--set", "search.starts=512"];

/// The run that has all levels from the beginning.
fn at_once(amplitudes: &str, more: &[&str]) -> System {
    let mut system = System::sweep_with(DAMPER, &[&["--amplitudes", amplitudes, "--workers", "2"], more].concat());
    system.expect_complete();
    system
}

fn assert_same(one: &System, other: &System) {
    let [one, other] = [one, other].map(|system| results::summary(&system.directory()));
    assert!(!one.is_empty());
    results::assert_same(&one, &other);
}

#[test]
fn a_finished_run_has_more_levels() {
    let mut system = at_once("0.007,0.011", COARSE);
    let before = ["0.007", "0.011"].map(|level| stored(&system, level));
    let there = extend(&system, "0.011,7e-3");
    assert_eq!(there.status.code(), Some(2), "{}", complaint(&there));
    assert!(complaint(&there).contains("the run has all of these levels"), "{}", complaint(&there));

    let extended = extend(&system, "0.007:0.011:0.002");
    assert!(extended.status.success(), "{}", complaint(&extended));
    for (level, before) in std::iter::zip(["0.007", "0.011"], before) {
        let after = stored(&system, level);
        assert!(before.split(',').all(|result| after.contains(result)), "computed again: {before}\n{after}");
    }
    results::assert_stored_once(&system.directory());
    let once = at_once("0.007,0.011,0.009", COARSE);
    assert_same(&system, &once);
    for run in [&system, &once] {
        let levels = "SELECT group_concat(amplitude) FROM (SELECT amplitude FROM levels ORDER BY level)";
        assert_eq!(results::text(&run.directory(), levels), "0.007,0.011,0.009");
        let crossings = "SELECT count(*) FROM tasks WHERE kind = 'crossing' AND level = 3 AND state = 'done'";
        assert!(run.number(crossings) > 0, "no curve was crossed");
    }
    let verified = "SELECT count(*) FROM verifications";
    assert_eq!(system.number(verified), once.number(verified));
    // It goes on as any other: its study is that of all levels.
    system.resume(&["--workers", "0"]);
    system.expect_complete();
}

#[test]
fn an_interrupted_run_has_more_levels() {
    let more = [FINE, LONG, &["--search", "none", "--verify", "none"]].concat();
    let mut system = System::sweep(DAMPER, &[&["--amplitudes", "0.009"], &more[..]].concat());
    let worker = system.worker();
    system.eventually("a result", |system| system.number("SELECT count(*) FROM results") > 0);
    let conducted = extend(&system, "0.007");
    assert_eq!(conducted.status.code(), Some(1), "{}", complaint(&conducted));
    system.coordinator.signal(Signal::INT);
    assert_eq!(system.coordinator.wait().code(), Some(130), "{}", system.coordinator.output());
    drop::<Process>(worker);
    assert!(system.number("SELECT count(*) FROM tasks WHERE state IN ('waiting', 'leased')") > 0, "it is finished");
    let extended = extend(&system, "0.007");
    assert!(extended.status.success(), "{}", complaint(&extended));
    results::assert_stored_once(&system.directory());
    assert_same(&system, &at_once("0.009,0.007", &more));
}

/// Of a run that has no backbone yet only the study grows; the backbone comes when it goes on.
#[test]
fn a_run_without_a_backbone_has_more_levels() {
    let endless = ["--set", "continuation.max_step=1e-8", "--set", "continuation.initial_step=1e-9"];
    let more = [&["--amplitudes", "0.009", "--set", "continuation.min_step=1e-10"], &endless[..]].concat();
    let mut system = System::sweep(DAMPER, &more);
    system.coordinator.signal(Signal::INT);
    assert_eq!(system.coordinator.wait().code(), Some(130), "{}", system.coordinator.output());
    assert_eq!(system.number("SELECT count(*) FROM tasks"), 0);
    let (run, log) = (system.directory_text(), system.folder().join("extended.log"));
    let arguments = ["extend", &run, "--amplitudes", "0.007", "--workers", "0"];
    let extended = Process::start(&tests::program("isola"), &arguments, &log);
    system.eventually("both levels", |system| system.number("SELECT count(*) FROM levels") == 2);
    system.eventually("a coordinator", |system| system.directory().join("address").exists());
    assert_eq!(system.wait_until("both levels", |status| status.levels == 2).tasks.done, 0);
    extended.signal(Signal::INT);
}
