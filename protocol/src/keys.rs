//! Key expressions: `<namespace>/v11/<run>/…`.

use crate::VERSION;
use crate::ids::{NameError, RunId, TaskId, WorkerId};

/// Namespace unless told otherwise.
pub const NAMESPACE: &str = "isola";

/// Checks a namespace: names, as those of runs, with `/` between them.
///
/// # Errors
/// If one of them is no name.
pub fn namespace(text: &str) -> Result<String, NameError> {
    text.split('/').try_for_each(|part| RunId::new(part).map(drop))?;
    Ok(text.to_string())
}

/// Manifests of all runs of a namespace.
pub fn all_runs(namespace: &str) -> String {
    format!("{namespace}/v{VERSION}/*/run")
}

/// Manifests of all runs of a namespace, whatever their version: to tell that one speaks another.
pub fn all_versions(namespace: &str) -> String {
    format!("{namespace}/*/*/run")
}

/// Keys of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Keys {
    base: String,
}

impl Keys {
    /// Keys of `run` in `namespace`.
    pub fn new(namespace: &str, run: &RunId) -> Self {
        Self { base: format!("{namespace}/v{VERSION}/{run}") }
    }

    fn at(&self, rest: &str) -> String {
        format!("{}/{rest}", self.base)
    }

    /// Manifest: queryable, put on change.
    pub fn run(&self) -> String {
        self.at("run")
    }

    /// Model: queryable.
    pub fn model(&self) -> String {
        self.at("model")
    }

    /// Backbone of the primary mode: queryable.
    pub fn backbone(&self) -> String {
        self.at("backbone")
    }

    /// Backbone of a mode, by its number from 1: queryable.
    pub fn backbone_of(&self, number: usize) -> String {
        self.at(&format!("backbone/{number}"))
    }

    /// Backbones of all modes.
    pub fn backbones(&self) -> String {
        self.at("backbone/*")
    }

    /// Windows of every level: queryable.
    pub fn windows(&self) -> String {
        self.at("windows")
    }

    /// Seed of a task: put once, queryable.
    pub fn seed(&self, task: &TaskId) -> String {
        self.at(&format!("seed/{task}"))
    }

    /// All seeds.
    pub fn seeds(&self) -> String {
        self.at("seed/*")
    }

    /// Request for work.
    pub fn lease(&self) -> String {
        self.at("rpc/lease")
    }

    /// Sign of life of a task under way.
    pub fn renew(&self) -> String {
        self.at("rpc/renew")
    }

    /// Result of a task.
    pub fn submit(&self, task: &TaskId) -> String {
        self.at(&format!("rpc/submit/{task}"))
    }

    /// Steps of a task under way.
    pub fn keep(&self, task: &TaskId) -> String {
        self.at(&format!("rpc/checkpoint/{task}"))
    }

    /// Steps of a task that earlier attempts took: queryable.
    pub fn checkpoint(&self, task: &TaskId) -> String {
        self.at(&format!("checkpoint/{task}"))
    }

    /// These from the one with this number on, from 0: as many as one answer holds.
    pub fn checkpoint_from(&self, task: &TaskId, first: usize) -> String {
        format!("{}?first={first}", self.checkpoint(task))
    }

    /// The steps of all tasks.
    pub fn checkpoints(&self) -> String {
        self.at("checkpoint/*")
    }

    /// A task that cannot be carried out.
    pub fn fail(&self) -> String {
        self.at("rpc/fail")
    }

    /// A task given back.
    pub fn release(&self) -> String {
        self.at("rpc/release")
    }

    /// Orders of people: cancel, retry.
    pub fn control(&self) -> String {
        self.at("rpc/control")
    }

    /// Everything that the coordinator answers by deciding.
    pub fn requests(&self) -> String {
        self.at("rpc/**")
    }

    /// Where the branch of a task is.
    pub fn progress(&self, task: &TaskId) -> String {
        self.at(&format!("progress/{task}"))
    }

    /// Where the branches of all tasks are.
    pub fn all_progress(&self) -> String {
        self.at("progress/*")
    }

    /// Announcement of a stored result: put, queryable.
    pub fn done(&self, task: &TaskId) -> String {
        self.at(&format!("done/{task}"))
    }

    /// All announcements.
    pub fn all_done(&self) -> String {
        self.at("done/*")
    }

    /// Stored result: queryable.
    pub fn result(&self, task: &TaskId) -> String {
        self.at(&format!("result/{task}"))
    }

    /// All stored results.
    pub fn results(&self) -> String {
        self.at("result/*")
    }

    /// Counts, workers, ETA: put every second, queryable.
    pub fn status(&self) -> String {
        self.at("status")
    }

    /// Hint to look for new orders: put.
    pub fn hint(&self) -> String {
        self.at("ctl/hint")
    }

    /// The coordinator's hint to one worker that waits: there is work.
    pub fn wake(&self, worker: &WorkerId) -> String {
        self.at(&format!("ctl/wake/{worker}"))
    }

    /// Presence of the coordinator.
    pub fn alive_coordinator(&self) -> String {
        self.at("alive/coordinator")
    }

    /// Presence of a worker.
    pub fn alive_worker(&self, worker: &WorkerId) -> String {
        self.at(&format!("alive/worker/{worker}"))
    }

    /// Presence of all workers.
    pub fn alive_workers(&self) -> String {
        self.at("alive/worker/*")
    }
}

/// Last chunk of a key: the task or worker that it is about.
pub fn last_chunk(key: &str) -> &str {
    key.rsplit('/').next().unwrap_or(key)
}
