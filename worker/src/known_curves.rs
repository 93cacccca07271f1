//! Branches and fold curves found before: fetched once.

use crate::bus::Bus;
use crate::patience::Patience;
use protocol::curve::Size;
use protocol::from_worker::Lease;
use protocol::ids::TaskId;
use protocol::session::RequestError;
use protocol::to_everyone::StoredResult;
use protocol::to_worker::{Known, KnownCurve};
use solver::response::branch::Branch;
use solver::response::critical::CriticalCurve;
use solver::response::task::{BranchId, Finding};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

/// How often a result may be missing while the coordinator answers other requests.
const MISSES: usize = 4;

/// What a grant names.
#[derive(Debug, Default)]
pub struct Found {
    /// Branches with their names.
    pub branches: Vec<(BranchId, Arc<Branch>)>,
    /// Fold curves with their numbers.
    pub curves: Vec<(usize, Arc<CriticalCurve>)>,
}

/// What a slot knows: the branches and curves of its last grant, and no more.
#[derive(Debug)]
pub struct KnownCurves {
    size: Size,
    harmonics: usize,
    most: usize,
    branches: HashMap<TaskId, Arc<Branch>>,
    curves: HashMap<TaskId, Arc<CriticalCurve>>,
}

impl KnownCurves {
    /// None yet. All are of a model of this size, with so many harmonics, in results of at most so many bytes.
    pub fn new(size: Size, harmonics: usize, most: usize) -> Self {
        Self { size, harmonics, most, branches: HashMap::new(), curves: HashMap::new() }
    }

    /// Takes what was found here.
    pub fn add(&mut self, task: TaskId, finding: Finding) {
        match finding {
            Finding::Branch(branch) => {
                self.branches.insert(task, Arc::new(branch));
            }
            Finding::Curve(curve) => {
                self.curves.insert(task, Arc::new(curve));
            }
            Finding::Nothing(_) => {}
        }
    }

    /// The branches and curves of a grant; what is not at hand is fetched. Waits while there is no answer at all.
    pub async fn get(
        &mut self,
        bus: &Bus,
        lease: &Lease,
        known: &[Known],
        curves: &[KnownCurve],
    ) -> Result<Found, String> {
        self.branches.retain(|task, _| known.iter().any(|known| known.task == *task));
        self.curves.retain(|task, _| curves.iter().any(|known| known.task == *task));
        let (size, harmonics, most) = (self.size, self.harmonics, self.most);
        let mut found = Found::default();
        for Known { branch: id, task } in known {
            let branch = match self.branches.get(task) {
                Some(branch) => branch.clone(),
                None => {
                    let message = fetch(bus, lease, task, most).await?.branch;
                    let branch = message.ok_or_else(|| format!("the result of task {task}: not a branch"))?;
                    check(task, branch.points.motions.harmonics, harmonics)?;
                    let branch = branch.branch(&size).map_err(|error| format!("the result of task {task}: {error}"))?;
                    self.branches.entry(task.clone()).or_insert(Arc::new(branch)).clone()
                }
            };
            found.branches.push((*id, branch));
        }
        for KnownCurve { number, task } in curves {
            let curve = match self.curves.get(task) {
                Some(curve) => curve.clone(),
                None => {
                    let message = fetch(bus, lease, task, most).await?.curve;
                    let curve = message.ok_or_else(|| format!("the result of task {task}: not a fold curve"))?;
                    check(task, curve.points.motions.harmonics, harmonics)?;
                    let curve = curve.curve(&size).map_err(|error| format!("the result of task {task}: {error}"))?;
                    self.curves.entry(task.clone()).or_insert(Arc::new(curve)).clone()
                }
            };
            found.curves.push((*number, curve));
        }
        Ok(found)
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
