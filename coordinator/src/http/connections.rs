//! The connections of a server: so many at once, and none that never asks.

use super::encryption::{Encryption, Spoken, refusal};
use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio::task::JoinSet;

/// Connections at once; more wait until one ends.
const MOST: usize = 256;

/// A connection on which no whole request has come for so long is closed.
const PATIENCE: Duration = Duration::from_secs(10);

/// Until connections are accepted again, where the system refuses (no file descriptors are left, say).
const PAUSE: Duration = Duration::from_secs(1);

/// Serves until it is dropped, and all connections with it; encrypted, if there is something to do so.
pub async fn serve(listener: TcpListener, routes: Router, encryption: Option<Encryption>) -> Infallible {
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
        let (builder, routes, encryption) = (builder.clone(), routes.clone(), encryption.clone());
        connections.spawn(async move {
            match encryption {
                None => answer(&builder, stream, routes).await,
                Some(encryption) => match encryption.begin(stream, PATIENCE).await {
                    Ok(Spoken::Encrypted(stream)) => answer(&builder, stream, routes).await,
                    Ok(Spoken::Clear(stream)) => answer(&builder, stream, refusal()).await,
                    Err(error) => tracing::debug!(%error, "an encrypted connection has not begun"),
                },
            }
            drop(place);
        });
        while connections.try_join_next().is_some() {}
    }
}

/// Answers what is asked on a connection.
async fn answer(
    builder: &http1::Builder,
    stream: impl AsyncRead + AsyncWrite + Unpin + Send + 'static,
    routes: Router,
) {
    // How a connection ended is the business of who made it.
    let _ = builder.serve_connection(TokioIo::new(stream), TowerToHyperService::new(routes)).await;
}
