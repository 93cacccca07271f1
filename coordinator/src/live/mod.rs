//! The response of a run, live in a browser: results are taken from the bus as they come and handed on.

mod feed;
mod follow;

use crate::error::Error;
use crate::page;
use crate::report::{BackboneCurve, Curve, Level, Monitor};
use crate::target::Live;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::sse::{KeepAlive, Sse};
use axum::response::{Html, IntoResponse};
use axum::routing::get;
use axum::{Json, Router};
use feed::Feed;
use follow::Follower;
use protocol::to_everyone::Stage;
use serde::Serialize;
use std::io;
use std::sync::Arc;
use tokio::net::TcpListener;

/// What the page asks for first. The branches come as events.
#[derive(Debug, Serialize)]
struct Start {
    run: Run,
    monitors: Vec<Monitor>,
    levels: Vec<Level>,
    branches: [Curve; 0],
    backbone: Option<BackboneCurve>,
}

#[derive(Debug, Serialize)]
struct Run {
    id: String,
    name: String,
    model: String,
    stage: Stage,
}

/// Serves the page of a run at `address` until the process is ended.
///
/// # Errors
/// If nothing can be served there, or the run cannot be followed.
pub async fn serve(live: &Live, address: &str) -> Result<(), Error> {
    let refused = |source: io::Error| {
        Error::Other(format!("--page {address}: {source}; give HOST:PORT of this machine, as in 127.0.0.1:8080"))
    };
    let listener = TcpListener::bind(address).await.map_err(refused)?;
    let place = listener.local_addr().map_err(refused)?;
    let feed = Arc::new(Feed::new(uuid::Uuid::new_v4().simple().to_string()));
    let (follower, start) = Follower::start(live, feed.clone()).await?;
    println!("http://{place} shows the run as it goes on; Ctrl-C ends this");
    let pages = routes(Arc::new(start), feed);
    let served = async { axum::serve(listener, pages).await.map_err(refused) };
    tokio::try_join!(served, follower.follow()).map(|_| ())
}

fn routes(start: Arc<Start>, feed: Arc<Feed>) -> Router {
    let title = start.run.name.clone();
    let events = |State(feed): State<Arc<Feed>>, headers: HeaderMap| async move {
        // A browser that connects again tells what it has had.
        let last = headers.get("last-event-id").and_then(|value| value.to_str().ok());
        Sse::new(feed.stream(last)).keep_alive(KeepAlive::default())
    };
    Router::new()
        .route("/", get(|| async move { Html(page::live(&title)) }))
        .route("/data", get(|| async move { Json(&*start).into_response() }))
        .route("/events", get(events))
        .with_state(feed)
}
