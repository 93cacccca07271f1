//! A run from its beginning, or from where it was left, to its end.
//!
//! | file | holds |
//! |---|---|
//! | `lifecycle.rs` | the steps from beginning to end |
//! | `services.rs` | what runs beside: presence on the bus, and who decides, commits and announces |
//! | `preparation.rs` | backbone and tasks, computed or stored |
//! | `local_workers.rs` | worker processes on this machine |
//! | `over_http.rs` | the run served over HTTP |
//! | `endpoint.rs`, `directory.rs` | the session on the bus; the folder of a run, and how to reach whoever serves it |

pub mod directory;
pub mod endpoint;
mod lifecycle;
mod link;
mod local_workers;
mod over_http;
pub mod preparation;
mod services;

pub use lifecycle::{Ending, drive};
