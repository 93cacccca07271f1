//! The state machine of a run.

use super::checked_result::CheckedResult;
use super::decision::{Answer, Decision, News};
use super::event::{Beginning, Event};
use super::parking::Parking;
use super::sweep::Sweep;
use crate::ledger::{Ledger, Rules};
use protocol::control::{ControlReply, ControlRequest};
use protocol::from_worker::{FailRequest, Lease, LeaseRequest, Progress, ReleaseRequest, RenewRequest};
use protocol::to_everyone::{Manifest, Stage, Status};
use protocol::to_worker::SubmitReply;
use results::journal::{Change, Holder};
use std::time::Duration;

/// Time between two reports of the status.
const STATUS_PERIOD: Duration = Duration::from_millis(500);
/// When to ask again a coordinator that is about to end.
const LATER: Duration = Duration::from_secs(1);
/// What a cancelled run answers.
const CANCELLED: &str = "the run was cancelled";

/// Decides what follows from events. Times are durations since the start of this process's part in the run.
#[derive(Debug)]
pub struct Engine {
    manifest: Manifest,
    rules: Rules,
    /// Where the backbone is, as long as it is being computed.
    backbone: Option<Progress>,
    sweep: Option<Sweep>,
    /// Threads without work.
    parking: Parking,
    /// When the status was last told.
    reported: Option<Duration>,
    stopping: bool,
}

impl Engine {
    /// Engine of the run that `manifest` describes.
    pub fn new(manifest: Manifest, rules: Rules) -> Self {
        let (backbone, sweep, parking, reported, stopping) = Default::default();
        Self { manifest, rules, backbone, sweep, parking, reported, stopping }
    }

    /// Decides.
    pub fn handle(&mut self, event: Event, now: Duration) -> Decision {
        self.hear_of(&event);
        let mut decision = match (event, &mut self.sweep) {
            (Event::Lease(request), _) => self.lease(&request, now),
            (Event::Control(request), _) => self.control(request, now),
            (Event::Begin(beginning), _) => self.begin(*beginning, now),
            (Event::Tick, _) => self.tick(now),
            (Event::Stop, _) => {
                self.stopping = true;
                Decision::default()
            }
            (Event::Backbone(progress), _) => {
                self.backbone = Some(progress);
                Decision::default()
            }
            // Asked again without an answer: the sweep is about to begin.
            (_, None) => Decision::default(),
            (Event::Renew(RenewRequest { lease, progress }), Some(sweep)) => sweep.renew(&lease, progress, now),
            (Event::Checkpoint(lease, part), Some(sweep)) => {
                sweep.checkpoint(&lease, part, self.manifest.max_checkpoint_bytes())
            }
            (Event::Offer(lease), Some(sweep)) => sweep.offer(&lease, &self.manifest.run),
            (Event::Refused(lease, why), Some(sweep)) => sweep.refuse(&lease, why, now),
            (Event::Submit(result), _) => self.submit(*result, now),
            (Event::Fail(FailRequest { lease, reason }), Some(sweep)) => sweep.fail(&lease, &reason, now),
            (Event::Release(ReleaseRequest { lease }), Some(sweep)) => sweep.release(&lease, now),
            (Event::WorkerGone(worker), Some(sweep)) => {
                sweep.ledger.worker_gone(&worker, now);
                Decision::default()
            }
            (Event::Stalled, Some(sweep)) => {
                sweep.ledger.forbear(now);
                Decision::default()
            }
            (Event::Progress(task, progress), Some(sweep)) => {
                sweep.ledger.note(&task, progress, now);
                Decision::default()
            }
        };
        if let Some(sweep) = &mut self.sweep {
            sweep.checkpoints.follow(&decision.changes);
        }
        let is_finished = self.sweep.as_ref().is_some_and(|sweep| sweep.ledger.is_finished());
        match self.manifest.stage {
            Stage::Sweep if is_finished => self.enter(Stage::Finished, now, &mut decision),
            // A result of a task that had been given up came after all, and others follow from it.
            Stage::Finished if self.sweep.is_some() && !is_finished => self.enter(Stage::Sweep, now, &mut decision),
            _ => {}
        }
        self.wake(now, &mut decision);
        decision
    }

    /// Threads that ask, or are about to since their results have come, need not be woken.
    fn hear_of(&mut self, event: &Event) {
        match event {
            Event::Lease(LeaseRequest { worker, slot, .. }) => {
                self.parking.leave(&Holder { worker: worker.clone(), slot: *slot });
            }
            Event::WorkerGone(worker) => self.parking.forget(worker),
            Event::Tick => self.parking.give_up_on_woken(),
            _ => {}
        }
    }

    /// Wakes a thread for every task that can be handed out, and all of them when there will be none.
    fn wake(&mut self, now: Duration, decision: &mut Decision) {
        let Some(sweep) = self.sweep.as_ref().filter(|_| !self.parking.is_empty() && !self.stopping) else { return };
        if self.manifest.stage.is_over() {
            self.parking = Parking::default();
            decision.news.push(News::Hint);
            return;
        }
        let woken = self.parking.wake(sweep.ledger.offered_now(now));
        decision.news.extend(woken.into_iter().map(News::Wake));
    }

    /// Has a thread for which there is no work wait.
    fn park(&mut self, request: &LeaseRequest) -> Answer {
        Answer::Wait(self.parking.park(Holder { worker: request.worker.clone(), slot: request.slot }))
    }

    fn lease(&mut self, request: &LeaseRequest, now: Duration) -> Decision {
        let without_task = |answer| Decision::new(answer, Vec::new());
        if request.protocol != protocol::VERSION {
            return without_task(Answer::Stop(other_version(request)));
        }
        let Some(sweep) = &mut self.sweep else {
            let is_cancelled = self.manifest.stage == Stage::Cancelled;
            return without_task(if is_cancelled { Answer::Stop(CANCELLED.into()) } else { self.park(request) });
        };
        if self.stopping {
            return without_task(Answer::Wait(LATER));
        }
        let mut decision = sweep.lease(&request.worker, request.slot, CANCELLED, now);
        if matches!(decision.answer, Some(Answer::Wait(_))) {
            decision.answer = Some(self.park(request));
        }
        decision
    }

    /// A result; an accepted one is answered with the next task if the thread has nothing else to do, or there is plenty: the thread
    /// has it at hand then when it is done with what it computes.
    fn submit(&mut self, result: CheckedResult, now: Duration) -> Decision {
        // Asked again without an answer: the sweep is about to begin.
        let Some(sweep) = &mut self.sweep else { return Decision::default() };
        let (holder, takes_next) = (holder_of(&result.lease), result.next && !self.stopping);
        let mut decision = sweep.submit(result, &self.manifest.run, now);
        let waiting = self.parking.waiting_of(&holder).cloned();
        let takes_next = takes_next && (waiting.is_some() || sweep.ledger.has_plenty(now));
        if takes_next && decision.answer == Some(Answer::Submit(SubmitReply::Accepted)) {
            let Decision { changes, answer, .. } = sweep.lease(&holder.worker, holder.slot, CANCELLED, now);
            decision.changes.extend(changes);
            if let Some(Answer::Grant(granted)) = answer {
                waiting.iter().for_each(|waiting| self.parking.leave(waiting));
                decision.answer = Some(Answer::Next(granted));
            }
        }
        decision
    }

    fn begin(&mut self, beginning: Beginning, now: Duration) -> Decision {
        let mut decision = Decision::default();
        // Cancelled in between.
        if self.manifest.stage == Stage::Cancelled {
            return decision;
        }
        self.manifest.reach = Some(beginning.plan.reach);
        self.manifest.modes = Some(beginning.plan.modes());
        let (sweep, changes) = Sweep::begin(self.rules, beginning, now);
        self.sweep = Some(sweep);
        decision.changes = changes;
        self.enter(Stage::Sweep, now, &mut decision);
        decision
    }

    fn control(&mut self, request: ControlRequest, now: Duration) -> Decision {
        let mut decision = Decision::default();
        let run = self.manifest.run.clone();
        let message = match (request, &mut self.sweep, self.manifest.stage) {
            (ControlRequest::Cancel, _, Stage::Finished) => format!("run {run} has finished already"),
            (ControlRequest::Cancel, sweep, _) => {
                sweep.iter_mut().for_each(|sweep| sweep.ledger.cancel());
                self.enter(Stage::Cancelled, now, &mut decision);
                decision.news.push(News::Hint);
                format!("run {run} is cancelled; what is stored stays")
            }
            (ControlRequest::RetryDead, _, Stage::Cancelled) => {
                format!("run {run} was cancelled: go on with `isola resume` first")
            }
            (ControlRequest::RetryDead, None, _) => format!("run {run} has not begun: there are no dead tasks"),
            (ControlRequest::RetryDead, Some(sweep), stage) => {
                decision.changes = sweep.ledger.retry_dead();
                let is_revived = |change: &&Change| matches!(change, Change::Revived { .. });
                let count = decision.changes.iter().filter(is_revived).count();
                if count > 0 && stage == Stage::Finished {
                    self.enter(Stage::Sweep, now, &mut decision);
                }
                match count {
                    0 => format!("no task of run {run} was given up: there is nothing to try again"),
                    1 => format!("1 dead task of run {run} is tried again"),
                    _ => format!("{count} dead tasks of run {run} are tried again"),
                }
            }
        };
        decision.answer = Some(Answer::Control(ControlReply { message }));
        decision
    }

    fn tick(&mut self, now: Duration) -> Decision {
        let mut decision = Decision::default();
        // While the process ends nobody is asked to go on, and nothing is held against anybody.
        if let Some(sweep) = self.sweep.as_mut().filter(|_| !self.stopping) {
            sweep.ledger.measure(now);
            decision.changes = sweep.ledger.tick(now);
        }
        if self.reported.is_none_or(|reported| now >= reported + STATUS_PERIOD) {
            self.reported = Some(now);
            decision.news.push(News::Status(self.status(now)));
            let load = self.sweep.as_mut().map(|sweep| sweep.ledger.load(now));
            decision.news.extend(load.map(|load| News::Load(Box::new(load))));
        }
        decision
    }

    fn enter(&mut self, stage: Stage, now: Duration, decision: &mut Decision) {
        self.manifest.stage = stage;
        decision.changes.push(Change::Stage(stage));
        decision.news.push(News::Manifest(Box::new(self.manifest.clone())));
        decision.news.push(News::Status(self.status(now)));
    }

    fn status(&self, now: Duration) -> Status {
        let ledger = self.sweep.as_ref().map(|sweep| &sweep.ledger);
        let tasks = ledger.map(Ledger::counts).unwrap_or_default();
        let (levels, levels_done) = ledger.map_or((self.manifest.amplitudes.len(), 0), Ledger::progress_of_levels);
        Status {
            run: self.manifest.run.clone(),
            name: self.manifest.name.clone(),
            stage: self.manifest.stage,
            backbone: self.backbone,
            tasks,
            levels,
            levels_done,
            active: ledger.map(Ledger::active).unwrap_or_default(),
            workers: ledger.map(Ledger::workers).unwrap_or_default(),
            stalled: ledger.map(|ledger| ledger.stalled(now)).unwrap_or_default(),
            sequence: ledger.map_or(0, Ledger::sequence),
            elapsed: now.as_secs_f64(),
            eta: ledger.and_then(Ledger::time_left),
        }
    }
}

fn holder_of(Lease { worker, slot, .. }: &Lease) -> Holder {
    Holder { worker: worker.clone(), slot: *slot }
}

fn other_version(request: &LeaseRequest) -> String {
    format!(
        "worker {} speaks version {} of the messages (Isola {}), this run version {} (Isola {}): install the same Isola on \
         both sides",
        request.worker,
        request.protocol,
        request.program,
        protocol::VERSION,
        protocol::PROGRAM
    )
}
