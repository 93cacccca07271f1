//! What is told to every browser, from the first branch on, however late it comes.

use axum::response::sse::Event;
use futures_util::stream::{Stream, unfold};
use serde::Serialize;
use std::convert::Infallible;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};
use tokio::sync::watch;

/// A list of events that only grows, and the latest status.
#[derive(Debug)]
pub(super) struct Feed {
    /// Begins the numbers of events: another server on the same port has others.
    name: String,
    told: RwLock<Told>,
    changes: watch::Sender<()>,
}

#[derive(Debug, Default)]
struct Told {
    events: Vec<Event>,
    status: Option<Event>,
    statuses: usize,
}

/// How much a browser has had.
#[derive(Debug, Clone, Copy)]
struct Place {
    events: usize,
    statuses: usize,
}

impl Feed {
    /// Nothing has been told yet.
    pub fn new(name: String) -> Self {
        Self { name, told: RwLock::default(), changes: watch::Sender::new(()) }
    }

    /// Tells everyone, also those who come later.
    pub fn tell(&self, name: &str, content: &impl Serialize) {
        self.change(|told| {
            let number = format!("{}-{}", self.name, told.events.len());
            told.events.push(event(name, content).id(number));
        });
    }

    /// Tells everyone, until there is something newer.
    pub fn tell_status(&self, content: &impl Serialize) {
        self.change(|told| {
            told.status = Some(event("status", content));
            told.statuses += 1;
        });
    }

    fn change(&self, change: impl FnOnce(&mut Told)) {
        change(&mut self.told.write().unwrap_or_else(PoisonError::into_inner));
        self.changes.send_replace(());
    }

    fn told(&self) -> RwLockReadGuard<'_, Told> {
        self.told.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// What comes after `place`, if there is anything yet.
    fn next(&self, place: Place) -> Option<(Event, Place)> {
        let told = self.told();
        if let Some(event) = told.events.get(place.events) {
            return Some((event.clone(), Place { events: place.events + 1, ..place }));
        }
        let status = told.status.clone().filter(|_| told.statuses > place.statuses)?;
        Some((status, Place { statuses: told.statuses, ..place }))
    }

    /// All events after the one of this number, those to come as well.
    pub fn stream(self: Arc<Self>, last: Option<&str>) -> impl Stream<Item = Result<Event, Infallible>> + use<> {
        let number = last.and_then(|last| last.strip_prefix(&self.name)?.strip_prefix('-')?.parse::<usize>().ok());
        let place = Place { events: number.map_or(0, |number| number.saturating_add(1)), statuses: 0 };
        unfold((self, place), |(feed, place)| async move {
            let mut changes = feed.changes.subscribe();
            loop {
                changes.mark_unchanged();
                if let Some((event, place)) = feed.next(place) {
                    return Some((Ok(event), (feed, place)));
                }
                // The sender lives as long as the feed does.
                let _ = changes.changed().await;
            }
        })
    }
}

fn event(name: &str, content: &impl Serialize) -> Event {
    let json = serde_json::to_string(content).expect("numbers and texts have JSON forms");
    Event::default().event(name).data(json)
}
