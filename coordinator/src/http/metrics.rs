//! Figures of a run in the text format of Prometheus.

use crate::bus::RunState;
use crate::engine::Meters;
use crate::ledger::{Load, STATES};
use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, EncodeMetric, text};
use prometheus_client::metrics::MetricType;
use prometheus_client::metrics::counter::ConstCounter;
use prometheus_client::metrics::gauge::ConstGauge;
use prometheus_client::registry::{Registry, Unit};
use protocol::to_everyone::{Manifest, Stage, Status};
use results::journal::KINDS;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;

/// What the text is.
pub const FORMAT: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// Everything that there is of a run.
pub fn registry(meters: Meters, state: watch::Receiver<RunState>) -> Arc<Registry> {
    let mut registry = Registry::with_prefix("isola");
    let counters = [
        ("leases_granted", "Tasks handed out", meters.granted),
        ("leases_expired", "Attempts that ended without a sign of life in time", meters.expired),
        ("leases_released", "Attempts that were given back", meters.released),
        ("attempts_failed", "Attempts that failed", meters.failed),
        ("results_refused", "Results that cannot be true", meters.refused),
        ("results_stored", "Results stored", meters.stored),
    ];
    for (name, help, counter) in counters {
        registry.register(name, help, counter);
    }
    registry.register_with_unit("received", "Bytes of results that have come", Unit::Bytes, meters.received);
    registry.register_with_unit("commit", "Time that transactions take", Unit::Seconds, meters.commits);
    registry.register_collector(Box::new(Moment(state)));
    Arc::new(registry)
}

/// The text.
pub fn text(registry: &Registry) -> String {
    let mut written = String::new();
    text::encode(&mut written, registry).expect("texts can be written to");
    written
}

/// The run as it is when somebody asks.
struct Moment(watch::Receiver<RunState>);

impl fmt::Debug for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Moment")
    }
}

impl Collector for Moment {
    fn encode(&self, encoder: DescriptorEncoder) -> fmt::Result {
        let state = self.0.borrow();
        let mut figures = Figures(encoder);
        figures.of_run(&state.manifest)?;
        if let Some(status) = &state.status {
            figures.of_status(status)?;
        }
        state.load.as_ref().map_or(Ok(()), |load| figures.of_load(load))
    }
}

/// A label and its value.
type Label<'l> = (&'static str, &'l str);

struct Figures<'e>(DescriptorEncoder<'e>);

impl Figures<'_> {
    fn gauge(&mut self, name: &str, help: &str, value: f64) -> fmt::Result {
        ConstGauge::new(value).encode(self.0.encode_descriptor(name, help, None, MetricType::Gauge)?)
    }

    fn seconds(&mut self, name: &str, help: &str, value: Option<f64>) -> fmt::Result {
        let Some(value) = value else { return Ok(()) };
        let encoder = self.0.encode_descriptor(name, help, Some(&Unit::Seconds), MetricType::Gauge)?;
        ConstGauge::new(value).encode(encoder)
    }

    fn gauges<'l>(
        &mut self,
        name: &str,
        help: &str,
        values: impl Iterator<Item = (Vec<Label<'l>>, f64)>,
    ) -> fmt::Result {
        let mut family = self.0.encode_descriptor(name, help, None, MetricType::Gauge)?;
        for (labels, value) in values {
            ConstGauge::new(value).encode(family.encode_family(&labels)?)?;
        }
        Ok(())
    }

    /// Seconds that add up, by worker.
    fn worker_seconds<'l>(
        &mut self,
        name: &str,
        help: &str,
        values: impl Iterator<Item = (Label<'l>, Duration)>,
    ) -> fmt::Result {
        let mut family = self.0.encode_descriptor(name, help, Some(&Unit::Seconds), MetricType::Counter)?;
        for (label, value) in values {
            ConstCounter::new(value.as_secs_f64()).encode(family.encode_family(&[label])?)?;
        }
        Ok(())
    }

    fn of_run(&mut self, manifest: &Manifest) -> fmt::Result {
        // The encoder writes values as they are.
        let name = manifest.name.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
        let labels = [("run", manifest.run.as_str()), ("name", &name), ("version", &manifest.program)];
        let family = self.0.encode_descriptor("run_info", "Which run", None, MetricType::Gauge);
        ConstGauge::new(1.0).encode(family?.encode_family(&labels)?)?;
        let stages = [
            (Stage::Backbone, "backbone"),
            (Stage::Sweep, "sweep"),
            (Stage::Finished, "finished"),
            (Stage::Cancelled, "cancelled"),
        ];
        let stages = stages.map(|(stage, name)| (vec![("stage", name)], f64::from(u8::from(stage == manifest.stage))));
        self.gauges("stage", "1 where the run is", stages.into_iter())
    }

    fn of_status(&mut self, status: &Status) -> fmt::Result {
        self.gauge("levels", "Forcing levels", status.levels as f64)?;
        self.gauge("levels_done", "Forcing levels whose tasks are all done", status.levels_done as f64)?;
        self.gauge("branches", "Branches found", status.tasks.branches as f64)?;
        self.gauge("workers", "Workers present", status.workers.len() as f64)?;
        self.gauge(
            "stalled_tasks",
            "Tasks that do not get on, though there are signs of life",
            status.stalled.len() as f64,
        )?;
        self.seconds("eta", "Time to the end, without tasks that will turn out not to be needed", status.eta)
    }

    fn of_load(&mut self, load: &Load) -> fmt::Result {
        let counts = std::iter::zip(KINDS, &load.tasks).flat_map(|(kind, counts)| {
            std::iter::zip(STATES, counts)
                .map(move |(state, count)| (vec![("kind", kind), ("state", state)], *count as f64))
        });
        self.gauges("tasks", "Tasks; waiting ones may turn out not to be needed", counts)?;
        self.gauge("queue_length", "Tasks that can be handed out now", load.queue as f64)?;
        let leases = [("alive", load.leases), ("silent", load.silent_leases)];
        let leases = leases.map(|(state, count)| (vec![("state", state)], count as f64));
        self.gauges("leases", "Tasks under way; silent: their worker is not heard of", leases.into_iter())?;
        let seconds = |age: Option<Duration>| age.map(|age| age.as_secs_f64());
        let waiting = seconds(load.oldest_waiting);
        self.seconds("oldest_waiting_task", "How long the oldest task that can be handed out has waited", waiting)?;
        let under_way = seconds(load.oldest_lease);
        self.seconds("oldest_lease", "How long the oldest task under way has been so", under_way)?;
        let workers = || load.workers.iter().map(|worker| (("worker", worker.worker.as_str()), worker));
        let busy = workers().map(|(label, worker)| (label, worker.busy));
        self.worker_seconds("worker_busy", "Time that threads of a worker had tasks, added up", busy)?;
        let present = workers().map(|(label, worker)| (label, worker.present));
        self.worker_seconds("worker_present", "Time that threads of a worker were there, added up", present)?;
        let share = |busy: Duration, present: Duration| busy.as_secs_f64() / present.as_secs_f64();
        let shares = workers().filter(|(_, worker)| !worker.present.is_zero());
        let shares = shares.map(|(label, worker)| (vec![label], share(worker.busy, worker.present).min(1.0)));
        self.gauges("worker_busy_ratio", "Share of its time that a worker had tasks, since it came", shares)?;
        let threads = workers().map(|(label, worker)| (vec![label], worker.threads as f64));
        self.gauges("worker_threads", "Computing threads of a worker", threads)?;
        let done = workers().map(|(label, worker)| (vec![label], worker.done as f64));
        self.gauges("worker_tasks_done", "Tasks that a worker has done", done)
    }
}
