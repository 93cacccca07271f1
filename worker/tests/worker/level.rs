//! A whole level, task by task.

use crate::fake::{Answer, Asked, Fake, Seen, drained, fine, grant, hand_out, own_endpoint, wait};
use crate::study::Study;
use protocol::branch::TaskResultMessage;
use protocol::curve::Size;
use protocol::from_worker::SubmitRequest;
use protocol::ids::TaskId;
use protocol::to_everyone::{Amplitude, StoredResult};
use protocol::to_worker::{Known, SubmitReply};
use solver::response::account::Account;
use solver::response::branch::{Branch, Side};
use solver::response::level::Level;
use solver::response::task::{BranchId, SeedOutcome, Task, plan};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use worker::Ending;

/// Hands out the tasks of a level in their order and takes down what comes back.
struct Desk {
    study: Study,
    tasks: VecDeque<(usize, Task)>,
    /// Whether the first task is under way.
    handed_out: bool,
    account: Account,
    found: Vec<(Known, Branch)>,
}

impl Desk {
    fn new(study: Study) -> Self {
        let (windows, tasks) = plan(&study.backbone, 0.008, &study.settings.frequency, 0);
        Self {
            study,
            tasks: tasks.into_iter().enumerate().collect(),
            handed_out: false,
            account: Account::new(windows),
            found: Vec::new(),
        }
    }

    /// The next task, once the one before is done.
    fn next(&mut self) -> Answer {
        if self.handed_out {
            return wait();
        }
        while self.tasks.front().is_some_and(|(_, task)| !self.account.needs(task)) {
            self.tasks.pop_front();
        }
        let known = self.found.iter().map(|(known, _)| known.clone()).collect();
        self.handed_out = !self.tasks.is_empty();
        self.tasks.front().map_or_else(drained, |&(index, task)| grant(self.study.grant(index, task, known)))
    }

    /// Records a result; gives the stored form.
    fn take(&mut self, request: &SubmitRequest) -> StoredResult {
        let (index, work) = self.tasks.pop_front().unwrap();
        self.handed_out = false;
        let task = TaskId::of_level("0.008", index).unwrap();
        assert_eq!(request.lease.task, task);
        let outcome = self.account.outcome(&request.finding.brought()).unwrap();
        self.account.record(&work, outcome);
        let branch = match &request.finding {
            TaskResultMessage::Branch(branch) => Some(branch.clone()),
            _ => None,
        };
        let landings = match &request.finding {
            TaskResultMessage::Landings(landings) => Some(landings.clone()),
            _ => None,
        };
        let name = match (outcome, &branch) {
            (SeedOutcome::Found(id), Some(branch)) => {
                let branch = branch.branch(&Size::of(&self.study.model)).unwrap();
                self.found.push((Known { branch: id, task: task.clone() }, branch));
                Some(id)
            }
            _ => None,
        };
        StoredResult {
            task,
            attempt: request.lease.attempt,
            amplitude: Amplitude { text: "0.008".into(), value: 0.008 },
            work,
            outcome,
            name,
            branch,
            curve: None,
            landings,
            verification: None,
            disturbance: None,
            settling: None,
            worker: request.lease.worker.clone(),
            program: request.program.clone(),
            seconds: request.seconds,
        }
    }
}

/// Level by a worker; `accept` is what it hears when it submits.
async fn by_worker(accept: SubmitReply) -> (Vec<(BranchId, Branch)>, Account) {
    let study = Study::new(3);
    let desk = Arc::new(Mutex::new(Desk::new(Study::new(3))));
    let seen = Arc::new(Seen::default());
    let answer = {
        let (desk, seen) = (desk.clone(), seen.clone());
        move |asked: &Asked| match asked {
            Asked::Lease(_) => desk.lock().unwrap().next(),
            Asked::Submit(request) => {
                let stored = desk.lock().unwrap().take(request);
                seen.results.lock().unwrap().insert(stored.task.clone(), stored);
                Answer::Submit(accept.clone())
            }
            _ => fine(asked),
        }
    };
    let fake = Fake::start_at(&own_endpoint(), seen, &study, answer).await;
    let summary = fake.work(&[]).await.unwrap();
    assert_eq!(summary.ending, Ending::Drained);
    assert_eq!(summary.done, fake.seen.submitted().len());
    let desk = desk.lock().unwrap();
    let found = desk.found.iter().map(|(known, branch)| (known.branch, branch.clone())).collect();
    (found, desk.account.clone())
}

fn assert_is_the_level((found, account): (Vec<(BranchId, Branch)>, Account)) {
    let study = Study::new(3);
    let level = Level::compute(&study.model, &study.settings, &study.backbone, 0.008).unwrap();
    assert_eq!(level.isolas().count(), 1);
    assert_eq!(account.windows, level.windows);
    let expected: Vec<(BranchId, Branch)> = level.branches().map(|(id, branch)| (id, branch.clone())).collect();
    assert_eq!(found, expected);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_level_by_tasks_is_the_level() {
    assert_is_the_level(by_worker(SubmitReply::Accepted).await);
}

/// What another worker found is fetched, even where this one found the same.
#[tokio::test(flavor = "multi_thread")]
async fn known_branches_come_from_the_store() {
    assert_is_the_level(by_worker(SubmitReply::Duplicate { agrees: true }).await);
}

/// Answers nothing but leases of tasks that end at once: every one is done once, in order, by several threads.
#[tokio::test(flavor = "multi_thread")]
async fn many_small_tasks() {
    let study = Study::new(1);
    let small = |index: usize| {
        let mut grant = study.grant(index, Task::Main(Side::Below), Vec::new());
        grant.reach.frequency.1 = grant.reach.frequency.0 * (1.0 + 1e-12);
        grant
    };
    let fake = Fake::start(&study, hand_out((0..400).map(small).collect())).await;
    let started = std::time::Instant::now();
    let summary = fake.work(&["--slots", "3"]).await.unwrap();
    println!("{:.0} tasks/s", 400.0 / started.elapsed().as_secs_f64());
    assert_eq!(summary.done, 400);
    let mut tasks: Vec<TaskId> = fake.seen.submitted().into_iter().map(|request| request.lease.task).collect();
    tasks.sort();
    tasks.dedup();
    assert_eq!(tasks.len(), 400);
    assert_eq!(fake.seen.count(Asked::is_fail), 0);
}
