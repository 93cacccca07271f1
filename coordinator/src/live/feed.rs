//! What is told to every browser, from the first event on, however late it comes.

use axum::response::sse::Event;
use futures_util::stream::{Stream, unfold};
use serde::Serialize;
use std::convert::Infallible;
use std::sync::{Arc, PoisonError, RwLock};
use tokio::sync::watch;

/// A list of events that only grows.
#[derive(Debug, Default)]
pub(super) struct Feed {
    events: RwLock<Vec<Event>>,
    count: watch::Sender<usize>,
}

impl Feed {
    /// Tells everyone.
    pub fn tell(&self, name: &str, content: &impl Serialize) {
        let json = serde_json::to_string(content).expect("numbers and texts have JSON forms");
        let mut events = self.events.write().unwrap_or_else(PoisonError::into_inner);
        let number = events.len().to_string();
        events.push(Event::default().id(number).event(name).data(json));
        self.count.send_replace(events.len());
    }

    /// The event of this number, once there is one.
    async fn event(&self, number: usize) -> Event {
        // The sender lives as long as the feed does.
        let _ = self.count.subscribe().wait_for(|count| *count > number).await;
        self.events.read().unwrap_or_else(PoisonError::into_inner)[number].clone()
    }

    /// All events from number `first` on, those to come as well.
    pub fn stream(self: Arc<Self>, first: usize) -> impl Stream<Item = Result<Event, Infallible>> {
        unfold((self, first), |(feed, number)| async move {
            let event = feed.event(number).await;
            Some((Ok(event), (feed, number + 1)))
        })
    }
}
