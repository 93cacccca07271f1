//! What orchestrators, Prometheus and browsers are told: over HTTP, by `isola health`, as JSON.

use crate::{BRIEF, DAMPER, FINE, LEVELS, LONG, SHORT};
use rustix::process::Signal;
use serde_json::Value;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt;
use tests::{PATIENCE, System, complaint, isola};

/// A port that the system chooses, on the loopback interface.
const HTTP: &[&str] = &["--http", "127.0.0.1:0"];

/// An answer: code, head and body.
struct Answer {
    code: u16,
    head: String,
    body: String,
}

/// Where the run is served over HTTP.
fn place(system: &System) -> String {
    let file = system.directory().join("http");
    system.eventually("an address", |_| file.exists());
    std::fs::read_to_string(file).unwrap().trim().strip_prefix("http://").unwrap().to_string()
}

/// The token of a run.
fn token(system: &System) -> String {
    std::fs::read_to_string(system.directory().join("http-token")).unwrap().trim().to_string()
}

fn get(place: &str, path: &str, headers: &[&str]) -> Answer {
    get_until(place, path, headers, |_| false)
}

/// What has come when something is there, or everything.
fn get_until(place: &str, path: &str, headers: &[&str], is_there: impl Fn(&str) -> bool) -> Answer {
    let mut stream = TcpStream::connect(place).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let host = if headers.iter().any(|header| header.starts_with("Host:")) {
        String::new()
    } else {
        format!("Host: {place}\r\n")
    };
    let headers: String = headers.iter().map(|header| format!("{header}\r\n")).collect();
    write!(stream, "GET {path} HTTP/1.1\r\n{host}{headers}Connection: close\r\n\r\n").unwrap();
    let (mut bytes, mut part) = (Vec::new(), vec![0; 1 << 16]);
    loop {
        let count = stream.read(&mut part).unwrap();
        bytes.extend_from_slice(&part[..count]);
        if count == 0 || is_there(&String::from_utf8_lossy(&bytes)) {
            break;
        }
    }
    let text = String::from_utf8_lossy(&bytes);
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    let code = head.split(' ').nth(1).unwrap().parse().unwrap();
    Answer { code, head: head.to_string(), body: body.to_string() }
}

/// The sum of the values of a metric whose labels contain something.
fn metric(text: &str, name: &str, labels: &str) -> Option<f64> {
    let lines = text.lines().filter(|line| !line.starts_with('#') && line.contains(labels));
    let of_name = lines.filter_map(|line| {
        let (series, value) = line.rsplit_once(' ')?;
        (series.split('{').next() == Some(name)).then(|| value.parse::<f64>().unwrap())
    });
    of_name.reduce(|a, b| a + b)
}

fn metrics(system: &System, place: &str) -> String {
    let answer = get(place, "/metrics", &[&format!("Authorization: Bearer {}", token(system))]);
    assert_eq!(answer.code, 200, "{}", answer.body);
    answer.body
}

/// Connections that ask nothing are closed, and do not keep others from being answered.
#[test]
fn connections_that_never_ask() {
    let system = System::sweep(DAMPER, &[LEVELS, BRIEF, HTTP, LONG].concat());
    let place = place(&system);
    let silent: Vec<TcpStream> = (0..300).map(|_| TcpStream::connect(&place).unwrap()).collect();
    assert_eq!(get(&place, "/healthz", &[]).code, 200);
    for mut stream in silent.into_iter().take(3) {
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        assert!(answer.is_empty() || answer.starts_with(b"HTTP/1.1 408"), "{}", String::from_utf8_lossy(&answer));
    }
}

/// Everybody may ask whether the process lives, and nothing else; with the token everything is told.
#[test]
fn over_http_who_has_the_token_reads() {
    let mut system = System::sweep(DAMPER, &[LEVELS, HTTP, &["--search", "none", "--stay"]].concat());
    let place = place(&system);
    assert_eq!((get(&place, "/healthz", &[]).code, &*get(&place, "/healthz", &[]).body), (200, "ok\n"));
    let secret = std::fs::read_to_string(system.secret_file()).unwrap();
    let secret = secret.trim().strip_prefix("isola:").unwrap();
    for path in ["/", "/data", "/events", "/metrics", "/nowhere", "/?token=", &format!("/?token={secret}")] {
        for header in ["Accept: */*", "Authorization: Bearer nonsense", &format!("Authorization: Bearer {secret}")] {
            let answer = get(&place, path, &[header]);
            assert_eq!(answer.code, 401, "{path} {header}");
            assert!(answer.body.contains("http-token"), "{}", answer.body);
        }
    }

    // A browser is sent to the page with a cookie, and without the token in the address.
    let (token, mode) =
        (token(&system), std::fs::metadata(system.directory().join("http-token")).unwrap().permissions());
    assert_eq!(mode.mode() & 0o777, 0o600);
    let told = format!("http://{place} shows the run as it goes on, to who has the token in");
    system.eventually("where it is shown", |system| system.coordinator.output().contains(&told));
    let sent = get(&place, &format!("/?token={token}"), &[]);
    let header =
        |name: &str| sent.head.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default().to_string();
    assert_eq!((sent.code, &*header("location: ")), (303, "/"));
    let cookie = header("set-cookie: ");
    assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"), "{cookie}");
    let cookie = format!("Cookie: {}", cookie.split(';').next().unwrap());
    assert!(get(&place, "/", &[&cookie]).body.contains("EventSource"));
    let data: Value = serde_json::from_str(&get(&place, "/data", &[&cookie]).body).unwrap();
    assert_eq!(data["levels"].as_array().unwrap().len(), 2);
    // Under any name: no page of somebody else's has the token.
    let bearer = format!("Authorization: Bearer {token}");
    assert_eq!(get(&place, "/metrics", &["Host: coordinator.cluster.local:8080", &bearer]).code, 200);

    system.eventually("tasks to hand out", |system| {
        metric(&metrics(system, &place), "isola_queue_length", "") > Some(0.0)
    });
    let before = metrics(&system, &place);
    assert!(metric(&before, "isola_oldest_waiting_task_seconds", "") >= Some(0.0), "{before}");
    assert_eq!(metric(&before, "isola_leases", ""), Some(0.0), "{before}");
    let _worker = system.worker();
    system.wait_until_finished();
    let carried_out = system.number("SELECT count(*) FROM tasks WHERE state = 'done'") as f64;
    system.eventually("the end in figures", |system| {
        metric(&metrics(system, &place), "isola_tasks", "state=\"done\"") == Some(carried_out)
    });
    let text = metrics(&system, &place);
    assert!(text.ends_with("# EOF\n"), "{text}");
    let stored = |sql: &str| Some(system.number(sql) as f64);
    let told = |name: &str, labels: &str| metric(&text, name, labels);
    assert_eq!(told("isola_results_stored_total", ""), stored("SELECT count(*) FROM results"));
    assert_eq!(told("isola_leases_granted_total", ""), stored("SELECT count(*) FROM attempts"));
    assert_eq!(told("isola_branches", ""), stored("SELECT count(*) FROM branches"));
    for kind in ["main", "land", "seed", "verify"] {
        for state in ["done", "skipped"] {
            let labels = format!("kind=\"{kind}\",state=\"{state}\"");
            let sql = format!("SELECT count(*) FROM tasks WHERE kind = '{kind}' AND state = '{state}'");
            assert_eq!(told("isola_tasks", &labels), stored(&sql), "{labels}");
        }
    }
    assert_eq!((told("isola_queue_length", ""), told("isola_leases", "")), (Some(0.0), Some(0.0)));
    assert_eq!(told("isola_stage", "stage=\"finished\""), Some(1.0));
    // What is stored says a little more than what was sent.
    let share = told("isola_received_bytes_total", "").unwrap() / stored("SELECT sum(size) FROM results").unwrap();
    assert!((0.5..1.5).contains(&share), "{share}");
    assert!(told("isola_commit_seconds_count", "") > Some(0.0) && told("isola_commit_seconds_sum", "") > Some(0.0));
    assert_eq!(told("isola_results_refused_total", ""), Some(0.0));
    // The page has followed the run in the process that conducts it.
    let events = get_until(&place, "/events", &[&cookie], |text| text.contains("event: end"));
    // Every branch has come, and again with what marching says of it.
    let (branches, verifications) = ("SELECT count(*) FROM branches", "SELECT count(*) FROM verifications");
    let come = events.body.matches("event: branch").count() as i64;
    assert_eq!(come, system.number(branches) + system.number(verifications));
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
    assert!(!system.directory().join("http").exists());
}

/// A worker that vanishes is seen in the figures: what it held expires.
#[test]
fn what_expires_is_counted() {
    let mut system = System::sweep(DAMPER, &[LEVELS, FINE, BRIEF, HTTP, SHORT].concat());
    let place = place(&system);
    let _lost = system.expired_worker(|worker| worker.signal(Signal::KILL));
    let expired = |system: &System| metric(&metrics(system, &place), "isola_leases_expired_total", "");
    system.eventually("a lease that expires", |system| expired(system) >= Some(1.0));
    assert_eq!(expired(&system), Some(system.attempts("ending = 'expired'") as f64));
    let _worker = system.worker();
    system.expect_complete();
}

/// Where there is no secret there is no token, and no page under a name of somebody else's.
#[test]
fn without_a_secret_everybody_reads_by_an_address() {
    let system = System::sweep(DAMPER, &[LEVELS, BRIEF, HTTP, LONG, &["--insecure"]].concat());
    let place = place(&system);
    assert!(!system.directory().join("http-token").exists());
    assert!(get(&place, "/", &[]).body.contains("EventSource"));
    assert_eq!(get(&place, "/metrics", &[]).code, 200);
    for path in ["/", "/metrics"] {
        assert_eq!(get(&place, path, &["Host: evil.example"]).code, 421);
    }
    assert_eq!(get(&place, "/healthz", &["Host: coordinator"]).code, 200);
    let taken = isola(&["sweep", &tests::repository(DAMPER).display().to_string(), "--http", &place]);
    assert_eq!(taken.status.code(), Some(1));
    assert!(complaint(&taken).contains(&format!("--http {place}: ")), "{}", complaint(&taken));
}

/// One line and an exit code, whatever there is to tell.
#[test]
fn health_and_status_for_programs() {
    let mut system = System::sweep(DAMPER, &[LEVELS, BRIEF, &["--stay"]].concat());
    let (directory, address) = (system.directory_text(), system.address());
    let secret = system.secret_file().display().to_string();
    let by_address = ["--connect", &address, "--secret-file", &secret];
    system.wait_until("a sweep", |status| status.tasks.waiting > 0);
    for run in [&[&*directory][..], &by_address] {
        let health = isola(&[&["health"], run].concat());
        let said = String::from_utf8(health.stdout.clone()).unwrap();
        assert!(health.status.success(), "{}", complaint(&health));
        assert!(said.lines().count() == 1 && said.contains(", running: "), "{said}");
    }
    let status = |conducted: bool| -> Value {
        let output = isola(&["status", &directory, "--json"]);
        let told: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(told["conducted"], conducted, "{told}");
        told
    };
    assert_eq!(status(true)["stage"], "sweep");
    let stranger = isola(&["health", "--connect", &address]);
    assert_eq!(
        (stranger.status.code(), complaint(&stranger).lines().count()),
        (Some(1), 1),
        "{}",
        complaint(&stranger)
    );

    let _worker = system.worker();
    system.wait_until_finished();
    let told = status(true);
    system.coordinator.signal(Signal::INT);
    system.expect_complete();
    let stored = status(false);
    for key in ["run", "name", "stage", "tasks", "levels", "levels_done", "sequence"] {
        assert_eq!(told[key], stored[key], "{key}");
    }
    let health = isola(&["health", &directory]);
    assert_eq!((health.status.code(), complaint(&health).lines().count()), (Some(1), 1), "{}", complaint(&health));
}

/// Everything that is told on standard error is JSON, also by local workers, also why it ends.
#[test]
fn logs_for_programs() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let study = tests::repository(DAMPER).display().to_string();
    let arguments = ["sweep", &study, "--out", run.to_str().unwrap(), "--workers", "1", "--log-format", "json"];
    let sweep = isola(&[&arguments, LEVELS, BRIEF].concat());
    assert!(sweep.status.success(), "{}", complaint(&sweep));
    let refused = isola(&[&arguments, LEVELS, BRIEF].concat());
    assert_eq!(refused.status.code(), Some(1));
    let worker = std::fs::read_to_string(run.join("logs/worker-1.log")).unwrap();
    for (text, level, part) in [
        (complaint(&sweep), "INFO", "levels"),
        (complaint(&refused), "ERROR", "run"),
        (worker, "INFO", "all work is done"),
    ] {
        let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let is_told =
            |line: &&Value| line["level"] == level && line["message"].as_str().is_some_and(|m| m.contains(part));
        assert!(lines.iter().any(|line| is_told(&line)), "{part}: {text}");
        assert!(lines.iter().all(|line| line["timestamp"].is_string()), "{text}");
    }
}

/// A worker that nobody has work for leaves, and says why.
#[test]
fn a_worker_without_work_leaves() {
    // A backbone that does not end within a test.
    let steps = ["max_step=1e-8", "initial_step=1e-9", "min_step=1e-10"].map(|step| format!("continuation.{step}"));
    let sets = ["backbone.max_points=1000000000"].into_iter().chain(steps.iter().map(String::as_str));
    let sets: Vec<&str> = sets.flat_map(|set| ["--set", set]).collect();
    let mut system = System::sweep(DAMPER, &[LEVELS, &sets].concat());
    let (address, secret) = (system.address(), system.secret_file().display().to_string());
    let fixed = ["worker", "--connect", &address, "--secret-file", &secret, "--slots", "2"];
    let idle = isola(&[&fixed[..], &["--idle-exit", "0.5"]].concat());
    assert_eq!(idle.status.code(), Some(0), "{}", complaint(&idle));
    assert!(complaint(&idle).contains("nothing to do"), "{}", complaint(&idle));
    assert!(system.coordinator.is_running(), "{}", system.coordinator.output());
}
