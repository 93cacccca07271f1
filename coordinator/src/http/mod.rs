//! The run over HTTP, or HTTPS where it has certificates, for browsers, orchestrators and Prometheus.
//!
//! | path | what | who |
//! |---|---|---|
//! | `/healthz` | whether this process carries its run on | anybody |
//! | `/metrics` | figures for Prometheus (`metrics.rs`) | who has the token (`guard.rs`) |
//! | `/` | the live page | who has the token |

mod connections;
mod encryption;
mod guard;
mod health;
mod host;
mod metrics;

pub use connections::serve;
pub use encryption::Encryption;
pub use guard::token;
pub use host::own_names_only;

use crate::bus::RunState;
use crate::engine::Meters;
use crate::error::Error;
use axum::Router;
use axum::http::header::CONTENT_TYPE;
use axum::middleware::from_fn_with_state;
use axum::routing::get;
use guard::Guard;
use protocol::ids::RunId;
use protocol::secret::Secret;
use std::convert::Infallible;
use std::io;
use std::sync::Arc;
use tokio::net::TcpListener;
use tokio::sync::watch;
use tokio::task::JoinHandle;

/// What is shown.
pub struct Shown {
    /// Which run.
    pub run: RunId,
    /// The run as it is.
    pub state: watch::Receiver<RunState>,
    /// What is counted.
    pub meters: Meters,
    /// The live page; nothing if there is none.
    pub page: Router,
}

/// A server; it ends when dropped.
pub struct Server {
    serving: JoinHandle<Infallible>,
}

/// Takes an address, as HOST:PORT.
///
/// # Errors
/// If it is in use, or not one of this machine.
pub async fn bind(address: &str) -> Result<TcpListener, Error> {
    let refused = |source: io::Error| {
        Error::Other(format!("--http {address}: {source}; give a free HOST:PORT of this machine, as in 127.0.0.1:8080"))
    };
    TcpListener::bind(address).await.map_err(refused)
}

/// The address by which a listener is reached, from elsewhere if it is.
///
/// # Errors
/// If the system does not tell.
pub fn url(listener: &TcpListener, is_encrypted: bool) -> io::Result<String> {
    let place = listener.local_addr()?;
    let host = if place.ip().is_unspecified() { worker::host_name() } else { place.ip().to_string() };
    let host = if host.contains(':') { format!("[{host}]") } else { host };
    let scheme = if is_encrypted { "https" } else { "http" };
    Ok(format!("{scheme}://{host}:{}", place.port()))
}

impl Server {
    /// Serves a run, to those who have its secret if it has one.
    pub fn start(listener: TcpListener, secret: Option<&Secret>, encryption: Option<Encryption>, shown: Shown) -> Self {
        let guard = Arc::new(Guard::new(secret, &shown.run, encryption.is_some()));
        let (registry, state) = (metrics::registry(shown.meters, shown.state.clone()), shown.state);
        let figures = move || async move { ([(CONTENT_TYPE, metrics::FORMAT)], metrics::text(&registry)) };
        let guarded = shown.page.route("/metrics", get(figures));
        let routes = guarded
            .layer(from_fn_with_state(guard, guard::let_in))
            .route("/healthz", get(move || async move { health::answer(&state.borrow()) }));
        Self { serving: tokio::spawn(serve(listener, routes, encryption)) }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.serving.abort();
    }
}
