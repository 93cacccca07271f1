//! Finding a run, or saying why there is none.

use crate::fake::{Answer, Asked, Fake, drained, fine, hand_out, options, own_endpoint};
use crate::study::Study;
use protocol::credentials::Credentials;
use protocol::ids::RunId;
use protocol::keys::{Keys, NAMESPACE};
use protocol::session::listen;
use protocol::to_everyone::{Manifest, Stage};
use protocol::to_worker::LeaseReply;
use worker::shutdown::Shutdown;
use worker::{Ending, Options};

async fn refusal(options: &Options) -> (u8, String) {
    let error = worker::work(options, &Shutdown::default()).await.unwrap_err();
    (error.exit_code(), error.to_string())
}

fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in: {message}");
    }
}

fn another(study: &Study, run: &str, stage: Stage) -> Manifest {
    Manifest { run: RunId::new(run).unwrap(), name: "another".into(), stage, ..study.manifest() }
}

#[tokio::test(flavor = "multi_thread")]
async fn nobody_is_there() {
    let endpoint = own_endpoint();
    let (code, message) = refusal(&options(&endpoint, &["--wait", "1"])).await;
    assert_eq!(code, 1);
    assert_says(&message, &[&endpoint, "start one there with `isola sweep"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_endpoint_that_is_none() {
    let (code, message) = refusal(&options("somewhere", &[])).await;
    assert_eq!(code, 2);
    assert_says(&message, &["`somewhere` is not an endpoint", "tcp/HOST:7447"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_router_without_a_run() {
    let endpoint = own_endpoint();
    let _router = listen(&endpoint, &Credentials::default(), NAMESPACE).await.unwrap();
    let (code, message) = refusal(&options(&endpoint, &["--namespace", "mine", "--wait", "10"])).await;
    assert_eq!(code, 1);
    assert_says(&message, &[&endpoint, "namespace `mine`", "--wait"]);
}

/// Whoever comes first waits for the other.
#[tokio::test(flavor = "multi_thread")]
async fn a_coordinator_that_comes_later() {
    let (study, endpoint) = (Study::new(1), own_endpoint());
    let early = options(&endpoint, &[]);
    let worker = tokio::spawn(async move { worker::work(&early, &Shutdown::default()).await });
    tokio::time::sleep(std::time::Duration::from_millis(300)).await;
    let _fake = Fake::start_at(&endpoint, Default::default(), &study, hand_out(vec![study.main()])).await;
    assert_eq!(worker.await.unwrap().unwrap().done, 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn several_runs_are_listed() {
    let study = Study::new(1);
    let fake = Fake::start(&study, hand_out(Vec::new())).await;
    fake.announce(another(&study, "two", Stage::Backbone)).await;
    let (code, message) = refusal(&fake.options(&[])).await;
    assert_eq!(code, 3);
    let parts = ["`one` (damper, running)", "`two` (another, computing the backbone)", "choose one with --run"];
    assert_says(&message, &parts);
    assert_eq!(fake.work(&["--run", "one"]).await.unwrap().ending, Ending::Drained);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_run_that_is_over_does_not_count() {
    let study = Study::new(1);
    let fake = Fake::start(&study, hand_out(Vec::new())).await;
    fake.announce(another(&study, "two", Stage::Finished)).await;
    assert_eq!(fake.work(&[]).await.unwrap().ending, Ending::Drained);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_run_that_is_not_there() {
    let fake = Fake::start(&Study::new(1), hand_out(Vec::new())).await;
    let (code, message) = refusal(&fake.options(&["--run", "three", "--wait", "10"])).await;
    assert_eq!(code, 1);
    assert_says(&message, &["`three` was not found", &fake.endpoint, "`one` (damper, running)"]);
}

/// The version of the messages of this program, in words.
fn own() -> String {
    format!("version {}", protocol::VERSION)
}

#[tokio::test(flavor = "multi_thread")]
async fn another_version_of_the_messages() {
    let fake = Fake::start(&Study::new(1), hand_out(Vec::new())).await;
    fake.change(|manifest| manifest.protocol = 99);
    let (code, message) = refusal(&fake.options(&[])).await;
    assert_eq!(code, 3);
    assert_says(&message, &[&fake.endpoint, "version 99", &own(), "install the same version"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn another_version_in_the_keys() {
    let (endpoint, run) = (own_endpoint(), RunId::new("one").unwrap());
    let router = listen(&endpoint, &Credentials::default(), NAMESPACE).await.unwrap();
    let [own_key, other] = [0, 1].map(|by| format!("/v{}/", protocol::VERSION + by));
    let key = Keys::new("isola", &run).run().replace(&own_key, &other);
    let reply = key.clone();
    let queryable = router.declare_queryable(key).callback(move |query| {
        use zenoh::Wait;
        query.reply(&reply, "something").wait().unwrap();
    });
    queryable.background().await.unwrap();
    let (code, message) = refusal(&options(&endpoint, &[])).await;
    assert_eq!(code, 3);
    assert_says(&message, &[&format!("speaks version {}", protocol::VERSION + 1), &own()]);
}

#[tokio::test(flavor = "multi_thread")]
async fn another_model() {
    let fake = Fake::start(&Study::new(1), hand_out(Vec::new())).await;
    fake.seen.model.lock().unwrap().push(0);
    let (code, message) = refusal(&fake.options(&[])).await;
    assert_eq!(code, 3);
    assert_says(&message, &["model of run `one`", &fake.endpoint, "is not the one that was announced"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn settings_that_do_not_fit_the_model() {
    let fake = Fake::start(&Study::new(1), hand_out(Vec::new())).await;
    fake.change(|manifest| manifest.settings.backbone.modes = solver::settings::ModeChoice::one(5));
    let (code, message) = refusal(&fake.options(&[])).await;
    assert_eq!(code, 3);
    assert_says(&message, &["does not fit the settings", "backbone.modes"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn refused_by_the_coordinator() {
    let stop = || Answer::Lease(Box::new(LeaseReply::Stop { reason: "install the same Isola".into() }));
    let fake = Fake::start(&Study::new(1), move |_| stop()).await;
    let (code, message) = refusal(&fake.options(&[])).await;
    assert_eq!(code, 3);
    assert_says(&message, &["`one`", &fake.endpoint, "install the same Isola"]);

    let fake = Fake::start(&Study::new(1), |_| Answer::Refuse("malformed request")).await;
    let (code, message) = refusal(&fake.options(&[])).await;
    assert_eq!(code, 3);
    assert_says(&message, &["malformed request"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_cancelled_run_is_an_ordinary_end() {
    let stop = || Answer::Lease(Box::new(LeaseReply::Stop { reason: "cancelled".into() }));
    let fake = Fake::start(&Study::new(1), move |_| stop()).await;
    fake.change(|manifest| manifest.stage = Stage::Cancelled);
    assert_eq!(fake.work(&["--slots", "2"]).await.unwrap().ending, Ending::Cancelled);
}

/// Everything that a worker says of itself when it asks for work.
#[tokio::test(flavor = "multi_thread")]
async fn asks_by_name_and_version() {
    let fake = Fake::start(&Study::new(1), |asked| if asked.is_lease() { drained() } else { fine(asked) }).await;
    fake.work(&["--slots", "1"]).await.unwrap();
    let log = fake.seen.log.lock().unwrap();
    let [Asked::Lease(request)] = &log[..] else { panic!("{log:?}") };
    assert_eq!((request.protocol, request.slot), (protocol::VERSION, 0));
    assert_eq!(request.program, protocol::PROGRAM);
    assert!(request.worker.as_str().contains(&format!("-{}-", std::process::id())));
}
