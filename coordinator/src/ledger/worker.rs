//! A worker as the ledger knows it.

use protocol::from_worker::Progress;
use protocol::ids::TaskId;
use std::collections::{HashMap, HashSet};
use std::time::Duration;

/// A worker as the ledger knows it.
#[derive(Debug, Clone, Default)]
pub(super) struct Worker {
    /// Vanished from the bus, and not heard of since.
    pub gone: bool,
    /// Results accepted from it.
    pub done: usize,
    /// Why results of it were refused.
    pub refusals: Vec<String>,
    /// Results of it that others repeated, or were about to.
    pub repeated: usize,
    /// Results of it that two others contradict.
    pub refuted: usize,
    /// Results of it that were confirmed since the last one of these.
    pub confirmed: usize,
    /// The chain that each computing thread worked on last.
    pub chains: HashMap<u32, usize>,
    /// Computing threads that have asked for work.
    pub threads: HashSet<u32>,
    /// Time that its threads had tasks, added up.
    pub busy: Duration,
    /// Time that its threads were there, added up.
    pub present: Duration,
    /// The part of it in which there were tasks, under way or to be handed out.
    pub wanted: Duration,
    /// Where the branches of its tasks are.
    pub progress: HashMap<TaskId, Progress>,
}
