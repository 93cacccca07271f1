//! The connections of a server: so many at once, and none that never asks.

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio::task::JoinSet;

/// Connections at once; more wait until one ends.
const MOST: usize = 256;

/// A connection on which no whole request has come for so long is closed.
const PATIENCE: Duration = Duration::from_secs(10);

/// Until connections are accepted again, where the system refuses (no file descriptors are left, say).
const PAUSE: Duration = Duration::from_secs(1);

/// Serves until it is dropped, and all connections with it.
pub async fn serve(listener: TcpListener, routes: Router) -> Infallible {
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(PATIENCE);
    let places = Arc::new(Semaphore::new(MOST));
    let mut connections = JoinSet::new();
    loop {
        let place = places.clone().acquire_owned().await.expect("nobody closes it");
        let stream = match listener.accept().await {
            Ok((stream, _)) => stream,
            Err(error) => {
                tracing::warn!(%error, "a connection over HTTP could not be accepted");
                tokio::time::sleep(PAUSE).await;
                continue;
            }
        };
        let service = TowerToHyperService::new(routes.clone());
        let connection = builder.serve_connection(TokioIo::new(stream), service);
        connections.spawn(async move {
            // How a connection ended is the business of who made it.
            let _ = connection.await;
            drop(place);
        });
        while connections.try_join_next().is_some() {}
    }
}
