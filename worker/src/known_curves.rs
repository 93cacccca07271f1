//! Landings, branches and fold curves found before: fetched once.

use crate::bus::Bus;
use crate::patience::Patience;
use protocol::curve::Size;
use protocol::from_worker::Lease;
use protocol::ids::TaskId;
use protocol::session::RequestError;
use protocol::to_everyone::StoredResult;
use protocol::to_worker::{Grant, Known, KnownCurve};
use solver::response::branch::Branch;
use solver::response::critical::CriticalCurve;
use solver::response::seeds::Landing;
use solver::response::task::{BranchId, Finding};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

/// How often a result may be missing while the coordinator answers other requests.
const MISSES: usize = 4;

/// Most seeds of which a slot keeps what they landed on.
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

/// What a slot knows: what its last grant named and what it found itself since, and no more.
#[derive(Debug)]
pub struct KnownCurves {
    size: Size,
    harmonics: usize,
    most: usize,
    landings: HashMap<TaskId, Arc<[Landing]>>,
    branches: HashMap<TaskId, Arc<Branch>>,
    curves: HashMap<TaskId, Arc<CriticalCurve>>,
}

impl KnownCurves {
    /// None yet. All are of a model of this size, with so many harmonics, in results of at most so many bytes.
    pub fn new(size: Size, harmonics: usize, most: usize) -> Self {
        let (landings, branches, curves) = Default::default();
        Self { size, harmonics, most, landings, branches, curves }
    }

    /// Takes what was found here.
    pub fn add(&mut self, task: TaskId, finding: Finding) {
        match finding {
            Finding::Landings(landings) => {
                // Their seeds may be somebody else's work.
                if self.landings.len() == LANDINGS {
                    self.landings.clear();
                }
                self.landings.insert(task, landings.into());
            }
            Finding::Branch(branch) => {
                self.branches.insert(task, Arc::new(branch));
            }
            Finding::Curve(curve) => {
                self.curves.insert(task, Arc::new(curve));
            }
            Finding::Nothing(_) => {}
        }
    }

    /// What a grant names; what is not at hand is fetched. Waits while there is no answer at all.
    pub async fn get(&mut self, bus: &Bus, lease: &Lease, grant: &Grant) -> Result<Found, String> {
        self.branches.retain(|task, _| grant.known.iter().any(|known| known.task == *task));
        self.curves.retain(|task, _| grant.curves.iter().any(|known| known.task == *task));
        let mut found = Found::default();
        if let Some(task) = &grant.landing {
            found.landings = self.landings(bus, lease, task).await?;
        }
        for Known { branch: id, task } in &grant.known {
            found.branches.push((*id, self.branch(bus, lease, task).await?));
        }
        for KnownCurve { number, task } in &grant.curves {
            found.curves.push((*number, self.curve(bus, lease, task).await?));
        }
        Ok(found)
    }

    /// What a seed landed on: asked for once, by that seed.
    async fn landings(&mut self, bus: &Bus, lease: &Lease, task: &TaskId) -> Result<Arc<[Landing]>, String> {
        if let Some(landings) = self.landings.remove(task) {
            return Ok(landings);
        }
        let message = fetch(bus, lease, task, self.most).await?.landings;
        let message = message.ok_or_else(|| format!("the result of task {task}: no landings"))?;
        check(task, message.motions.harmonics, self.harmonics)?;
        let landings = message.landings(&self.size);
        Ok(landings.map_err(|error| format!("the result of task {task}: {error}"))?.into())
    }

    /// A branch found before.
    async fn branch(&mut self, bus: &Bus, lease: &Lease, task: &TaskId) -> Result<Arc<Branch>, String> {
        if let Some(branch) = self.branches.get(task) {
            return Ok(branch.clone());
        }
        let message = fetch(bus, lease, task, self.most).await?.branch;
        let branch = message.ok_or_else(|| format!("the result of task {task}: not a branch"))?;
        check(task, branch.points.motions.harmonics, self.harmonics)?;
        let branch = branch.branch(&self.size).map_err(|error| format!("the result of task {task}: {error}"))?;
        Ok(self.branches.entry(task.clone()).or_insert(Arc::new(branch)).clone())
    }

    /// A fold curve found before.
    async fn curve(&mut self, bus: &Bus, lease: &Lease, task: &TaskId) -> Result<Arc<CriticalCurve>, String> {
        if let Some(curve) = self.curves.get(task) {
            return Ok(curve.clone());
        }
        let message = fetch(bus, lease, task, self.most).await?.curve;
        let curve = message.ok_or_else(|| format!("the result of task {task}: not a fold curve"))?;
        check(task, curve.points.motions.harmonics, self.harmonics)?;
        let curve = curve.curve(&self.size).map_err(|error| format!("the result of task {task}: {error}"))?;
        Ok(self.curves.entry(task.clone()).or_insert(Arc::new(curve)).clone())
    }
}

/// Refuses what has another truncation than the run.
fn check(task: &TaskId, harmonics: usize, expected: usize) -> Result<(), String> {
    if harmonics == expected {
        return Ok(());
    }
    Err(format!("the result of task {task}: {harmonics} harmonics in a run of {expected}"))
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
