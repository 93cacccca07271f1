//! The session of a coordinator on the bus, and the endpoint by which others reach it.

use crate::cli::ServeArgs;
use crate::error::Error;
use protocol::credentials::Credentials;
use protocol::keys::Keys;
use protocol::session::{self, SessionError};
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::time::Duration;
use tokio::net::TcpListener;
use zenoh::Session;

/// Free ports tried if others are faster.
const ATTEMPTS: u32 = 5;

/// A session on the bus.
pub struct Connection {
    /// Session.
    pub session: Session,
    /// Where others on this machine connect to.
    pub endpoint: String,
    /// Where others on other machines connect to, as far as it is known here.
    pub elsewhere: String,
    /// What lets others in.
    pub credentials: Credentials,
    /// Whether that is somebody else's router.
    pub is_over_router: bool,
    /// Where the run is served over HTTP, if it is.
    pub http: Option<TcpListener>,
}

/// Opens the session of a coordinator; of a run that goes on in its folder.
///
/// # Errors
/// If the endpoint is none, is in use or cannot be reached.
pub async fn open(serve: &ServeArgs, directory: Option<&Path>) -> Result<Connection, Error> {
    let chosen = serve.connect.as_deref().or(serve.listen.as_deref());
    let credentials = serve.access.credentials(directory, chosen, serve.connect.is_some())?;
    let http = match &serve.http {
        Some(address) => Some(crate::http::bind(address).await?),
        None => None,
    };
    if let Some(router) = &serve.connect {
        let session = session::connect(router, &credentials).await?;
        return Ok(Connection {
            session,
            endpoint: router.clone(),
            elsewhere: router.clone(),
            credentials,
            is_over_router: true,
            http,
        });
    }
    if let Some(listen) = &serve.listen {
        let listen = with_port(listen);
        let session = session::listen(&listen, &credentials, &serve.namespace).await?;
        let (endpoint, elsewhere) = (reachable(&listen), seen_from_elsewhere(&listen));
        return Ok(Connection { session, endpoint, elsewhere, credentials, is_over_router: false, http });
    }
    let mut attempts = 0;
    loop {
        let endpoint = free_endpoint().map_err(Error::io("tcp/127.0.0.1"))?;
        match session::listen(&endpoint, &credentials, &serve.namespace).await {
            Ok(session) => {
                let elsewhere = endpoint.clone();
                return Ok(Connection { session, endpoint, elsewhere, credentials, is_over_router: false, http });
            }
            // Somebody else took the port in between.
            Err(SessionError::Listen { .. }) if attempts < ATTEMPTS => attempts += 1,
            Err(error) => return Err(error.into()),
        }
    }
}

/// Refuses a run that has a coordinator on the bus already.
pub async fn refuse_second_coordinator(session: &Session, keys: &Keys) -> Result<(), Error> {
    let query = session.liveliness().get(keys.alive_coordinator()).timeout(Duration::from_secs(1)).await;
    let replies = query.map_err(|error| Error::Other(format!("the bus does not answer: {error}")))?;
    match replies.recv_async().await {
        Ok(_) => Err(Error::Other("this run has a coordinator on the bus already: stop it first".into())),
        Err(_) => Ok(()),
    }
}

/// An endpoint on the loopback interface with a port that is free now.
fn free_endpoint() -> io::Result<String> {
    let port = std::net::TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?.port();
    Ok(format!("tcp/127.0.0.1:{port}"))
}

/// The endpoint with a port that is free now, if it leaves that open: others have to be told one.
fn with_port(listen: &str) -> String {
    let free = || {
        let (protocol, address) = listen.split_once('/')?;
        let address = address.parse::<SocketAddr>().ok().filter(|address| address.port() == 0)?;
        let bound = std::net::TcpListener::bind(address).and_then(|listener| listener.local_addr()).ok()?;
        Some(format!("{protocol}/{bound}"))
    };
    free().unwrap_or_else(|| listen.to_string())
}

/// The endpoint to connect to from other machines, for one that is listened on.
fn seen_from_elsewhere(listen: &str) -> String {
    let host = worker::host_name();
    listen.replace("/0.0.0.0:", &format!("/{host}:")).replace("/[::]:", &format!("/{host}:"))
}

/// The endpoint to connect to from this machine, for one that is listened on.
fn reachable(listen: &str) -> String {
    listen.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:")
}
