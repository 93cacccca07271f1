//! A run followed live, in the terminal or in a browser.

use crate::cli::WatchArgs;
use crate::display::{Display, summary};
use crate::error::Error;
use crate::remote::{RemoteRun, stored_status};
use protocol::follow::{FollowError, Follower, Update};
use std::path::Path;
use std::time::Duration;
use worker::terminal;

/// A run without an answer for so long has no coordinator any more.
const PATIENCE: Duration = Duration::from_secs(10);

/// Follows a run until it ends; with a page, until the process is ended.
pub async fn watch(args: &WatchArgs) -> Result<(), Error> {
    let found = RemoteRun::find(&args.run).await?;
    #[cfg(feature = "page")]
    if let Some(address) = &args.page {
        return match found {
            Some(RemoteRun { session, keys, manifest, .. }) => {
                let shown = crate::live_page::Shown { session: &session, keys: &keys, manifest: &manifest };
                crate::live_page::serve(shown, address).await
            }
            None => Err(nothing_to_watch(args)),
        };
    }
    match found {
        Some(run) => follow(&run).await,
        None => {
            let status = stored_status(args.run.directory.as_deref().unwrap_or(Path::new(".")), None)?;
            terminal::print(status).map_err(Error::io("standard output"))
        }
    }
}

/// Shows how the run is doing until it ends, or nobody is there any more to see it.
async fn follow(run: &RemoteRun) -> Result<(), Error> {
    let mut follower = Follower::start(&run.session, &run.keys, PATIENCE).await.map_err(FollowError::from)?;
    let mut display = Display::new();
    let mut end = run.manifest.stage.name().to_string();
    while display.is_seen() {
        match follower.next().await {
            Ok(Some(Update::Status(status))) => {
                end = summary(&status);
                display.update(&status);
            }
            Ok(Some(Update::Done(_))) => {}
            Ok(None) => {
                display.clear();
                return terminal::print(format_args!("{end}\n")).map_err(Error::io("standard output"));
            }
            Err(error) => {
                display.clear();
                return Err(match error {
                    FollowError::Gone(_) => {
                        Error::Other(format!("the coordinator of run {} is gone; it can be resumed", run.manifest.run))
                    }
                    error => error.into(),
                });
            }
        }
    }
    Ok(())
}

#[cfg(feature = "page")]
fn nothing_to_watch(args: &WatchArgs) -> Error {
    let directory = args.run.directory.as_deref().unwrap_or(Path::new("RUN")).display();
    let remedy = format!("`isola report {directory}` draws what there is, `isola resume {directory}` goes on");
    Error::Other(format!("nobody conducts this run: there is nothing to watch; {remedy}"))
}
