//! Pages: the report at every stage of a run, and the live one.

use crate::stand_in::StandIn;
use crate::{BRIEF, DAMPER, FINE, LEVELS, LONG};
use protocol::to_worker::Acknowledgement;
use rustix::process::Signal;
use serde_json::Value;
use std::collections::HashSet;
use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use tests::{PATIENCE, Process, System, block_on, complaint, isola, program};

/// What the page of `isola report` shows, and what the command says is missing.
fn report(system: &System) -> (Value, String) {
    let output = isola(&["report", &system.directory_text()]);
    assert!(output.status.success(), "{}", complaint(&output));
    let page = fs::read_to_string(system.directory().join("report.html")).unwrap();
    let data = page.split_once("id=\"data\">").unwrap().1.split_once("</script>").unwrap().0;
    (serde_json::from_str(data).unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_report_at_every_stage() {
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, LONG, &["--stay"]].concat());
    block_on(async {
        let holder = StandIn::of(&system).await;
        let held = holder.grant().await;
        let _worker = system.worker();
        system.reaches("a branch", |status| status.tasks.branches > 0).await;
        let (running, notes) = report(&system);
        assert_eq!(running["run"]["stage"], "sweep");
        assert!(!running["branches"].as_array().unwrap().is_empty());
        assert!(notes.contains("still to be done, at A = "), "{notes}");

        assert!(isola(&["cancel", &system.directory_text()]).status.success());
        assert_eq!(holder.release(&held).await, Acknowledgement::Ok);
    });
    system.coordinator.signal(Signal::INT);
    assert_eq!(system.coordinator.wait().code(), Some(3));
    let (cancelled, notes) = report(&system);
    assert_eq!(cancelled["run"]["stage"], "cancelled");
    assert!(notes.contains("still to be done, at A = "), "{notes}");

    system.resume(&["--workers", "2"]);
    system.expect_complete();
    let (finished, notes) = report(&system);
    assert_eq!((finished["run"]["missing"].as_array().unwrap().len(), &*notes), (0, ""));
    assert_eq!(finished["branches"].as_array().unwrap().len() as i64, system.number("SELECT count(*) FROM branches"));
    assert!(finished["verdict"][2]["text"].as_str().unwrap().starts_with("Yes. At A = 0.0"), "{}", finished["verdict"]);
}

/// The events of a live page, from the first to the end of the run.
fn events(place: &str) -> Vec<(String, Value)> {
    let text = get(place, "/events", "event: end");
    let event = |block: &str| {
        let field = |name: &str| block.lines().find_map(|line| line.strip_prefix(name));
        Some((field("event: ")?.to_string(), serde_json::from_str(field("data: ")?).unwrap()))
    };
    text.split("\n\n").filter_map(event).collect()
}

/// What is answered to a request, at least until `mark` has come.
fn get(place: &str, path: &str, mark: &str) -> String {
    let mut stream = TcpStream::connect(place).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {place}\r\nConnection: close\r\n\r\n").unwrap();
    let (mut bytes, mut part) = (Vec::new(), [0; 1 << 16]);
    loop {
        let count = stream.read(&mut part).unwrap();
        bytes.extend_from_slice(&part[..count]);
        let text = unchunked(&bytes);
        if count == 0 || text.contains(mark) && text.ends_with("\n\n") {
            return text;
        }
    }
}

/// The body of an answer, chunked or not.
fn unchunked(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let Some((head, mut rest)) = text.split_once("\r\n\r\n") else { return String::new() };
    if !head.contains("chunked") {
        return rest.into();
    }
    let mut body = String::new();
    while let Some((size, content)) = rest.split_once("\r\n") {
        let Some(chunk) = usize::from_str_radix(size, 16).ok().and_then(|size| content.get(..size)) else { break };
        body += chunk;
        rest = content.get(chunk.len() + 2..).unwrap_or("");
    }
    body
}

/// An event with its name.
type Event = (String, Value);

/// What is told to every browser: of statuses, and of axes with labels, only the latest.
fn lasting(events: &[Event]) -> (Vec<&Event>, Option<&Event>) {
    let lasts = |(name, _): &&Event| name != "status" && name != "figure";
    (events.iter().filter(lasts).collect(), events.iter().rev().find(|(name, _)| name == "figure"))
}

/// Whoever opens the live page, early or late, is given every branch.
#[test]
fn the_live_page() {
    let mut system = System::sweep(DAMPER, &[LEVELS, &["--search", "none", "--stay"]].concat());
    let log = system.folder().join("page.log");
    let mut page = Process::start(&program("isola"), &["watch", &system.directory_text(), "--page"], &log);
    system.eventually("a page", |_| page.output().contains(" shows the run"));
    let place = page.output().split_once("http://").unwrap().1.split(' ').next().unwrap().to_string();
    assert!(get(&place, "/", "</html>").contains("EventSource"));
    let start: Value = serde_json::from_str(&get(&place, "/data", "}")).unwrap();
    assert_eq!(start["levels"].as_array().unwrap().len(), 2);

    let _worker = system.worker();
    let early = events(&place);
    // A branch comes again with what marching says of it.
    let branch = |(event, told): &(String, Value)| {
        (event == "branch").then(|| ["level", "kind", "number"].map(|part| told["branch"][part].to_string()))
    };
    let branches: HashSet<[String; 3]> = early.iter().filter_map(branch).collect();
    assert_eq!(branches.len() as i64, system.number("SELECT count(*) FROM branches"));
    assert!(early.iter().any(|(event, _)| event == "status"));
    let late = events(&place);
    assert!(lasting(&early) == lasting(&late), "late and early browsers are told different things");

    // Whoever starts these tests in the background has them ignore SIGINT, and a page does not listen to signals.
    page.signal(Signal::TERM);
    page.wait();
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
}

#[test]
fn pages_that_cannot_be_served() {
    let mut system = System::sweep_with(DAMPER, &[LEVELS, BRIEF, &["--workers", "2"]].concat());
    system.expect_complete();
    let refused = isola(&["watch", &system.directory_text(), "--page"]);
    assert!(!refused.status.success());
    assert!(complaint(&refused).contains("isola report"), "{}", complaint(&refused));
    let refused = isola(&["report", &system.directory_text(), "--levels", "7"]);
    assert!(complaint(&refused).contains("--levels 7: the run has no such level, but"), "{}", complaint(&refused));
    let refused = isola(&["report", &system.directory_text(), "-o", "/nowhere/report.html"]);
    assert!(complaint(&refused).contains("/nowhere/report.html"), "{}", complaint(&refused));
    let refused = isola(&["report", "/nowhere"]);
    assert!(!refused.status.success() && complaint(&refused).contains("/nowhere"), "{}", complaint(&refused));
}
