//! What a sweep needs beside the model: from the store, or computed.

use crate::bus::PublishedSweep;
use crate::engine::{Beginning, Decider, Event, Stored};
use crate::error::Error;
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use protocol::from_worker::Progress;
use protocol::session::MAX_RESULT_BYTES;
use protocol::to_everyone::{Amplitude, Manifest, Stage};
use results::journal::{LevelPlan, SweepPlan};
use results::overview::most_folds;
use results::store::{RunHeader, Store};
use solver::formulation::modal::Modal;
use solver::response::backbone::Backbone;
use solver::response::branch::BranchPoint;
use solver::response::forced::SearchRange;
use solver::response::modes::Backbones;
use solver::response::scout::scouts;
use solver::response::starts;
use solver::response::task::{Task, plan};
use solver::settings::Settings;
use solver::structure::Model;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between two reports of where the backbone is.
const REPORT_PERIOD: Duration = Duration::from_millis(200);

/// A sweep that can begin.
pub struct Prepared {
    /// What anyone may ask for.
    pub sweep: Arc<PublishedSweep>,
    /// What the engine begins with.
    pub beginning: Beginning,
}

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
        modes: None,
        amplitudes: header.amplitudes.clone(),
        monitors: header.model.monitors.iter().map(dof).collect(),
        stage,
        lease_ms: lease.as_millis() as u64,
        max_result_bytes: MAX_RESULT_BYTES,
    }
}

/// The model of a run.
///
/// # Errors
/// If the store cannot be read or contradicts itself.
pub fn model(store: &Store) -> Result<Model, Error> {
    store.model()?.model().map_err(|error| Error::Other(format!("the stored model: {error}")))
}

/// What a store already has of the sweep of a run; `None` as long as there is no backbone.
///
/// # Errors
/// If the store cannot be read or contradicts itself.
pub fn stored(store: &Store, model: &Model) -> Result<Option<Prepared>, Error> {
    let (Some(message), Some(reach)) = (store.backbone()?, store.reach()?) else { return Ok(None) };
    let further = store.further_backbones()?;
    let left_out = store.modes_left_out()?.unwrap_or_default();
    let backbones = backbones(model, std::iter::once(&message).chain(&further))?;
    let (levels, added) = (store.plans()?, store.added()?);
    let plan = Arc::new(SweepPlan { backbone: message, further, left_out, reach, levels, added });
    let stored = Some(Stored { tasks: store.tasks()?, extents: store.extents()?, kept: store.kept()? });
    let sweep = Arc::new(PublishedSweep::new(Modal::new(model), backbones, plan.clone()));
    Ok(Some(Prepared { sweep, beginning: Beginning { plan, stored } }))
}

fn backbones<'m>(model: &Model, messages: impl Iterator<Item = &'m BackboneMessage>) -> Result<Vec<Backbone>, Error> {
    let size = Size::of(model);
    let backbones: Result<_, _> = messages.map(|message| message.backbone(&size)).collect();
    backbones.map_err(|error| Error::Other(format!("a stored backbone: {error}")))
}

/// What follows from the stored backbones for the levels from `first` on, which are added to those before; `None` as long as there
/// is no backbone.
///
/// # Errors
/// If the store cannot be read, or the bounds of the study contradict the backbones.
pub fn extended(
    store: &Store,
    model: &Model,
    settings: &Settings,
    all: &[Amplitude],
    first: usize,
) -> Result<Option<(SearchRange, Vec<LevelPlan>)>, Error> {
    let Some(primary) = store.backbone()? else { return Ok(None) };
    let further = store.further_backbones()?;
    let backbones = backbones(model, std::iter::once(&primary).chain(&further))?;
    Ok(Some((reach(settings, &backbones, all)?, levels(model, settings, &backbones, all, first))))
}

/// Within which frequencies and amplitudes the branches of all levels are followed.
fn reach(settings: &Settings, backbones: &[Backbone], all: &[Amplitude]) -> Result<SearchRange, Error> {
    let values = || all.iter().map(|amplitude| amplitude.value);
    let highest = values().fold(0.0, f64::max);
    Ok(SearchRange::over(settings, &backbones[0], &backbones[1..], highest)?.with_folds_of(values()))
}

/// Windows and tasks of the levels from `first` on.
fn levels(
    model: &Model,
    settings: &Settings,
    backbones: &[Backbone],
    all: &[Amplitude],
    first: usize,
) -> Vec<LevelPlan> {
    let batches = starts::batches(model, settings);
    // They bring nothing but folds.
    let follows_folds = most_folds(model, settings) > 0;
    let largest = largest(all);
    let level = |(index, amplitude): (usize, &Amplitude)| {
        let share = starts::share(batches, index, all.len());
        let (windows, mut tasks) = plan(backbones, amplitude.value, &settings.frequency, share);
        if amplitude.value == largest && follows_folds {
            tasks.extend(scouts(batches).map(Task::Scout));
        }
        LevelPlan { amplitude: amplitude.clone(), windows, tasks }
    };
    all.iter().enumerate().skip(first).map(level).collect()
}

fn largest(amplitudes: &[Amplitude]) -> f64 {
    amplitudes.iter().map(|amplitude| amplitude.value).fold(0.0, f64::max)
}

/// Computes the backbones, and from them the tasks of every level; `None` if `stop` was set meanwhile. Tells the engine where
/// that of the primary mode is.
///
/// # Errors
/// If the backbone of the primary mode does not start, or the bounds of branches contradict it.
pub fn compute(
    header: &RunHeader,
    model: &Model,
    engine: &Decider,
    stop: &AtomicBool,
) -> Result<Option<Prepared>, Error> {
    let settings = &header.settings;
    let mut points = 0;
    let mut told = Instant::now();
    let mut observer = |point: &BranchPoint| {
        points += 1;
        if told.elapsed() > REPORT_PERIOD {
            told = Instant::now();
            let progress = Progress { points, omega: point.omega(), amplitude: point.amplitude() };
            engine.tell(Event::Backbone(progress));
        }
        if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let largest = largest(&header.amplitudes);
    let Backbones { list: backbones, left_out } = Backbones::reaching(model, settings, largest, &mut observer, stop)?;
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let reach = reach(settings, &backbones, &header.amplitudes)?;
    let levels = levels(model, settings, &backbones, &header.amplitudes, 0);
    let mut messages = backbones.iter().map(BackboneMessage::from);
    let backbone = messages.next().expect("that of the primary mode is there");
    let (further, added) = (messages.collect(), Vec::new());
    let plan = Arc::new(SweepPlan { backbone, further, left_out, reach, levels, added });
    let sweep = Arc::new(PublishedSweep::new(Modal::new(model), backbones, plan.clone()));
    Ok(Some(Prepared { sweep, beginning: Beginning { plan, stored: None } }))
}
