//! Decides and commits.
//!
//! | file | holds |
//! |---|---|
//! | `event.rs`, `decision.rs` | what the engine is told and asked; what it decides |
//! | `checked_result.rs` | a result as it reaches the engine: checked against the equations, encoded and hashed by others |
//! | `checkpoints.rs` | what is kept of tasks under way |
//! | `machine.rs`, `sweep.rs` | the state machine, `handle(event) → decision`: no clock, no network, no disk |
//! | `parking.rs` | threads for which there was no work, and whom to wake when there is |
//! | `decide.rs`, `commit.rs` | deciding, on the thread of whoever asks; the thread that commits, then answers and tells |
//! | `meters.rs` | what is counted meanwhile |
//!
//! Deciding takes microseconds, committing milliseconds. So signs of life, which change nothing on disk, never wait for
//! results to be stored. Every other answer is given once everything decided before it is on disk.

mod checked_result;
mod checkpoints;
mod commit;
mod decide;
mod decision;
mod event;
mod machine;
mod meters;
mod parking;
mod sweep;
#[cfg(test)]
mod tests;

pub use checked_result::{CheckedResult, Expected, Unsound};
pub use commit::{Decided, commit};
pub use decide::{Decider, Responder, tick};
pub use decision::{Answer, Decision, News, Offer};
pub use event::{Beginning, Event, Stored};
pub use machine::Engine;
pub use meters::Meters;
