//! Whether a process carries its run on.

use crate::bus::RunState;
use axum::http::StatusCode;
use std::time::Duration;

/// The status is told twice a second, after what was decided before is on disk.
const SILENCE: Duration = Duration::from_secs(30);

/// The answer to whoever looks after this process.
pub fn answer(state: &RunState) -> (StatusCode, String) {
    let silence = state.told.elapsed();
    if silence < SILENCE {
        (StatusCode::OK, "ok\n".into())
    } else {
        let seconds = silence.as_secs();
        (StatusCode::SERVICE_UNAVAILABLE, format!("nothing has been decided or stored for {seconds} s\n"))
    }
}
