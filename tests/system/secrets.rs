//! Who reaches the port of a run without its secret can do nothing there, and is told what is missing.

use crate::{BRIEF, DAMPER, LEVELS, LONG};
use protocol::keys::{NAMESPACE, all_runs};
use protocol::secret::Secret;
use protocol::session::{connect, fetch};
use protocol::to_everyone::Manifest;
use std::os::unix::fs::PermissionsExt;
use std::time::Duration;
use tests::{System, block_on, complaint, isola, isola_each, own_endpoint};

#[test]
fn without_the_secret_there_is_nothing() {
    let mut system = System::sweep(DAMPER, &[LEVELS, BRIEF, LONG].concat());
    let address = system.address();
    let mode = std::fs::metadata(system.secret_file()).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    let other = system.folder().join("other");
    "0123456789abcdef0123456789abcdef".parse::<Secret>().unwrap().write(&other).unwrap();
    let other = other.display().to_string();
    let commands = [&["status"][..], &["watch"], &["cancel"], &["retry-dead"], &["worker", "--wait", "1"]];
    for (secret, expected) in
        [(&[][..], "name a copy of it with --secret-file"), (&["--secret-file", &other], "another secret than")]
    {
        let commands = commands.map(|command| [command, &["--connect", &address], secret].concat());
        for (output, command) in isola_each(&commands).iter().zip(&commands) {
            let said = complaint(output);
            assert_eq!(output.status.code(), Some(1), "{command:?}: {said}");
            assert!(said.contains(expected), "{command:?}: {said}");
        }
    }
    block_on(async {
        let stranger: Secret = "0123456789abcdef0123456789abcdef".parse().unwrap();
        for secret in [None, Some(stranger)] {
            assert!(connect(&address, &secret.into()).await.is_err(), "let in");
        }
        let session = connect(&address, &system.secret().into()).await.unwrap();
        fetch::<Manifest>(&session, &all_runs(NAMESPACE), Duration::from_secs(60)).await.unwrap();
    });
    assert_eq!(system.number("SELECT count(*) FROM attempts"), 0);
    // With it, by its folder or by a copy: the same commands do what they say.
    let copy = system.folder().join("copy");
    std::fs::copy(system.secret_file(), &copy).unwrap();
    let copy = copy.display().to_string();
    let status = isola(&["status", "--connect", &address, "--secret-file", &copy]);
    assert!(status.status.success(), "{}", complaint(&status));
    let status = isola(&["status", &system.directory_text()]);
    assert!(status.status.success() && !status.stdout.is_empty(), "{}", complaint(&status));
    let _worker = system.worker();
    system.expect_complete();
}

/// A secret of one's own choice, and none at all.
#[test]
fn a_secret_that_is_given_and_none() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own");
    let secret: Secret = "a-secret-of-ones-own".parse().unwrap();
    secret.write(&own).unwrap();
    let own = own.display().to_string();
    let system =
        System::sweep(DAMPER, &[LEVELS, BRIEF, &["--secret-file", &own, "--listen", &own_endpoint()]].concat());
    assert_eq!(system.secret(), Some(secret));
    let status = isola(&["status", "--connect", &system.address(), "--secret-file", &own]);
    assert!(status.status.success(), "{}", complaint(&status));
    drop(system);

    let mut system = System::sweep(DAMPER, &[LEVELS, BRIEF, &["--insecure"]].concat());
    assert_eq!(system.secret(), None);
    let status = isola(&["status", "--connect", &system.address()]);
    assert!(status.status.success(), "{}", complaint(&status));
    let _worker = system.worker();
    system.expect_complete();

    for text in ["short", "isola:with space in it", ""] {
        let bad = folder.path().join("bad");
        std::fs::write(&bad, text).unwrap();
        let output = isola(&["status", "--connect", "tcp/127.0.0.1:1", "--secret-file", &bad.display().to_string()]);
        assert_eq!(output.status.code(), Some(2), "{}", complaint(&output));
        assert!(complaint(&output).contains("bad: a secret is 16 letters"), "{}", complaint(&output));
    }
}

/// Port 0 is a free port: whoever is told where to connect to is told which.
#[test]
fn a_port_that_the_system_chooses() {
    let mut system = System::sweep(DAMPER, &[LEVELS, BRIEF, &["--listen", "tcp/0.0.0.0:0"]].concat());
    let port = system.address().rsplit(':').next().unwrap().to_string();
    assert_ne!(port, "0");
    assert_eq!(tests::listening(system.coordinator.id()), [format!("0.0.0.0:{port}")]);
    system.eventually("what is waited for", |system| system.coordinator.output().contains("waiting for workers"));
    let expected = format!(":{port} --secret-file {}", system.secret_file().display());
    assert!(system.coordinator.output().contains(&expected), "{}", system.coordinator.output());
    let _worker = system.worker();
    system.expect_complete();
}
