//! Branches of a level found before: fetched once.

use crate::bus::Bus;
use crate::patience::Patience;
use protocol::curve::Size;
use protocol::from_worker::Lease;
use protocol::ids::TaskId;
use protocol::session::RequestError;
use protocol::to_everyone::StoredResult;
use protocol::to_worker::Known;
use solver::response::branch::Branch;
use solver::response::task::BranchId;
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

/// How often a result may be missing while the coordinator answers other requests.
const MISSES: usize = 4;

/// The branches that a slot knows: those of its level, and no more.
#[derive(Debug)]
pub struct KnownBranches {
    size: Size,
    harmonics: usize,
    most: usize,
    branches: HashMap<TaskId, Arc<Branch>>,
}

impl KnownBranches {
    /// None yet. All are of a model of this size, with so many harmonics, in results of at most so many bytes.
    pub fn new(size: Size, harmonics: usize, most: usize) -> Self {
        Self { size, harmonics, most, branches: HashMap::new() }
    }

    /// Takes a branch that was found here.
    pub fn add(&mut self, task: TaskId, branch: Branch) {
        self.branches.insert(task, Arc::new(branch));
    }

    /// The branches of a grant; what is not at hand is fetched. Waits while there is no answer at all.
    pub async fn get(
        &mut self,
        bus: &Bus,
        lease: &Lease,
        known: &[Known],
    ) -> Result<Vec<(BranchId, Arc<Branch>)>, String> {
        self.branches.retain(|task, _| known.iter().any(|known| known.task == *task));
        let mut list = Vec::with_capacity(known.len());
        for Known { branch: id, task } in known {
            let branch = match self.branches.get(task) {
                Some(branch) => branch.clone(),
                None => {
                    let stored = fetch(bus, lease, task, self.most).await?;
                    let branch = self.unpack(stored).map_err(|error| format!("the result of task {task}: {error}"))?;
                    self.branches.entry(task.clone()).or_insert(Arc::new(branch)).clone()
                }
            };
            list.push((*id, branch));
        }
        Ok(list)
    }

    fn unpack(&self, stored: StoredResult) -> Result<Branch, String> {
        let branch = stored.branch.ok_or("not a branch")?;
        let harmonics = branch.points.motions.harmonics;
        if harmonics != self.harmonics {
            return Err(format!("{harmonics} harmonics in a run of {}", self.harmonics));
        }
        branch.branch(&self.size).map_err(|error| error.to_string())
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
