//! The coordinator of Isola: from a study to its isolas, over workers wherever they are.

pub mod bus;
pub mod check;
pub mod cli;
pub mod closing;
pub mod commands;
pub mod conduct;
pub mod display;
pub mod engine;
pub mod error;
pub mod export;
pub mod ledger;
pub mod live;
pub mod local;
pub mod outputs;
pub mod page;
pub mod place;
pub mod plot;
pub mod prepare;
pub mod report;
pub mod rundir;
pub mod store;
pub mod study;
pub mod survey;
pub mod target;

#[cfg(test)]
mod fixture;
