//! Who computes what: the state machine of a run, without clock, network or disk.
//!
//! Every event returns its answer and the [changes](results::journal::Change) that have to be on disk before the answer is given. Tasks of a level
//! are handed out one after the other in their order, and so are those that follow curves over all levels; levels and curves
//! go on in parallel. New tasks follow from what was found, not from when, so that what is found does not depend on how many
//! workers there are. Times are durations since an origin of the caller's choice.

mod answers;
mod chain;
mod cost;
mod evidence;
mod load;
mod patience;
mod repeat;
mod repeats;
mod restore;
mod rules;
mod search;
mod stalls;
mod state;
mod status;
mod task;
#[cfg(test)]
mod tests;
mod time_left;
mod trust;
mod withdraw;
mod worker;

pub use answers::{Accepted, Granted, Leased, Offered, Submitted};
pub use load::{Load, STATES, WorkerLoad};
pub use rules::Rules;
pub use state::Ledger;
