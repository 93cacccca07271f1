//! The worker of Isola: leases a task, traces its branch, submits it, until all work is done.
//!
//! A worker is a client of the coordinator's bus and has no state of its own: it may be ended in any way at any time. What
//! it computed is kept and sent again until the coordinator has stored it, as long as patience lasts.
//!
//! | module | holds |
//! |---|---|
//! | [`options`], [`error`], [`program`] | command line; errors and exit codes; the whole program |
//! | [`terminal`], [`log`] | what people are told; what is logged |
//! | [`shutdown`] | signals and lifeline |
//! | [`join`], [`identity`] | finding the run and fetching its model; the worker's name |
//! | [`shared`], [`turns`] | what the computing threads share; the two lanes of one of them |
//! | [`leasing`] | asking for work until there is some |
//! | [`bus`], [`patience`] | requests to the coordinator; how long and how often they are repeated |
//! | [`renewal`] | signs of life of a task under way |
//! | [`findings`], [`compute`] | landings, branches and fold curves found before; the thread that computes |
//!
//! # Exit codes
//!
//! | code | when |
//! |---|---|
//! | 0 | all work is done, the run was cancelled, nothing was to be done for `--idle-exit`, or it was told to end (SIGTERM, SIGINT, lifeline) |
//! | 1 | no coordinator or no run was found in time, or the coordinator was gone for longer than patience lasts |
//! | 2 | wrong options |
//! | 3 | this worker and this run do not fit (another version, another model, several runs to choose from): starting it again will not help |
//! | 130, 143 | a second SIGINT or SIGTERM: ended at once, nothing given back |

// They panic when nobody reads any more: see [`terminal`].
#![warn(clippy::print_stdout, clippy::print_stderr)]

pub mod bus;
mod checkpoints;
pub mod compute;
pub mod error;
pub mod findings;
pub mod identity;
pub mod join;
mod lane;
pub mod leasing;
pub mod log;
pub mod options;
pub mod patience;
pub mod program;
pub mod renewal;
pub mod shared;
pub mod shutdown;
pub mod terminal;
pub mod turns;

pub use error::WorkerError;
pub use identity::host_name;
pub use log::LogFormat;
pub use options::Options;
pub use program::{Ending, Summary, run, work};
