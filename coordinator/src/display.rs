//! Progress for people: bars on a terminal, a line now and then otherwise.

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use protocol::from_worker::Progress;
use protocol::ids::{TaskId, WorkerId};
use protocol::level;
use protocol::to_everyone::{Stage, StalledTask, Status};
use results::journal::{LevelPlan, SweepPlan};
use results::store::Reader;
use results::summary_table::{Layout, UnitChoice};
use results::words::{count, duration, fixed_digits, length};
use solver::response::seeds::LandingMethod;
use solver::response::starts::{BATCH, StartWay};
use solver::response::task::Task;
use solver::settings::VerifyEffort;
use std::io::IsTerminal;
use std::path::Path;
use std::time::{Duration, Instant};
use worker::terminal;

/// Bars of levels and workers shown at most, each.
const ROWS: usize = 12;
/// Time between two lines where there is no terminal.
const LINE_PERIOD: Duration = Duration::from_secs(5);

/// Shows the status of a run as it changes.
pub struct Display {
    bars: Option<Bars>,
    last_line: Option<(Instant, Stage, usize)>,
    is_seen: bool,
    /// Tasks of which it was said that they do not get on, with who has them.
    stalled: Vec<(TaskId, WorkerId)>,
}

struct Bars {
    multi: MultiProgress,
    total: ProgressBar,
    levels: Vec<ProgressBar>,
    workers: Vec<ProgressBar>,
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("templates are fixed").progress_chars("━╸ ")
}

impl Display {
    /// On standard error.
    pub fn new() -> Self {
        let has_bars = std::io::stderr().is_terminal() && !terminal::is_json();
        let bars = has_bars.then(|| {
            let multi = MultiProgress::with_draw_target(ProgressDrawTarget::stderr());
            let total =
                multi.add(ProgressBar::new(0).with_style(style("{wide_bar:.cyan} {pos}/{len} tasks so far  {msg}")));
            Bars { multi, total, levels: Vec::new(), workers: Vec::new() }
        });
        Self { bars, last_line: None, is_seen: true, stalled: Vec::new() }
    }

    /// Shows a status.
    pub fn update(&mut self, status: &Status) {
        match &mut self.bars {
            Some(bars) => bars.update(status),
            None => self.line(status),
        }
        self.tell_stalls(status);
    }

    /// Says once of a task that it does not get on.
    fn tell_stalls(&mut self, status: &Status) {
        for stalled in &status.stalled {
            let named = (stalled.task.clone(), stalled.worker.clone());
            if self.stalled.contains(&named) {
                continue;
            }
            self.stalled.push(named);
            match &self.bars {
                // A terminal that is gone need not be told.
                Some(bars) => drop(bars.multi.println(stall(stalled))),
                None => self.is_seen = terminal::note(stall(stalled)),
            }
        }
    }

    fn line(&mut self, status: &Status) {
        let levels_done = status.levels_done;
        let due = self.last_line.is_none_or(|(time, stage, levels)| {
            time.elapsed() >= LINE_PERIOD || stage != status.stage || levels != levels_done
        });
        if due {
            self.last_line = Some((Instant::now(), status.stage, levels_done));
            self.is_seen = terminal::note(summary(status));
        }
    }

    /// Whether somebody may see it.
    pub fn is_seen(&self) -> bool {
        self.is_seen
    }

    /// Takes bars off the terminal.
    pub fn clear(&mut self) {
        if let Some(bars) = self.bars.take() {
            // A terminal that is gone needs no clearing.
            let _ = bars.multi.clear();
        }
    }
}

impl Default for Display {
    fn default() -> Self {
        Self::new()
    }
}

impl Bars {
    fn update(&mut self, status: &Status) {
        let tasks = status.tasks;
        // What is found asks for more: the length is that of now.
        self.total.set_length((tasks.done + tasks.skipped + tasks.running + tasks.waiting + tasks.dead) as u64);
        self.total.set_position((tasks.done + tasks.skipped + tasks.dead) as u64);
        self.total.set_message(match (status.stage, &status.backbone) {
            (Stage::Backbone, Some(backbone)) => format!("backbone: {}", progress(backbone)),
            (Stage::Sweep, _) => format!("{}{}", count(tasks.branches, "branch"), eta(status)),
            (stage, _) => stage.name().to_string(),
        });
        rows(&self.multi, &mut self.levels, status.active.len(), "  {prefix:>12} {bar:20.green} {pos}/{len}  {msg}");
        for (bar, active) in self.levels.iter().zip(&status.active) {
            let order = level::order(&active.amplitude).map_or_else(String::new, |order| format!(", order {order}"));
            bar.set_prefix(format!("A = {}{order}", level::typed(&active.amplitude)));
            bar.set_length(active.total as u64);
            bar.set_position(active.done as u64);
            let place = active.progress.as_ref().map_or(String::new(), |p| format!(", {}", progress(p)));
            bar.set_message(format!("{} branches{place}", active.branches));
        }
        rows(&self.multi, &mut self.workers, status.workers.len(), "  {prefix:.dim} {msg}");
        for (bar, worker) in self.workers.iter().zip(&status.workers) {
            bar.set_prefix(worker.worker.to_string());
            let task = worker.tasks.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
            let place = worker.progress.as_ref().map_or(String::new(), |p| format!(", {}", progress(p)));
            let doing = if task.is_empty() { "waiting".to_string() } else { format!("task {task}{place}") };
            bar.set_message(format!("{} done, {doing}", worker.done));
        }
    }
}

/// As many bars as there is something to show.
fn rows(multi: &MultiProgress, bars: &mut Vec<ProgressBar>, count: usize, template: &str) {
    let count = count.min(ROWS);
    while bars.len() > count {
        if let Some(bar) = bars.pop() {
            multi.remove(&bar);
        }
    }
    while bars.len() < count {
        let bar = ProgressBar::new(1).with_style(style(template));
        let bar = match bars.last() {
            Some(last) => multi.insert_after(last, bar),
            None => multi.add(bar),
        };
        bars.push(bar);
    }
}

fn progress(progress: &Progress) -> String {
    format!("{} points, {} rad/s, {}", progress.points, fixed_digits(progress.omega, 6), length(progress.amplitude))
}

/// That a task does not get on, and what to do about it.
pub fn stall(StalledTask { task, worker, seconds }: &StalledTask) -> String {
    format!(
        "task {task} has not got on for {}: if that lasts, end worker {worker}; the task is then handed out again",
        duration(*seconds)
    )
}

/// How long it will take: what is found may ask for more.
fn eta(status: &Status) -> String {
    status.eta.map_or(String::new(), |eta| format!(", about {} to go as far as is known", duration(eta)))
}

/// Width of lines for whoever reads standard output.
pub fn width() -> u16 {
    let size = console::Term::stdout().size_checked();
    size.map_or(Layout::default().width, |(_, columns)| columns)
}

/// The closing table of the run in a folder for whoever reads standard output, in these units or else those of the run.
pub fn closing_table(reader: &Reader, directory: &Path, units: Option<UnitChoice>) -> results::store::Result<String> {
    let run = directory.display().to_string();
    let own = UnitChoice::of_study(&reader.header()?.study);
    let layout = Layout { width: width(), units: units.unwrap_or_default().or(own).of_table(), run: &run };
    results::summary_table::table(reader, layout)
}

/// Where what the table leaves out is told.
pub fn all_of_it(directory: &Path) -> String {
    let directory = directory.display();
    format!("more (stability of every branch, what was looked for, figures): isola report {directory}")
}

/// What a sweep is going to cost, in one line: known when the backbones are.
pub fn plan(plan: &SweepPlan, most_folds: usize, verify: VerifyEffort) -> String {
    let total = |of: fn(&LevelPlan) -> usize| plan.levels.iter().map(of).sum::<usize>();
    let seeds = |level: &LevelPlan| level.tasks.iter().filter(|task| is_seed(task)).count();
    let scouts = plan.levels.iter().flat_map(|level| &level.tasks).filter_map(|task| match task {
        Task::Scout(scout) => Some(scout.batches),
        _ => None,
    });
    let beyond = match (scouts.clone().count(), scouts.sum::<usize>()) {
        (0, _) => String::new(),
        (scouts, batches) => {
            format!(" and {} at {}", BATCH * batches, count(scouts, "larger forcing amplitude"))
        }
    };
    let starts = match BATCH * total(|level| batches(level, StartWay::Direct)) {
        0 => String::new(),
        number => format!(", {}{beyond}", count(number, "random start")),
    };
    let homotopies = match BATCH * total(|level| batches(level, StartWay::Homotopy)) {
        0 => String::new(),
        number => format!(", {number} homotopies where these find nothing"),
    };
    let backbones = 1 + plan.further.len() + plan.orders.iter().map(|order| order.backbones.len()).sum::<usize>();
    let search = match most_folds {
        0 => "no folds are followed over the forcing".into(),
        most => format!("then at most {most} folds are followed over the forcing (search.effort)"),
    };
    let verified = match verify {
        VerifyEffort::None => "nothing is verified",
        VerifyEffort::Standard => "isolas and peaks are verified by time marching (verify.effort)",
        VerifyEffort::All => "every branch is verified by time marching (verify.effort)",
    };
    format!(
        "{}, {}, {} with {}{starts}{homotopies}; {search}; {verified}",
        count(plan.levels.len(), "level"),
        count(backbones, "backbone"),
        count(total(|level| level.windows.len()), "window"),
        count(total(seeds), "seed"),
    )
}

/// Batches of starts of a level that go this way.
fn batches(level: &LevelPlan, way: StartWay) -> usize {
    level.tasks.iter().filter(|task| matches!(task, Task::Start(place) if place.way == way)).count()
}

/// Whether a task is for a seed that is tried in any case.
fn is_seed(task: &Task) -> bool {
    matches!(task, Task::Land(place) if place.method == LandingMethod::FullForcing)
}

/// How many tasks are still to be handed out: while a sweep goes on no total, for what is found asks for more.
fn waiting(stage: Stage, tasks: usize) -> String {
    format!("{tasks} waiting{}", if stage == Stage::Sweep { " (more may follow)" } else { "" })
}

/// Where the levels are: while a sweep goes on how many have tasks at this moment, for what fold curves lead to, and verifications, bring
/// more to those that had none; afterwards how many are done.
fn levels(stage: Stage, all: usize, done: usize) -> String {
    match (stage, all.saturating_sub(done)) {
        (Stage::Sweep, 0) => "no level has tasks right now".into(),
        (Stage::Sweep, busy) => format!("{busy} of {all} levels have tasks right now"),
        _ => format!("{done} of {all} levels done"),
    }
}

/// A status in one line.
pub fn summary(status: &Status) -> String {
    let tasks = status.tasks;
    if let (Stage::Backbone, place) = (status.stage, &status.backbone) {
        let place = place.as_ref().map_or(String::new(), |p| format!(": {}", progress(p)));
        return format!("{}{place}", status.stage.name());
    }
    let dead = if tasks.dead > 0 { format!(", {} given up", tasks.dead) } else { String::new() };
    format!(
        "{}: {}, {} done, {} handed out, {}{dead}, {}, {}{}",
        status.stage.name(),
        levels(status.stage, status.levels, status.levels_done),
        count(tasks.done + tasks.skipped, "task"),
        tasks.running,
        waiting(status.stage, tasks.waiting),
        count(tasks.branches, "branch"),
        count(status.workers.len(), "worker"),
        if status.stage == Stage::Sweep { eta(status) } else { String::new() }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_waits_is_no_total() {
        assert_eq!(waiting(Stage::Sweep, 12), "12 waiting (more may follow)");
        assert_eq!(waiting(Stage::Finished, 0), "0 waiting");
    }

    #[test]
    fn levels_without_tasks_are_not_called_done_while_more_may_come() {
        assert_eq!(levels(Stage::Sweep, 8, 8), "no level has tasks right now");
        assert_eq!(levels(Stage::Sweep, 8, 4), "4 of 8 levels have tasks right now");
        assert_eq!(levels(Stage::Finished, 8, 8), "8 of 8 levels done");
        assert_eq!(levels(Stage::Cancelled, 8, 5), "5 of 8 levels done");
    }
}
