//! The session of a coordinator on the bus, and the endpoint by which others reach it.

use crate::cli::ServeArgs;
use crate::error::Error;
use protocol::keys::Keys;
use protocol::session::{self, SessionError};
use std::io;
use std::net::{Ipv4Addr, TcpListener};
use std::time::Duration;
use zenoh::Session;

/// Free ports tried if others are faster.
const ATTEMPTS: u32 = 5;

/// A session on the bus.
pub struct Connection {
    /// Session.
    pub session: Session,
    /// Where others on this machine connect to.
    pub endpoint: String,
    /// Whether that is somebody else's router.
    pub is_over_router: bool,
}

/// Opens the session of a coordinator.
///
/// # Errors
/// If the endpoint is none, is in use or cannot be reached.
pub async fn open(serve: &ServeArgs) -> Result<Connection, Error> {
    if let Some(router) = &serve.connect {
        return Ok(Connection { session: session::connect(router).await?, endpoint: router.clone(), is_over_router: true });
    }
    if let Some(listen) = &serve.listen {
        return Ok(Connection { session: session::listen(listen).await?, endpoint: reachable(listen), is_over_router: false });
    }
    let mut attempts = 0;
    loop {
        let endpoint = free_endpoint().map_err(Error::io("tcp/127.0.0.1"))?;
        match session::listen(&endpoint).await {
            Ok(session) => return Ok(Connection { session, endpoint, is_over_router: false }),
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
    let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?.port();
    Ok(format!("tcp/127.0.0.1:{port}"))
}

/// The endpoint to connect to from this machine, for one that is listened on.
fn reachable(listen: &str) -> String {
    listen.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:")
}
