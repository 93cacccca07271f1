//! How busy the coordinator keeps its workers: the real one, over the real bus, with workers that give back what was recorded
//! after as long as it took, and compute nothing.
//!
//! | module | holds |
//! |---|---|
//! | [`recording`] | a run that is finished, task by task |
//! | [`bound`] | how fast so many workers can be at best |
//! | [`workers`] | workers that replay it |
//! | [`coordinator`] | the process that they work for |
//! | [`meter`] | time, results and messages, as the workers see them |
//! | [`measure`] | one replay, and what it came to |

pub mod bound;
pub mod coordinator;
pub mod measure;
pub mod meter;
pub mod recording;
pub mod workers;
