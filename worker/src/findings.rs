//! What was found before: landings, branches, curves over the forcing, each fetched once.

use crate::bus::Bus;
use crate::patience::Patience;
use protocol::array::ArrayError;
use protocol::branch::BranchMessage;
use protocol::critical::CriticalMessage;
use protocol::curve::{Motions, Size};
use protocol::from_worker::Lease;
use protocol::ids::TaskId;
use protocol::landings::LandingsMessage;
use protocol::session::RequestError;
use protocol::to_everyone::StoredResult;
use protocol::to_worker::{Grant, Known, KnownCurve};
use solver::response::branch::Branch;
use solver::response::critical::CriticalCurve;
use solver::response::seeds::Landing;
use solver::response::task::{BranchId, Task, TaskResult};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

/// How often a result may be missing while the coordinator answers other requests.
const MISSES: usize = 4;

/// Most seeds of which a lane keeps what they landed on.
const LANDINGS: usize = 64;

/// What a grant names.
#[derive(Debug, Default)]
pub struct Found {
    /// What its seed landed on.
    pub landings: Arc<[Landing]>,
    /// Branches with their names.
    pub branches: Vec<(BranchId, Arc<Branch>)>,
    /// Fold curves with their numbers.
    pub curves: Vec<(usize, Arc<CriticalCurve>)>,
}

/// What a lane knows: what its last grant named and what it found itself since, and no more.
#[derive(Debug)]
pub struct Findings {
    size: Size,
    harmonics: usize,
    most: usize,
    landings: HashMap<TaskId, Arc<[Landing]>>,
    branches: HashMap<TaskId, Arc<Branch>>,
    curves: HashMap<TaskId, Arc<CriticalCurve>>,
}

impl Findings {
    /// None yet. All are of a model of this size, with so many harmonics, in results of at most so many bytes.
    pub fn new(size: Size, harmonics: usize, most: usize) -> Self {
        let (landings, branches, curves) = Default::default();
        Self { size, harmonics, most, landings, branches, curves }
    }

    /// Takes what was found here.
    pub fn add(&mut self, task: TaskId, finding: TaskResult) {
        match finding {
            TaskResult::Landings(landings) => {
                // Their seeds may be somebody else's work.
                if self.landings.len() >= LANDINGS {
                    self.landings.clear();
                }
                self.landings.insert(task, landings.into());
            }
            TaskResult::Branch(branch) => {
                self.branches.insert(task, Arc::new(branch));
            }
            TaskResult::Curve(curve) => {
                self.curves.insert(task, Arc::new(curve));
            }
            TaskResult::Nothing(_) => {}
        }
    }

    /// What a grant names; what is not at hand is fetched. Waits while there is no answer at all.
    pub async fn get(&mut self, bus: &Bus, lease: &Lease, grant: &Grant) -> Result<Found, String> {
        // What need not know anything says nothing of what is needed next.
        if grant.work.is_ordered() {
            self.branches.retain(|task, _| grant.known.iter().any(|known| known.task == *task));
            self.curves.retain(|task, _| grant.curves.iter().any(|known| known.task == *task));
        }
        let mut found = Found::default();
        if let Some(task) = &grant.landing {
            found.landings = match self.landings.remove(task) {
                Some(landings) => landings,
                None => self.fetch::<LandingsMessage>(bus, lease, task).await?.into(),
            };
            // What a scout met is asked for by one fold after the other, what a seed landed on once.
            if matches!(grant.work, Task::Fold(_)) {
                self.landings.insert(task.clone(), found.landings.clone());
            }
        }
        for Known { branch: id, task } in &grant.known {
            if !self.branches.contains_key(task) {
                let branch = self.fetch::<BranchMessage>(bus, lease, task).await?;
                self.branches.insert(task.clone(), Arc::new(branch));
            }
            found.branches.push((*id, self.branches[task].clone()));
        }
        for KnownCurve { number, task } in &grant.curves {
            if !self.curves.contains_key(task) {
                let curve = self.fetch::<CriticalMessage>(bus, lease, task).await?;
                self.curves.insert(task.clone(), Arc::new(curve));
            }
            found.curves.push((*number, self.curves[task].clone()));
        }
        Ok(found)
    }

    /// What a task found, of this model and with as many harmonics as the run has.
    async fn fetch<P: Part>(&self, bus: &Bus, lease: &Lease, task: &TaskId) -> Result<P::Value, String> {
        let what = |why: String| format!("the result of task {task}: {why}");
        let part = P::of(fetch(bus, lease, task, self.most).await?).ok_or_else(|| what(format!("no {}", P::NAME)))?;
        let (harmonics, expected) = (part.motions().harmonics, self.harmonics);
        if harmonics != expected {
            return Err(what(format!("{harmonics} harmonics in a run of {expected}")));
        }
        part.value(&self.size).map_err(|error| what(error.to_string()))
    }
}

/// What a result can hold.
trait Part: Sized {
    const NAME: &str;
    type Value;
    fn of(result: StoredResult) -> Option<Self>;
    fn motions(&self) -> &Motions;
    fn value(&self, size: &Size) -> Result<Self::Value, ArrayError>;
}

impl Part for LandingsMessage {
    const NAME: &str = "landings";
    type Value = Vec<Landing>;

    fn of(result: StoredResult) -> Option<Self> {
        result.landings
    }

    fn motions(&self) -> &Motions {
        &self.motions
    }

    fn value(&self, size: &Size) -> Result<Vec<Landing>, ArrayError> {
        self.landings(size)
    }
}

impl Part for BranchMessage {
    const NAME: &str = "branch";
    type Value = Branch;

    fn of(result: StoredResult) -> Option<Self> {
        result.branch
    }

    fn motions(&self) -> &Motions {
        &self.points.motions
    }

    fn value(&self, size: &Size) -> Result<Branch, ArrayError> {
        self.branch(size)
    }
}

impl Part for CriticalMessage {
    const NAME: &str = "curve";
    type Value = CriticalCurve;

    fn of(result: StoredResult) -> Option<Self> {
        result.curve
    }

    fn motions(&self) -> &Motions {
        &self.points.motions
    }

    fn value(&self, size: &Size) -> Result<CriticalCurve, ArrayError> {
        self.curve(size)
    }
}

async fn fetch(bus: &Bus, lease: &Lease, task: &TaskId, most: usize) -> Result<StoredResult, String> {
    // Whoever keeps the lease alive notices when patience is over.
    let mut patience = Patience::new(Duration::MAX);
    let mut misses = 0;
    loop {
        match bus.result(task, most).await {
            Ok(stored) => return Ok(stored),
            Err(error @ (RequestError::Refused(_) | RequestError::Codec(_))) => {
                return Err(format!("the result of task {task}: {error}"));
            }
            Err(RequestError::NoReply | RequestError::Closed(_)) => {
                // Nobody there, or only this result missing? A sign of life is always answered.
                misses = if bus.renew(lease, None).await.is_ok() { misses + 1 } else { 0 };
                if misses == MISSES {
                    return Err(format!("the coordinator does not hand out the result of task {task}"));
                }
                let _ = patience.pause().await;
            }
        }
    }
}
