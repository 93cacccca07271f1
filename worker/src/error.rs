//! Why a worker ends early.

use protocol::credentials::CredentialsError;
use protocol::ids::RunId;
use protocol::session::SessionError;
use protocol::to_everyone::Manifest;
use std::time::Duration;
use thiserror::Error;

/// Why a worker ends early.
#[derive(Debug, Error)]
pub enum WorkerError {
    /// No session.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// What should let this worker in cannot be read.
    #[error(transparent)]
    Credentials(#[from] CredentialsError),
    /// Somebody listens there, but has no run.
    #[error(
        "{endpoint} can be reached, but no run of namespace `{namespace}` was found there in {} s; start one with `isola \
         sweep STUDY --listen tcp/0.0.0.0:PORT`, wait longer with --wait, or name another namespace with --namespace",
        wait.as_secs_f64()
    )]
    NoRun {
        /// Where.
        endpoint: String,
        /// Namespace.
        namespace: String,
        /// How long it was looked for.
        wait: Duration,
    },
    /// Not the run that was asked for.
    #[error("run `{run}` was not found at {endpoint}; there is {}", list(found))]
    OtherRun {
        /// Where.
        endpoint: String,
        /// What was asked for.
        run: RunId,
        /// What is there.
        found: Vec<Manifest>,
    },
    /// Several runs.
    #[error("there are several runs at {endpoint}: {}; choose one with --run", list(found))]
    SeveralRuns {
        /// Where.
        endpoint: String,
        /// What is there.
        found: Vec<Manifest>,
    },
    /// A coordinator that speaks another version.
    #[error(
        "the coordinator at {endpoint} speaks version {theirs} of the messages, this worker (Isola {program}) version \
         {ours}: install the same version of Isola on both",
        program = protocol::PROGRAM,
        ours = protocol::VERSION
    )]
    OtherVersion {
        /// Where.
        endpoint: String,
        /// Its version.
        theirs: String,
    },
    /// The model cannot be had or is not the one announced.
    #[error("the model of run `{run}` at {endpoint} {problem}")]
    Model {
        /// Where.
        endpoint: String,
        /// Run.
        run: RunId,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The coordinator has no work for this worker, ever.
    #[error("the coordinator of run `{run}` at {endpoint} refuses this worker: {reason}")]
    Refused {
        /// Where.
        endpoint: String,
        /// Run.
        run: RunId,
        /// Why.
        reason: String,
    },
    /// The coordinator is gone.
    #[error(
        "the coordinator of run `{run}` at {endpoint} has not answered for {} s: giving up; start it again there and then \
         this worker, or be more patient with --patience",
        patience.as_secs_f64()
    )]
    Abandoned {
        /// Where.
        endpoint: String,
        /// Run.
        run: RunId,
        /// For how long.
        patience: Duration,
    },
    /// The operating system refuses something.
    #[error("cannot {what}: {source}")]
    System {
        /// What.
        what: &'static str,
        /// Why.
        source: std::io::Error,
    },
}

impl WorkerError {
    /// Exit code: see the [library](crate).
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Session(SessionError::Endpoint { .. } | SessionError::Encryption { .. }) | Self::Credentials(_) => 2,
            Self::Session(_)
            | Self::NoRun { .. }
            | Self::OtherRun { .. }
            | Self::Abandoned { .. }
            | Self::System { .. } => 1,
            Self::SeveralRuns { .. } | Self::OtherVersion { .. } | Self::Model { .. } | Self::Refused { .. } => 3,
        }
    }
}

fn list(runs: &[Manifest]) -> String {
    let one = |manifest: &Manifest| format!("`{}` ({}, {})", manifest.run, manifest.name, manifest.stage.name());
    runs.iter().map(one).collect::<Vec<_>>().join(", ")
}
