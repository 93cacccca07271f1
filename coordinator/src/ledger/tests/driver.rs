//! A ledger that is driven by events, and what a store would hold of it.

use super::*;

/// Drives a ledger, keeping what a store would hold.
pub(super) struct Driver {
    pub verify: VerifyEffort,
    pub ledger: Ledger,
    pub now: Duration,
    /// Leases that workers believe to hold, with what they will find.
    pub held: Vec<(Lease, Granted)>,
    pub accepted: Vec<TaskId>,
    /// New branches and curves.
    pub new: HashMap<TaskId, Brought>,
    pub changes: Vec<Change>,
    /// How many results were repeated.
    pub repeated: usize,
    /// Who is wrong wherever that cannot be checked, and with what it was.
    pub liar: Option<WorkerId>,
    pub lies: Vec<(TaskId, Attempt)>,
}

impl Driver {
    pub fn new(levels: usize, verify: VerifyEffort) -> Self {
        let ledger = Ledger::new(rules(verify), plans(levels));
        let (held, accepted, new, changes, repeated, liar, lies) = Default::default();
        Self { verify, ledger, now: Duration::ZERO, held, accepted, new, changes, repeated, liar, lies }
    }

    fn rules(&self) -> Rules {
        match self.liar {
            Some(_) => super::disputes::rules(self.verify),
            None => rules(self.verify),
        }
    }

    /// An entry as the store has it.
    pub fn stored(&self, entry: &TaskEntry) -> StoredTask {
        StoredTask {
            id: entry.id.clone(),
            state: entry.state.clone(),
            brought: self.new.get(&entry.id).cloned(),
            holders: entry.holders.clone(),
            troubles: Troubles::default(),
            evidence: evidence(&self.changes, &entry.id),
        }
    }

    pub fn apply(&mut self, event: &Event) {
        let pick = |index: usize, held: &[(Lease, Granted)]| (!held.is_empty()).then(|| index % held.len());
        match *event {
            Event::Lease(worker) => self.lease(worker),
            Event::Submit(index) => {
                if let Some(i) = pick(index, &self.held) {
                    let (lease, granted) = self.held[i].clone();
                    self.submit(&lease, &granted);
                }
            }
            Event::Fail(index) | Event::Release(index) => {
                if let Some(i) = pick(index, &self.held) {
                    let (lease, _) = self.held.swap_remove(i);
                    let ended = match event {
                        Event::Fail(_) => self.ledger.fail(&lease, "out of memory", self.now),
                        _ => self.ledger.release(&lease, self.now),
                    };
                    self.changes.extend(ended.1);
                }
            }
            Event::Renew(index) => {
                if let Some(i) = pick(index, &self.held) {
                    let (_, changes) = self.ledger.renew(&self.held[i].0.clone(), None, self.now);
                    self.changes.extend(changes);
                }
            }
            Event::Gone(worker) => self.ledger.worker_gone(&name(worker), self.now),
            // A worker dies without a word.
            Event::Forget(index) => {
                if let Some(i) = pick(index, &self.held) {
                    self.held.swap_remove(i);
                }
            }
            Event::Later(seconds) => {
                self.now += Duration::from_secs(seconds);
                let changes = self.ledger.tick(self.now);
                self.changes.extend(changes);
            }
            Event::Restart => self.restart(),
        }
    }

    fn lease(&mut self, worker: u8) {
        let (leased, changes) = self.ledger.lease(&name(worker), 0, self.now);
        self.changes.extend(changes);
        if let Leased::Grant(granted) = leased {
            let lease = Lease { task: granted.task.clone(), attempt: granted.attempt, worker: name(worker), slot: 0 };
            if !self.held.iter().any(|(held, _)| *held == lease) {
                self.held.push((lease, granted));
            }
        }
    }

    /// The worker keeps the lease, as if the answer had been lost: it will submit again.
    fn submit(&mut self, lease: &Lease, granted: &Granted) {
        let lie = lie(granted).filter(|_| Some(&lease.worker) == self.liar.as_ref());
        self.lies.extend(lie.as_ref().map(|_| (lease.task.clone(), lease.attempt)));
        let brought = lie.unwrap_or_else(|| find(granted));
        let (submitted, changes) = self.ledger.submit(lease, &brought);
        for change in &changes {
            if let Change::Withdrawn { task } = change {
                self.accepted.retain(|accepted| accepted != task);
            }
        }
        self.changes.extend(changes);
        match submitted {
            Submitted::Accepted(_) => {
                assert!(!self.accepted.contains(&lease.task), "{} was accepted twice", lease.task);
                self.accepted.push(lease.task.clone());
                self.ledger.note_claim(lease, 1.0, Duration::MAX);
                if matches!(brought, Brought::Branch { .. } | Brought::Curve(_) | Brought::Verification(..)) {
                    self.new.insert(lease.task.clone(), brought);
                }
            }
            Submitted::Repeated { .. } | Submitted::Duplicate | Submitted::Late if self.liar.is_some() => {}
            Submitted::Repeated { agrees, .. } => {
                assert!(agrees, "{} is found again as it was", lease.task);
                assert!(self.accepted.contains(&lease.task));
                self.repeated += 1;
            }
            Submitted::Duplicate => assert!(self.accepted.contains(&lease.task)),
            Submitted::Late => panic!("nothing is given up here"),
            Submitted::Foreign => panic!("{} is for something else", lease.task),
            Submitted::NeverGranted => panic!("{} was granted", lease.task),
            Submitted::Unknown => panic!("{} is a task of the run", lease.task),
        }
    }

    /// The coordinator is killed and starts again with what the changes say.
    fn restart(&mut self) {
        let mut tasks: Vec<StoredTask> = self
            .ledger
            .entries()
            .map(|entry| StoredTask { troubles: entry.troubles.clone(), ..self.stored(entry) })
            .collect();
        let order = |id: &TaskId| self.accepted.iter().position(|accepted| accepted == id).unwrap_or(usize::MAX);
        tasks.sort_by_key(|task| order(&task.id));
        let before = (book(&self.ledger), self.ledger.sequence());
        let (levels, added) = self.planned();
        let (ledger, changes) = Ledger::restore(self.rules(), levels, &added, tasks, self.now);
        assert!(changes.is_empty(), "what is stored together is restored together");
        self.ledger = ledger;
        let settled = |book: &Book| -> Book {
            let keep = |(_, state): &&(TaskId, TaskState)| matches!(state, TaskState::Done(_) | TaskState::Skipped);
            book.iter().filter(keep).cloned().collect()
        };
        assert_eq!(settled(&before.0), settled(&book(&self.ledger)));
        assert_eq!(before.1, self.ledger.sequence());
    }

    /// The tasks that a store would have.
    pub fn planned(&self) -> (Vec<LevelPlan>, Vec<AddedTask>) {
        let level = |(chain, level): (&Chain, &LevelRecord)| LevelPlan {
            amplitude: level.amplitude.clone(),
            windows: level.account.windows.iter().map(|window| window.window).collect(),
            tasks: chain.entries.iter().map(|entry| entry.task).collect(),
        };
        let levels: Vec<LevelPlan> = self.ledger.levels().map(level).collect();
        let added = |entry: &TaskEntry| AddedTask {
            id: entry.id.clone(),
            amplitude: levels[entry.level].amplitude.text.clone(),
            task: entry.task,
        };
        let of_all = [self.ledger.curves(), self.ledger.verifications()];
        let entries = of_all.into_iter().flat_map(|c| &self.ledger.chains[c].entries);
        let added = entries.map(added).collect();
        (levels, added)
    }

    /// Lets the run come to its end without further trouble.
    pub fn conclude(&mut self) {
        for _ in 0..10_000 {
            if self.ledger.is_finished() {
                return;
            }
            self.now += Duration::from_secs(60);
            let workers = if self.liar.is_some() { 3 } else { 1 };
            (0..workers).for_each(|worker| self.lease(worker));
            for (lease, granted) in std::mem::take(&mut self.held) {
                self.submit(&lease, &granted);
            }
        }
        panic!("the run does not end");
    }
}

/// What a store would have of what was said of a task.
pub(super) fn evidence(changes: &[Change], id: &TaskId) -> Evidence {
    let mut known = Evidence::default();
    for change in changes {
        match change {
            Change::Done { task, attempt, .. } if task == id => known.result = Some((*attempt, 1.0)),
            Change::Withdrawn { task } if task == id => known.result = None,
            Change::Said { task, attempt, said } if task == id => known.said.push((*attempt, *said)),
            Change::Ended { task, attempt, end } if task == id => {
                known.ends.retain(|(other, _)| other != attempt);
                let is_kept = matches!(
                    end,
                    AttemptEnd::Refused(_) | AttemptEnd::Confirmed | AttemptEnd::Disputed(_) | AttemptEnd::Refuted(_)
                );
                if is_kept {
                    known.ends.push((*attempt, end.clone()));
                }
            }
            _ => {}
        }
    }
    known
}

/// What somebody says who finds nothing, where something is that cannot be checked.
pub(super) fn lie(granted: &Granted) -> Option<Brought> {
    let outcome = match granted.work {
        Task::Main(_) | Task::Verify(_) | Task::Disturb(_) | Task::March(_) => return None,
        Task::Scout(_) => SeedOutcome::NoFold,
        Task::Fold(_) | Task::Carry(_) => SeedOutcome::NotFollowed(Unfollowed::Elsewhere),
        _ => SeedOutcome::NotLanded(LandingFailure::NotConverged(Unreached::OutOfReach)),
    };
    let nothing = Brought::Nothing(outcome);
    let says = |brought: &Brought| Said::by(brought).unwrap_or(Said::New);
    (says(&find(granted)) != says(&nothing)).then_some(nothing)
}
