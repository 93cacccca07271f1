//! Finding the coordinator, its run and its model.

use crate::error::WorkerError;
use crate::options::Options;
use protocol::codec::{decode, sha256};
use protocol::credentials::{Credentials, CredentialsError};
use protocol::ids::RunId;
use protocol::keys::{Keys, all_runs, all_versions};
use protocol::model::ModelMessage;
use protocol::role::Role;
use protocol::secret::SecretError;
use protocol::session::{SessionError, connect, fetch_all, fetch_answer, unreachable};
use protocol::to_everyone::{Manifest, Stage};
use solver::structure::Model;
use std::time::Duration;
use tokio::time::{Instant, sleep, timeout_at};
use zenoh::Session;
use zenoh::query::ConsolidationMode;

/// A run that was found.
#[derive(Debug, Clone)]
pub struct Joined {
    /// Manifest.
    pub manifest: Manifest,
    /// Model.
    pub model: Model,
}

/// How long an answer may take.
const ANSWER: Duration = Duration::from_secs(5);
/// Between two looks.
const PAUSE: Duration = Duration::from_millis(200);
/// How long the first look may take, however short the wait.
const FIRST_LOOK: Duration = Duration::from_secs(1);

/// When to stop looking.
pub fn deadline(options: &Options) -> Instant {
    Instant::now() + options.wait.max(FIRST_LOOK)
}

/// Connects, as soon as somebody listens.
pub async fn open(options: &Options, deadline: Instant) -> Result<Session, WorkerError> {
    let endpoint = &options.connect;
    loop {
        // The run that it is the secret of may be about to begin.
        let credentials = match Credentials::given(options.secret_file.as_deref(), options.tls.as_deref()) {
            Err(CredentialsError::Secret(SecretError::Io { .. })) if Instant::now() + PAUSE < deadline => {
                sleep(PAUSE).await;
                continue;
            }
            credentials => credentials?,
        };
        if let Some(certificate) = &credentials.certificate {
            certificate.require(Role::Worker, "take tasks").map_err(CredentialsError::from)?;
        }
        // On its own: an attempt that is dropped would be waited for.
        let (endpoint_of_attempt, its_credentials) = (endpoint.to_string(), credentials.clone());
        let attempt = tokio::spawn(async move { connect(&endpoint_of_attempt, &its_credentials).await });
        match timeout_at(deadline, async { attempt.await.expect("connecting does not panic") }).await {
            Ok(Ok(session)) => return Ok(session),
            Ok(Err(error @ (SessionError::Endpoint { .. } | SessionError::Encryption { .. }))) => {
                return Err(error.into());
            }
            Ok(Err(error)) if Instant::now() + PAUSE >= deadline => return Err(error.into()),
            Err(_) => return Err(unreachable(endpoint, &credentials).await.into()),
            Ok(Err(_)) => sleep(PAUSE).await,
        }
    }
}

/// Finds the run, as soon as it is there, and fetches its model.
pub async fn find(session: &Session, options: &Options, deadline: Instant) -> Result<Joined, WorkerError> {
    loop {
        let found = look(session, options).await;
        match found {
            Ok(manifest) => {
                let model = fetch_model(session, options, &manifest, deadline).await?;
                return Ok(Joined { manifest, model });
            }
            Err(error @ (WorkerError::SeveralRuns { .. } | WorkerError::OtherVersion { .. })) => return Err(error),
            Err(error) if Instant::now() + PAUSE >= deadline => return Err(error),
            Err(_) => sleep(PAUSE).await,
        }
    }
}

async fn look(session: &Session, options: &Options) -> Result<Manifest, WorkerError> {
    let endpoint = options.connect.clone();
    let mut found: Vec<Manifest> = fetch_all(session, &all_runs(&options.namespace), ANSWER).await.unwrap_or_default();
    found.sort_by(|a, b| a.run.cmp(&b.run));
    found.dedup_by(|a, b| a.run == b.run);
    if found.is_empty() {
        return Err(match other_version(session, &options.namespace).await {
            Some(theirs) => WorkerError::OtherVersion { endpoint, theirs },
            None => WorkerError::NoRun { endpoint, namespace: options.namespace.clone(), wait: options.wait },
        });
    }
    let manifest = choose(found, options.run.as_ref(), &endpoint)?;
    if manifest.protocol != protocol::VERSION {
        return Err(WorkerError::OtherVersion { endpoint, theirs: manifest.protocol.to_string() });
    }
    Ok(manifest)
}

/// The run that was asked for, or the only one with work to do, or the only one.
fn choose(mut found: Vec<Manifest>, run: Option<&RunId>, endpoint: &str) -> Result<Manifest, WorkerError> {
    let endpoint = endpoint.to_string();
    let index = match run {
        Some(run) => match found.iter().position(|manifest| manifest.run == *run) {
            Some(index) => index,
            None => return Err(WorkerError::OtherRun { endpoint, run: run.clone(), found }),
        },
        None => {
            let has_work = |manifest: &Manifest| matches!(manifest.stage, Stage::Backbone | Stage::Sweep);
            let open: Vec<usize> = (0..found.len()).filter(|&index| has_work(&found[index])).collect();
            match (&open[..], found.len()) {
                (&[index], _) => index,
                (_, 1) => 0,
                _ => return Err(WorkerError::SeveralRuns { endpoint, found }),
            }
        }
    };
    Ok(found.swap_remove(index))
}

/// The version that runs of a namespace speak, if it is another one.
async fn other_version(session: &Session, namespace: &str) -> Option<String> {
    let get = session.get(all_versions(namespace)).consolidation(ConsolidationMode::None).timeout(ANSWER);
    let replies = get.await.ok()?;
    while let Ok(reply) = replies.recv_async().await {
        if let Ok(sample) = reply.result() {
            // <namespace>/v<version>/<run>/run
            let version = sample.key_expr().as_str().rsplit('/').nth(2).and_then(|chunk| chunk.strip_prefix('v'));
            if let Some(version) = version.filter(|version| *version != protocol::VERSION.to_string()) {
                return Some(version.to_string());
            }
        }
    }
    None
}

async fn fetch_model(
    session: &Session,
    options: &Options,
    manifest: &Manifest,
    deadline: Instant,
) -> Result<Model, WorkerError> {
    let key = Keys::new(&options.namespace, &manifest.run).model();
    loop {
        if let Ok((bytes, encoding)) = fetch_answer(session, &key, 6 * ANSWER).await {
            return read_model(&bytes, &encoding, manifest).map_err(|problem| unusable(options, manifest, problem));
        }
        if Instant::now() + PAUSE >= deadline {
            let problem = "was not handed out: start this worker again".into();
            return Err(unusable(options, manifest, problem));
        }
        sleep(PAUSE).await;
    }
}

fn unusable(options: &Options, manifest: &Manifest, problem: String) -> WorkerError {
    WorkerError::Model { endpoint: options.connect.clone(), run: manifest.run.clone(), problem }
}

/// The model, if it is the one announced; what is wrong with it otherwise.
fn read_model(bytes: &[u8], encoding: &str, manifest: &Manifest) -> Result<Model, String> {
    let (found, expected) = (sha256(bytes), &manifest.model_sha256);
    if found != *expected {
        return Err(format!(
            "is not the one that was announced (SHA-256 {found}, announced {expected}): two coordinators may answer for \
             this run; leave one of them"
        ));
    }
    let message: ModelMessage = decode(bytes, encoding).map_err(|error| format!("cannot be read: {error}"))?;
    let model = message.model().map_err(|error| format!("cannot be read: {error}"))?;
    manifest.settings.validate(&model).map_err(|error| format!("does not fit the settings of the run: {error}"))?;
    Ok(model)
}
