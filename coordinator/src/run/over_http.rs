//! A run served over HTTP as long as it goes on.

use super::directory::{HTTP_TOKEN, write_http};
use super::endpoint::Connection;
use crate::bus::RunState;
use crate::engine::Meters;
use crate::error::Error;
use crate::http::{self, Encryption, Server, Shown};
use results::store::RunHeader;
use std::io::IsTerminal;
use std::path::Path;
use tokio::net::TcpListener;
use tokio::sync::watch;
use worker::terminal;

/// Serves a run, until that is dropped, and says where.
///
/// # Errors
/// If the certificates of the run are of no use for that, or it cannot be noted in the folder of the run.
pub(super) fn serve(
    listener: TcpListener,
    directory: &Path,
    header: &RunHeader,
    connection: &Connection,
    (state, meters): (watch::Receiver<RunState>, Meters),
) -> Result<Server, Error> {
    let encryption = connection.credentials.certificate.as_ref().map(Encryption::of).transpose()?;
    let url = http::url(&listener, encryption.is_some()).map_err(Error::io("--http"))?;
    let page = page(header, connection, state.clone());
    let secret = connection.credentials.secret.as_ref();
    let server = Server::start(listener, secret, encryption, Shown { run: header.run.clone(), state, meters, page });
    let token = secret.map(http::token);
    write_http(directory, &url, token.as_deref()).map_err(Error::io(directory))?;
    terminal::note(match token {
        // What is not a terminal may be kept, and read by others.
        Some(token) if std::io::stderr().is_terminal() => format!("{url}/?token={token} shows the run as it goes on"),
        Some(_) => {
            let file = directory.join(HTTP_TOKEN);
            format!("{url} shows the run as it goes on, to who has the token in {}", file.display())
        }
        None => format!("{url} shows the run as it goes on"),
    });
    Ok(server)
}

/// The live page.
#[cfg(feature = "page")]
fn page(header: &RunHeader, connection: &Connection, state: watch::Receiver<RunState>) -> axum::Router {
    let keys = protocol::keys::Keys::new(&header.namespace, &header.run);
    crate::live_page::when_asked_for(connection.session.clone(), keys, move || state.borrow().manifest.clone())
}

/// There is no page in this build.
#[cfg(not(feature = "page"))]
fn page(_: &RunHeader, _: &Connection, _: watch::Receiver<RunState>) -> axum::Router {
    axum::Router::new()
}
