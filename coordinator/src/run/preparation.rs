//! What a sweep needs beside the model: from the store, or computed.

use crate::bus::PublishedSweep;
use crate::check::without_backbone;
use crate::engine::{Beginning, Decider, Event, Stored};
use crate::error::Error;
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use protocol::from_worker::Progress;
use protocol::session::MAX_RESULT_BYTES;
use protocol::to_everyone::{Amplitude, Manifest, Stage};
use results::journal::{LevelPlan, MorePlan, OrderPlan, SweepPlan};
use results::overview::most_folds;
use results::store::{RunHeader, Store};
use results::summary_table::UnitChoice;
use solver::formulation::modal::Modal;
use solver::response::backbone::Backbone;
use solver::response::branch::BranchPoint;
use solver::response::forced::SearchRange;
use solver::response::modes::Backbones;
use solver::response::orders::{Order, Orders};
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
    let units = UnitChoice::of_study(&header.study).to_string();
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
        units: (!units.is_empty()).then_some(units),
    }
}

/// The model of a run.
///
/// # Errors
/// If the store cannot be read or contradicts itself.
pub fn model(store: &Store) -> Result<Model, Error> {
    store.model()?.model().map_err(|error| Error::Other(format!("the stored model: {error}")))
}

/// An order of motions with its backbones.
struct Part<'o> {
    order: &'o Order,
    backbones: Backbones,
    /// Within which frequencies and amplitudes its branches are followed.
    reach: SearchRange,
}

impl<'o> Part<'o> {
    /// Of an order with its backbones; `first`: the part of the first order, if this is another one.
    fn new(order: &'o Order, backbones: Backbones, first: Option<&Self>, all: &[Amplitude]) -> Result<Self, Error> {
        let values = || all.iter().map(|amplitude| amplitude.value);
        let (primary, further) = (&backbones.list[0], &backbones.list[1..]);
        let settings = match first {
            Some(first) => order.between(first.order.number(), first.reach.frequency).settings,
            None => order.settings,
        };
        let reach = SearchRange::over(&settings, primary, further, largest(all))?.with_folds_of(values());
        // Periods double where the force resonates.
        Ok(Self { order, backbones, reach: reach.with_resonances(&order.model, &settings) })
    }

    /// Its number, if it is not the first one.
    fn number(&self) -> Option<usize> {
        (!self.order.is_first).then(|| self.order.number())
    }

    fn messages(&self) -> Vec<BackboneMessage> {
        self.backbones.list.iter().map(BackboneMessage::from).collect()
    }

    fn plan(&self) -> OrderPlan {
        let (order, left_out) = (self.order.number(), self.backbones.left_out.clone());
        OrderPlan { order, backbones: self.messages(), left_out, reach: self.reach }
    }
}

/// What a store already has of the sweep of a run; `None` as long as there is no backbone.
///
/// # Errors
/// If the store cannot be read or contradicts itself.
pub fn stored(store: &Store, model: &Model) -> Result<Option<Prepared>, Error> {
    let header = store.header()?;
    let orders = Orders::of(model, &header.settings);
    let Some(parts) = stored_parts(store, &orders, &header.amplitudes)? else { return Ok(None) };
    let (Some(backbone), Some(reach)) = (store.backbone()?, store.reach()?) else { return Ok(None) };
    let further = store.further_backbones()?;
    let left_out = store.modes_left_out()?.unwrap_or_default();
    let (orders, levels, added) = (store.orders()?, store.plans()?, store.added()?);
    let plan = Arc::new(SweepPlan { backbone, further, left_out, reach, orders, levels, added });
    let stored = Some(Stored { tasks: store.tasks()?, extents: store.extents()?, kept: store.kept()? });
    Ok(Some(Prepared { sweep: published(parts, &plan), beginning: Beginning { plan, stored } }))
}

/// The backbones of all orders; `None` as long as there is none.
fn stored_parts<'o>(store: &Store, orders: &'o Orders, all: &[Amplitude]) -> Result<Option<Vec<Part<'o>>>, Error> {
    let Some(primary) = store.backbone()? else { return Ok(None) };
    let mut first = vec![primary];
    first.extend(store.further_backbones()?);
    let further = store.orders()?;
    let mut parts: Vec<Part<'o>> = Vec::new();
    for order in orders.iter() {
        let lacking = || Error::Other(format!("motions of order {} have no stored backbone", order.number()));
        let plan = further.iter().find(|plan| !order.is_first && plan.order == order.number());
        let messages = if order.is_first { Some(&first) } else { plan.map(|plan| &plan.backbones) };
        let size = Size::of(&order.model);
        let list: Result<Vec<Backbone>, _> = messages.ok_or_else(lacking)?.iter().map(|b| b.backbone(&size)).collect();
        let list = list.map_err(|error| Error::Other(format!("a stored backbone: {error}")))?;
        if list.is_empty() {
            return Err(lacking());
        }
        let left_out = plan.map_or_else(Vec::new, |plan| plan.left_out.clone());
        parts.push(Part::new(order, Backbones { list, left_out }, parts.first(), all)?);
    }
    Ok(Some(parts))
}

fn published(parts: Vec<Part<'_>>, plan: &Arc<SweepPlan>) -> Arc<PublishedSweep> {
    let part = |part: Part<'_>| (part.number(), Modal::new(&part.order.model), part.backbones.list);
    Arc::new(PublishedSweep::new(parts.into_iter().map(part).collect(), plan.clone()))
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
) -> Result<Option<MorePlan>, Error> {
    let orders = Orders::of(model, settings);
    let Some(parts) = stored_parts(store, &orders, all)? else { return Ok(None) };
    let further = parts[1..].iter().map(Part::plan).collect();
    Ok(Some(MorePlan { reach: parts[0].reach, orders: further, levels: levels(&parts, all, first)? }))
}

/// Windows and tasks of the levels from `first` on.
///
/// # Errors
/// If one is of an order that is not looked for.
fn levels(parts: &[Part<'_>], all: &[Amplitude], first: usize) -> Result<Vec<LevelPlan>, Error> {
    let largest = largest(all);
    let mut plans = Vec::new();
    for (index, amplitude) in all.iter().enumerate().skip(first) {
        let part = parts.iter().find(|part| part.number() == amplitude.order());
        let foreign = || Error::Other(format!("level {} is of an order that is not looked for", amplitude.text));
        let Part { order, backbones, .. } = part.ok_or_else(foreign)?;
        let Order { model, settings, .. } = order;
        let batches = starts::batches(model, settings);
        let is_of_order = |other: &&Amplitude| other.order() == amplitude.order();
        let before = all[..index].iter().filter(is_of_order).count();
        let share = starts::share(batches, before, all.iter().filter(is_of_order).count());
        let (windows, mut tasks) = plan(backbones, amplitude.value, &settings.frequency, share);
        tasks.retain(|task| order.is_first || !matches!(task, Task::Main(_)));
        tasks.extend(starts::homotopies(model, share).flat_map(Task::from_starts));
        // Scouts bring nothing but folds.
        if amplitude.value == largest && most_folds(model, settings) > 0 {
            tasks.extend(scouts(batches).map(Task::Scout));
        }
        plans.push(LevelPlan { amplitude: amplitude.clone(), windows, tasks });
    }
    Ok(plans)
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
    let (all, orders) = (&header.amplitudes, Orders::of(model, &header.settings));
    let mut parts: Vec<Part<'_>> = Vec::new();
    for order in orders.iter() {
        let backbones = Backbones::reaching(&order.model, &order.settings, largest(all), &mut observer, stop);
        let backbones = backbones.map_err(|error| {
            without_backbone(&order.model, &order.settings).map_or_else(|| Error::from(error), Error::NoBackbone)
        })?;
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        parts.push(Part::new(order, backbones, parts.first(), all)?);
    }
    let mut messages = parts[0].messages().into_iter();
    let backbone = messages.next().expect("that of the primary mode is there");
    let plan = Arc::new(SweepPlan {
        backbone,
        further: messages.collect(),
        left_out: parts[0].backbones.left_out.clone(),
        reach: parts[0].reach,
        orders: parts[1..].iter().map(Part::plan).collect(),
        levels: levels(&parts, all, 0)?,
        added: Vec::new(),
    });
    Ok(Some(Prepared { sweep: published(parts, &plan), beginning: Beginning { plan, stored: None } }))
}
