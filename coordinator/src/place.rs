//! A place on the bus for a coordinator.

use crate::cli::ServeArgs;
use crate::error::Error;
use crate::rundir::{free_endpoint, reachable};
use protocol::keys::Keys;
use protocol::session;
use std::time::Duration;
use zenoh::Session;

/// A place on the bus: session, and the endpoint by which others on this machine reach it.
pub struct Place {
    /// Session.
    pub session: Session,
    /// Where others on this machine connect to.
    pub endpoint: String,
}

/// Opens the session of a coordinator.
///
/// # Errors
/// If the endpoint is none, is in use or cannot be reached.
pub async fn open(serve: &ServeArgs) -> Result<Place, Error> {
    if let Some(router) = &serve.connect {
        return Ok(Place { session: session::connect(router).await?, endpoint: router.clone() });
    }
    if let Some(listen) = &serve.listen {
        return Ok(Place { session: session::listen(listen).await?, endpoint: reachable(listen) });
    }
    let mut attempts = 0;
    loop {
        let endpoint = free_endpoint().map_err(Error::io("tcp/127.0.0.1"))?;
        match session::listen(&endpoint).await {
            Ok(session) => return Ok(Place { session, endpoint }),
            // Somebody else took the port in between.
            Err(session::SessionError::Listen { .. }) if attempts < 5 => attempts += 1,
            Err(error) => return Err(error.into()),
        }
    }
}

/// Refuses to conduct a run that somebody else on the bus conducts.
pub async fn alone(session: &Session, keys: &Keys) -> Result<(), Error> {
    let query = session.liveliness().get(keys.alive_coordinator()).timeout(Duration::from_secs(1)).await;
    let replies = query.map_err(|error| Error::Other(format!("the bus does not answer: {error}")))?;
    match replies.recv_async().await {
        Ok(_) => Err(Error::Other("this run has a coordinator on the bus already: stop it first".into())),
        Err(_) => Ok(()),
    }
}
