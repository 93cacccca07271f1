//! What is told to every browser, from the first branch on, however late it comes.

use super::Start;
use super::sketch::Sketch;
use crate::curves::{BackboneCurve, Curve};
use axum::response::sse::Event;
use futures_util::stream::{Stream, unfold};
use protocol::to_everyone::Stage;
use serde::Serialize;
use std::convert::Infallible;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard};
use std::time::{Duration, Instant};
use tokio::sync::{Semaphore, watch};

/// Labels and axes are made anew at most once in so long.
const PAUSE: Duration = Duration::from_millis(500);

/// Most browsers that are told at once: a server has connections for other things as well.
const BROWSERS: usize = 128;

/// A list of events that only grows, and the latest status and axes.
#[derive(Debug)]
pub struct Feed {
    /// Begins the numbers of events: another server on the same port has others.
    name: String,
    told: RwLock<Told>,
    drawing: Mutex<Drawing>,
    changes: watch::Sender<()>,
    places: Arc<Semaphore>,
}

#[derive(Debug, Default)]
struct Told {
    events: Vec<Event>,
    figure: Latest,
    status: Latest,
}

/// An event of which only the newest counts.
#[derive(Debug, Default)]
struct Latest {
    event: Option<Event>,
    count: usize,
}

/// The figure of the forced response as far as it is told.
#[derive(Debug, Default)]
struct Drawing {
    sketch: Option<Sketch>,
    /// Branches that came before the beginning.
    early: Vec<Curve>,
    /// When axes and labels were made, unless a branch came since.
    drawn: Option<Instant>,
    is_behind: bool,
}

/// How the run is doing, as the page shows it.
#[derive(Serialize)]
struct StatusLine<'t> {
    stage: Stage,
    text: &'t str,
}

/// How much a browser has had.
#[derive(Debug, Clone, Copy)]
struct Position {
    events: usize,
    figures: usize,
    statuses: usize,
}

impl Feed {
    /// Nothing has been told yet.
    pub fn new() -> Self {
        let name = uuid::Uuid::new_v4().simple().to_string();
        let (changes, places) = (watch::Sender::new(()), Arc::new(Semaphore::new(BROWSERS)));
        Self { name, told: RwLock::default(), drawing: Mutex::default(), changes, places }
    }

    /// What the page is given at first, JSON.
    pub(super) fn begin(&self, start: Start) -> String {
        let (sketch, opening) = Sketch::new(start);
        let early = {
            let mut drawing = self.drawing();
            drawing.sketch = Some(sketch);
            std::mem::take(&mut drawing.early)
        };
        for curve in &early {
            self.branch(curve);
        }
        opening
    }

    /// Tells of a branch of a level, or of what is known of its stability since.
    pub fn branch(&self, curve: &Curve) {
        let mut drawing = self.drawing();
        let Some(sketch) = &mut drawing.sketch else {
            drawing.early.push(curve.clone());
            return;
        };
        let event = sketch.branch(curve);
        drawing.is_behind = true;
        self.tell("branch", &event);
        if drawing.drawn.is_none_or(|drawn| drawn.elapsed() > PAUSE) {
            self.draw(&mut drawing);
        }
    }

    /// Tells of the backbone.
    pub fn backbone(&self, curve: &BackboneCurve) {
        let mut drawing = self.drawing();
        let Some(sketch) = &mut drawing.sketch else { return };
        let event = sketch.backbone(curve);
        self.tell("backbone", &event);
        self.draw(&mut drawing);
    }

    /// Tells how the run is doing, until there is something newer.
    pub fn status(&self, stage: Stage, text: &str) {
        self.catch_up();
        self.tell_latest("status", &StatusLine { stage, text }, |told| &mut told.status);
    }

    /// Tells why nothing more will come.
    pub fn end(&self, why: &str) {
        self.catch_up();
        self.tell("end", &why);
    }

    /// Tells of axes and labels, if branches have come since.
    fn catch_up(&self) {
        let mut drawing = self.drawing();
        if drawing.is_behind {
            self.draw(&mut drawing);
        }
    }

    fn draw(&self, drawing: &mut Drawing) {
        let Some(sketch) = &drawing.sketch else { return };
        self.tell_latest("figure", &sketch.figure(), |told| &mut told.figure);
        (drawing.drawn, drawing.is_behind) = (Some(Instant::now()), false);
    }

    fn drawing(&self) -> MutexGuard<'_, Drawing> {
        self.drawing.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells everyone, also those who come later.
    fn tell(&self, name: &str, content: &impl Serialize) {
        self.change(|told| {
            let number = format!("{}-{}", self.name, told.events.len());
            told.events.push(event(name, content).id(number));
        });
    }

    /// Tells everyone, until there is something newer.
    fn tell_latest(&self, name: &str, content: &impl Serialize, which: impl Fn(&mut Told) -> &mut Latest) {
        self.change(|told| {
            let latest = which(told);
            latest.event = Some(event(name, content));
            latest.count += 1;
        });
    }

    fn change(&self, change: impl FnOnce(&mut Told)) {
        change(&mut self.told.write().unwrap_or_else(PoisonError::into_inner));
        self.changes.send_replace(());
    }

    fn told(&self) -> RwLockReadGuard<'_, Told> {
        self.told.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// What comes after `position`, if there is anything yet. Axes and labels come after the branches that they are of, and
    /// before the end.
    fn next(&self, position: Position) -> Option<(Event, Position)> {
        let told = self.told();
        let next = told.events.get(position.events).cloned();
        let is_last = position.events + 1 == told.events.len();
        let figure = told.figure.after(position.figures).filter(|_| next.is_none() || is_last);
        if let Some(event) = figure {
            return Some((event, Position { figures: told.figure.count, ..position }));
        }
        if let Some(event) = next {
            return Some((event, Position { events: position.events + 1, ..position }));
        }
        let status = told.status.after(position.statuses)?;
        Some((status, Position { statuses: told.status.count, ..position }))
    }

    /// All events after the one of this number, those to come as well; nothing if so many are told already.
    pub fn stream(
        self: Arc<Self>,
        last: Option<&str>,
    ) -> Option<impl Stream<Item = Result<Event, Infallible>> + use<>> {
        let place = self.places.clone().try_acquire_owned().ok()?;
        let number = last.and_then(|last| last.strip_prefix(&self.name)?.strip_prefix('-')?.parse::<usize>().ok());
        let events = number.map_or(0, |number| number.saturating_add(1));
        let position = Position { events, figures: 0, statuses: 0 };
        Some(unfold((self, position, place), |(feed, position, place)| async move {
            let mut changes = feed.changes.subscribe();
            loop {
                changes.mark_unchanged();
                if let Some((event, position)) = feed.next(position) {
                    return Some((Ok(event), (feed, position, place)));
                }
                // The sender lives as long as the feed does.
                let _ = changes.changed().await;
            }
        }))
    }
}

impl Latest {
    /// The event, if it is newer.
    fn after(&self, count: usize) -> Option<Event> {
        self.event.clone().filter(|_| self.count > count)
    }
}

impl Default for Feed {
    fn default() -> Self {
        Self::new()
    }
}

fn event(name: &str, content: &impl Serialize) -> Event {
    let json = serde_json::to_string(content).expect("numbers and texts have JSON forms");
    Event::default().event(name).data(json)
}
