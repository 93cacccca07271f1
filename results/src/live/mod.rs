//! The live page of a run, for an HTTP server and whoever has a browser. What is shown comes from whoever fills the [`Feed`].

mod feed;
mod sketch;

pub use feed::Feed;

use crate::curves::{BackboneCurve, Monitor};
use crate::page;
use crate::summary_table::UnitChoice;
use axum::Router;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, StatusCode};
use axum::response::sse::{KeepAlive, Sse};
use axum::response::{Html, IntoResponse};
use axum::routing::get;
use protocol::to_everyone::Stage;
use serde::Serialize;
use std::sync::Arc;

/// What the page begins with. The branches come as events.
#[derive(Debug)]
pub struct Start {
    run: Run,
    monitors: Vec<Monitor>,
    levels: Vec<(String, f64)>,
    harmonic: usize,
    backbone: Option<BackboneCurve>,
    units: UnitChoice,
}

/// Which run.
#[derive(Debug, Serialize)]
pub struct Run {
    /// Run.
    pub id: String,
    /// Name of the study.
    pub name: String,
    /// Name of the model.
    pub model: String,
    /// Where it is.
    pub stage: Stage,
}

impl Start {
    /// Of a run with forcing levels (as typed, and their values) in ascending order, shown in m and rad/s; `harmonic` of the response is
    /// forced.
    pub fn new(
        run: Run,
        monitors: Vec<Monitor>,
        levels: Vec<(String, f64)>,
        harmonic: usize,
        backbone: Option<BackboneCurve>,
    ) -> Self {
        Self { run, monitors, levels, harmonic, backbone, units: UnitChoice::default() }
    }

    /// Shown in these units.
    pub fn with_units(self, units: UnitChoice) -> Self {
        Self { units, ..self }
    }
}

/// The page and what it asks for. Whoever serves it says who may read it.
pub fn routes(start: Start, feed: Arc<Feed>) -> Router {
    let title = start.run.name.clone();
    let opening = feed.begin(start);
    let events = |State(feed): State<Arc<Feed>>, headers: HeaderMap| async move {
        // A browser that connects again tells what it has had.
        let last = headers.get("last-event-id").and_then(|value| value.to_str().ok());
        match feed.stream(last) {
            Some(events) => Sse::new(events).keep_alive(KeepAlive::default()).into_response(),
            None => {
                (StatusCode::SERVICE_UNAVAILABLE, "as many browsers as can be told follow this run\n").into_response()
            }
        }
    };
    Router::new()
        .route("/", get(|| async move { Html(page::live(&title)) }))
        .route("/data", get(|| async move { ([(CONTENT_TYPE, "application/json")], opening) }))
        .route("/events", get(events))
        .with_state(feed)
}
