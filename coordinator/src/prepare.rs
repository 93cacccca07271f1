//! What a sweep needs beside the model: from the store, or computed.

use crate::engine::{Job, Ready};
use crate::error::Error;
use crate::ledger::LevelPlan;
use crate::store::{RunHeader, Store};
use protocol::from_worker::Progress;
use protocol::to_everyone::{Amplitude, Manifest, Stage};
use solver::backbone::Backbone;
use solver::branch::BranchPoint;
use solver::forced::Reach;
use solver::model::Model;
use solver::settings::Settings;
use solver::task::plan;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// Largest result accepted.
const MAX_RESULT_BYTES: usize = 256 << 20;
/// Time between two reports of where the backbone is.
const REPORT_PERIOD: Duration = Duration::from_millis(200);

/// The manifest of a run that begins or goes on.
pub fn manifest(header: &RunHeader, stage: Stage, lease: Duration) -> Manifest {
    let dof = |&index: &usize| header.model.dofs[index].clone();
    Manifest {
        protocol: protocol::VERSION,
        program: protocol::PROGRAM.into(),
        run: header.run.clone(),
        name: header.name.clone(),
        model_sha256: header.model_sha256.clone(),
        settings: header.settings,
        reach: None,
        amplitudes: header.amplitudes.clone(),
        monitors: header.model.monitors.iter().map(dof).collect(),
        stage,
        lease_ms: lease.as_millis() as u64,
        max_result_bytes: MAX_RESULT_BYTES,
    }
}

/// What a store already has of a run.
///
/// # Errors
/// If the store cannot be read or contradicts itself.
pub fn stored(store: &Store) -> Result<Option<Ready>, Error> {
    let (Some(message), Some(reach)) = (store.backbone()?, store.reach()?) else { return Ok(None) };
    let size = protocol::curve::Size::of(&model(store)?);
    let backbone = message.backbone(&size).map_err(|error| Error::Other(format!("the stored backbone: {error}")))?;
    Ok(Some(Ready { backbone, reach, plans: store.plans()?, tasks: store.tasks()?, fresh: false }))
}

/// The model of a run.
///
/// # Errors
/// If the store cannot be read or contradicts itself.
pub fn model(store: &Store) -> Result<Model, Error> {
    store.model()?.model().map_err(|error| Error::Other(format!("the stored model: {error}")))
}

/// Computes the backbone, and from it the tasks of every level; `None` if `stop` was set meanwhile.
///
/// # Errors
/// If the backbone does not start, or the bounds of branches contradict it.
pub fn compute(
    model: &Model,
    settings: &Settings,
    amplitudes: Vec<Amplitude>,
    jobs: &Sender<Job>,
    stop: &AtomicBool,
) -> Result<Option<Ready>, Error> {
    let mut points = 0;
    let mut told = Instant::now();
    let mut observer = |point: &BranchPoint| {
        points += 1;
        if told.elapsed() > REPORT_PERIOD {
            told = Instant::now();
            let progress = Progress { points, omega: point.omega(), amplitude: point.amplitude() };
            // If the engine has ended, that is noticed elsewhere.
            let _ = jobs.send(Job::Backbone(progress));
        }
        if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let backbone = Backbone::compute(model, settings, &mut observer)?;
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let reach = Reach::new(settings, &backbone)?;
    let plans = amplitudes.into_iter().map(|amplitude| {
        let (windows, tasks) = plan(&backbone, amplitude.value);
        LevelPlan { amplitude, windows, tasks }
    });
    Ok(Some(Ready { plans: plans.collect(), backbone, reach, tasks: Vec::new(), fresh: true }))
}
