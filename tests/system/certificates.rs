//! Encrypted connections: who has no valid certificate is not let in, who has one does what its role may, and whoever is refused is
//! told why as far as that can be known. The run's files are those of a run that nobody disturbed.

use crate::hostile::files;
use crate::{BRIEF, DAMPER, LEVELS, LONG};
use coordinator::certificates::{Authority, Validity, write};
use protocol::certificate::{AUTHORITY, CERTIFICATE, Certificate, KEY};
use protocol::control::{ControlReply, ControlRequest};
use protocol::credentials::Credentials;
use protocol::from_worker::LeaseRequest;
use protocol::ids::{TaskId, WorkerId};
use protocol::keys::{Keys, NAMESPACE, all_runs};
use protocol::role::Role;
use protocol::secret::Secret;
use protocol::session::{RequestError, connect, fetch, listen, request};
use protocol::to_everyone::{Manifest, Status};
use protocol::to_worker::LeaseReply;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tests::{PATIENCE, Process, System, block_on, complaint, isola, isola_each, own_endpoint, program};

/// How long somebody who is refused waits: nobody answers.
const SILENCE: Duration = Duration::from_secs(2);

/// An endpoint for encrypted connections that nobody else has.
pub fn endpoint() -> String {
    own_endpoint().replace("tcp/", "tls/")
}

fn host(endpoint: &str) -> &str {
    endpoint.trim_start_matches("tls/").split(':').next().unwrap()
}

pub fn text(path: &Path) -> &str {
    path.to_str().expect("paths are text")
}

/// Certificates by `isola cert`, for a coordinator that is reached at this endpoint.
pub fn certificates(folder: &Path, endpoint: &str) -> PathBuf {
    let made = folder.join("certificates");
    let output = isola(&["cert", text(&made), "--name", host(endpoint)]);
    assert!(output.status.success(), "{}", complaint(&output));
    made
}

fn credentials(folder: &Path, secret: Option<Secret>) -> Credentials {
    Credentials { secret, certificate: Some(Certificate::read(folder).unwrap()) }
}

/// Somebody who is let in, however long that takes on a busy machine.
async fn joined_at(address: &str, credentials: &Credentials) -> zenoh::Session {
    let started = Instant::now();
    loop {
        match connect(address, credentials).await {
            Ok(session) => return session,
            Err(error) => assert!(started.elapsed() < PATIENCE, "{error}"),
        }
    }
}

/// The run, once it can be seen: a router is there before its coordinator is.
async fn run_seen_by(viewer: &zenoh::Session) -> Manifest {
    let started = Instant::now();
    loop {
        match fetch(viewer, &all_runs(NAMESPACE), PATIENCE).await {
            Ok(manifest) => return manifest,
            Err(error) => assert!(started.elapsed() < PATIENCE, "{error}"),
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

/// Zenoh itself, with whatever certificates: of a client, or of a router that listens.
async fn zenoh_with(
    endpoint: &str,
    certificates: &Path,
    is_router: bool,
    has_own: bool,
) -> zenoh::Result<zenoh::Session> {
    let mut config = zenoh::Config::default();
    let file = |name| format!("{:?}", certificates.join(name));
    let (side, mode) = if is_router { ("listen", "router") } else { ("connect", "client") };
    for (key, value) in [
        ("mode".to_string(), format!("{mode:?}")),
        ("scouting/multicast/enabled".into(), "false".into()),
        (format!("{side}/endpoints"), format!("[{endpoint:?}]")),
        (format!("{side}/timeout_ms"), "1000".into()),
        (format!("{side}/exit_on_failure"), "true".into()),
        ("transport/link/tls/root_ca_certificate".into(), file(AUTHORITY)),
        ("transport/link/tls/enable_mtls".into(), has_own.to_string()),
        (format!("transport/link/tls/{side}_certificate"), file(CERTIFICATE)),
        (format!("transport/link/tls/{side}_private_key"), file(KEY)),
    ] {
        config.insert_json5(&key, &value).unwrap();
    }
    zenoh::open(config).await
}

#[test]
fn what_isola_cert_makes() {
    let folder = tempfile::tempdir().unwrap();
    let made = certificates(folder.path(), "tls/10.0.0.1:7447");
    let contents = |path: &str| std::fs::read(made.join(path)).unwrap();
    for role in ["coordinator", "operator", "worker", "viewer"] {
        let key = std::fs::metadata(made.join(role).join(KEY)).unwrap();
        assert_eq!(key.permissions().mode() & 0o777, 0o600);
        let certificate = Certificate::read(&made.join(role)).unwrap();
        assert!((363..=365).contains(&certificate.ends().days_left()), "{}", certificate.ends());
    }
    assert_eq!(std::fs::metadata(made.join("ca.key")).unwrap().permissions().mode() & 0o777, 0o600);
    // Nothing is overwritten; what is missing is made by the same authority.
    let before = [contents("ca.key"), contents("coordinator/tls.key")];
    std::fs::rename(made.join("worker"), made.join("old")).unwrap();
    let again = isola(&["cert", text(&made), "--days", "10"]);
    assert!(again.status.success(), "{}", complaint(&again));
    assert!(String::from_utf8_lossy(&again.stdout).contains("viewer: was there already and stays as it is"));
    assert_eq!([contents("ca.key"), contents("coordinator/tls.key")], before);
    assert_eq!(contents("worker/ca.crt"), contents("old/ca.crt"));
    let renewed = Certificate::read(&made.join("worker")).unwrap();
    assert!((9..=10).contains(&renewed.ends().days_left()), "{}", renewed.ends());
    let other = isola(&["cert", text(&made), "--name", "elsewhere.example"]);
    assert_eq!(other.status.code(), Some(2), "{}", complaint(&other));
}

/// Each with the options that it is started with, and what it is told.
#[test]
fn strangers_are_refused_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let address = endpoint();
    let made = certificates(folder.path(), &address);
    let at = |name: &str| folder.path().join(name);
    // Certificates that have ended, of another authority, of nobody, and ones that only the other side finds wrong.
    let now = Validity::days(1).ends;
    let past = Validity { begins: now - Duration::from_secs(30 * 86_400), ends: now - Duration::from_secs(2 * 86_400) };
    let foreign = Authority::new(Validity::days(1)).unwrap();
    let viewer = |authority: &Authority, validity| authority.issue(Role::Viewer, &[], validity).unwrap();
    write(&at("foreign"), foreign.certificate(), &viewer(&foreign, Validity::days(1))).unwrap();
    write(&at("ended"), foreign.certificate(), &viewer(&foreign, past)).unwrap();
    let trusted = std::fs::read_to_string(made.join(AUTHORITY)).unwrap();
    write(&at("unknown"), &trusted, &viewer(&foreign, Validity::days(1))).unwrap();

    let system = System::sweep(
        DAMPER,
        &[LEVELS, BRIEF, LONG, &["--listen", &address, "--tls", text(&made.join("coordinator"))]].concat(),
    );
    let secret = system.secret_file();
    let plain = address.replace("tls/", "tcp/");
    let status: &[&str] = &["status"];
    let worker: &[&str] = &["worker"];
    let cases = [
        (status, &address, None, 2, "an encrypted connection needs certificates"),
        (worker, &address, None, 2, "an encrypted connection needs certificates"),
        (status, &plain, Some("certificates/viewer"), 2, "only connections to tls/HOST:PORT are encrypted"),
        (status, &plain, None, 1, "can be reached"),
        (status, &address, Some("nowhere"), 2, "`isola cert` makes some"),
        (status, &address, Some("ended"), 2, "the certificate ended on "),
        (status, &address, Some("foreign"), 1, "is of another authority than ca.crt here"),
        (status, &address, Some("unknown"), 1, "it refuses this certificate: of another authority"),
        (worker, &address, Some("certificates/viewer"), 2, "that of a viewer, who may not take tasks"),
        (&["cancel"], &address, Some("certificates/viewer"), 2, "that of a viewer, who may not give orders to a run"),
        (&["retry-dead"], &address, Some("certificates/worker"), 2, "that of a worker, who may not give orders"),
        (worker, &address, Some("certificates/operator"), 2, "that of an operator, who may not take tasks"),
        (&["retry-dead"], &address, Some("certificates/operator"), 0, ""),
        (&["status"], &address, Some("certificates/operator"), 0, ""),
    ];
    let folders = cases.map(|(_, _, tls, _, _)| tls.map(at));
    let commands: Vec<Vec<&str>> = std::iter::zip(&cases, &folders)
        .map(|(&(command, endpoint, ..), tls)| {
            let tls = tls.iter().flat_map(|tls| ["--tls", text(tls)]);
            command.iter().copied().chain(["--connect", endpoint, "--secret-file", text(&secret)]).chain(tls).collect()
        })
        .collect();
    for (output, (command, _, tls, code, expected)) in std::iter::zip(isola_each(&commands), cases) {
        let said = complaint(&output);
        assert_eq!(output.status.code(), Some(code), "{command:?} {tls:?}: {said}");
        assert!(said.contains(expected), "{command:?} {tls:?}: {said}");
    }
    // Without the secret a certificate is not enough.
    let output = isola(&["status", "--connect", &address, "--tls", text(&at("certificates/viewer"))]);
    assert!(complaint(&output).contains("name a copy of it with --secret-file"), "{}", complaint(&output));
    // Somebody who does not ask this program: no certificate, and one that has ended.
    let late = at("late");
    std::fs::create_dir(&late).unwrap();
    std::fs::copy(made.join(AUTHORITY), late.join(AUTHORITY)).unwrap();
    std::fs::copy(at("ended").join(CERTIFICATE), late.join(CERTIFICATE)).unwrap();
    std::fs::copy(at("ended").join(KEY), late.join(KEY)).unwrap();
    block_on(async {
        assert!(zenoh_with(&address, &late, false, true).await.is_err(), "let in");
        assert!(zenoh_with(&address, &made.join("viewer"), false, false).await.is_err(), "let in");
    });
    // By the folder of the run nothing has to be named.
    let output = isola(&["health", &system.directory_text()]);
    assert!(output.status.success(), "{}", complaint(&output));
    assert_eq!(system.number("SELECT count(*) FROM attempts"), 0);
    // Who would serve a run, with certificates of somebody else.
    for (tls, expected) in [
        ("certificates/worker", "may not serve a run"),
        ("certificates/operator", "may not serve a run"),
        ("ended", "the certificate ended on "),
    ] {
        let study = tests::repository(DAMPER);
        let output = isola(&["sweep", text(&study), "--listen", &endpoint(), "--tls", text(&at(tls))]);
        assert_eq!(output.status.code(), Some(2), "{}", complaint(&output));
        assert!(complaint(&output).contains(expected), "{}", complaint(&output));
    }
    let operator = at("certificates/operator");
    let output = isola(&["cancel", "--connect", &address, "--secret-file", text(&secret), "--tls", text(&operator)]);
    assert_eq!(output.status.code(), Some(0), "{}", complaint(&output));
}

/// Somebody who answers in place of the coordinator: another name, another role.
#[test]
fn another_than_the_coordinator_is_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    let (address, elsewhere) = (endpoint(), endpoint());
    let made = certificates(folder.path(), "tls/elsewhere.example:7447");
    let viewer = made.join("viewer");
    block_on(async {
        let of_coordinator = credentials(&made.join("coordinator"), None);
        let _other_name = listen(&address, &of_coordinator, NAMESPACE).await.unwrap();
        let _other_role = zenoh_with(&elsewhere, &made.join("worker"), true, true).await.unwrap();
        let viewer = credentials(&viewer, None);
        let refused = connect(&address, &viewer).await.unwrap_err().to_string();
        assert!(
            refused.contains("is not for this name but for ") && refused.contains("elsewhere.example"),
            "{refused}"
        );
        let refused = connect(&elsewhere, &viewer).await.unwrap_err().to_string();
        assert!(
            refused.contains("is not accepted here") || refused.contains("is not that of a coordinator"),
            "{refused}"
        );
    });
}

/// A worker with its certificate does its work, while others with a worker's and a viewer's do what they may not.
#[test]
fn roles_do_what_they_may() {
    let mut undisturbed = System::sweep_with(DAMPER, &[LEVELS, BRIEF, &["--workers", "1"]].concat());
    undisturbed.expect_complete();

    let folder = tempfile::tempdir().unwrap();
    let address = endpoint();
    let made = certificates(folder.path(), &address);
    let mut system = System::sweep(
        DAMPER,
        &[LEVELS, BRIEF, LONG, &["--listen", &address, "--tls", text(&made.join("coordinator"))]].concat(),
    );
    let secret = system.secret_file();
    let started = |command: &str, role: &str| {
        let tls = made.join(role);
        let arguments = [command, "--connect", &address, "--secret-file", text(&secret), "--tls", text(&tls)];
        Process::start(&program("isola"), &arguments, &folder.path().join(format!("{command}.log")))
    };
    let mut watching = started("watch", "viewer");
    block_on(async {
        let joined = async |role: &str| joined_at(&address, &credentials(&made.join(role), system.secret())).await;
        let (viewer, worker, coordinator) =
            (joined("viewer").await, joined("worker").await, joined("coordinator").await);
        let operator = joined("operator").await;
        let impostors = [joined("worker").await, joined("viewer").await, joined("operator").await];
        let manifest = run_seen_by(&viewer).await;
        let keys = Keys::new(NAMESPACE, &manifest.run);
        // Three that would be coordinators, and what a viewer hears.
        let (asked, heard) = (Arc::new(AtomicUsize::new(0)), Arc::new(Mutex::new(Vec::new())));
        let mut declared = Vec::new();
        for session in &impostors {
            for key in [keys.requests(), keys.status(), keys.all_done(), keys.results()] {
                let asked = asked.clone();
                let count = move |_| {
                    asked.fetch_add(1, Ordering::Relaxed);
                };
                declared.push(session.declare_queryable(key).complete(true).callback(count).await.unwrap());
            }
        }
        let _token = impostors[0].liveliness().declare_token(keys.alive_coordinator()).await.unwrap();
        let hear = {
            let heard = heard.clone();
            move |sample: zenoh::sample::Sample| heard.lock().unwrap().push(sample.key_expr().to_string())
        };
        let _subscriber = viewer.declare_subscriber(keys.all_done()).callback(hear).await.unwrap();
        let forged = TaskId::new("forged").unwrap();
        for session in &impostors {
            session.put(keys.done(&forged), "forged").await.unwrap();
            session.put(keys.hint(), "").await.unwrap();
        }
        // A viewer and an operator get no task, and nobody but operator and coordinator gives orders.
        let (protocol, program) = (protocol::VERSION, protocol::PROGRAM.to_string());
        let lease = LeaseRequest { protocol, program, worker: WorkerId::new("viewer").unwrap(), slot: 0 };
        let wide = format!("{NAMESPACE}/**");
        for session in [&viewer, &operator] {
            for key in [&keys.lease(), &wide] {
                let refused = request::<_, LeaseReply>(session, key, &lease, SILENCE).await;
                assert!(matches!(refused, Err(RequestError::NoReply)), "{refused:?}");
            }
        }
        for session in [&viewer, &worker] {
            let refused = request::<_, ControlReply>(session, &keys.control(), &ControlRequest::Cancel, SILENCE).await;
            assert!(matches!(refused, Err(RequestError::NoReply)), "{refused:?}");
        }
        let retried =
            request::<_, ControlReply>(&operator, &keys.control(), &ControlRequest::RetryDead, PATIENCE).await;
        assert!(retried.is_ok_and(|reply| reply.message.ends_with("there is nothing to try again")));
        assert_eq!(system.number("SELECT count(*) FROM attempts"), 0);
        let status: Status = fetch(&coordinator, &keys.status(), PATIENCE).await.unwrap();
        assert!(status.workers.is_empty() && !status.stage.is_over(), "{status:?}");
        // The right one.
        let _worker = started("worker", "worker");
        system.expect_complete();
        assert_eq!(asked.load(Ordering::Relaxed), 0, "somebody else was asked");
        let heard = heard.lock().unwrap();
        assert!(!heard.is_empty() && !heard.contains(&keys.done(&forged)), "{heard:?}");
    });
    assert!(watching.wait().success(), "{}", watching.output());
    assert_eq!(files(&undisturbed.directory()), files(&system.directory()));
}

/// A router between, by the configuration that is shipped: it knows the same roles.
#[test]
fn over_a_router() {
    let folder = tempfile::tempdir().unwrap();
    let address = endpoint();
    let made = certificates(folder.path(), &address);
    let mut config = zenoh::Config::from_file(tests::repository("deploy/router.json5")).unwrap();
    config.insert_json5("listen/endpoints", &format!("[{address:?}]")).unwrap();
    for (key, name) in
        [("root_ca_certificate", AUTHORITY), ("listen_certificate", CERTIFICATE), ("listen_private_key", KEY)]
    {
        let file = format!("{:?}", made.join("coordinator").join(name));
        config.insert_json5(&format!("transport/link/tls/{key}"), &file).unwrap();
    }
    block_on(async {
        let _router = zenoh::open(config).await.unwrap();
        let mut system = System::sweep(
            DAMPER,
            &[LEVELS, BRIEF, &["--connect", &address, "--tls", text(&made.join("coordinator"))]].concat(),
        );
        let viewer = joined_at(&address, &credentials(&made.join("viewer"), None)).await;
        let manifest = run_seen_by(&viewer).await;
        let control = Keys::new(NAMESPACE, &manifest.run).control();
        let refused = request::<_, ControlReply>(&viewer, &control, &ControlRequest::Cancel, SILENCE).await;
        assert!(matches!(refused, Err(RequestError::NoReply)), "{refused:?}");
        let tls = made.join("worker");
        let arguments = ["--connect", &address, "--tls", text(&tls), "--slots", "1"];
        let _worker = Process::start(&program("isola-worker"), &arguments, &folder.path().join("worker.log"));
        system.expect_complete();
    });
}
