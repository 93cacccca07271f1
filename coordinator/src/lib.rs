//! The coordinator of Isola: from a study to its isolas, over workers wherever they are.

// They panic when nobody reads any more: see `worker::terminal`.
#![warn(clippy::print_stdout, clippy::print_stderr)]

pub mod access;
pub mod bus;
pub mod certificates;
pub mod check;
pub mod cli;
pub mod commands;
pub mod display;
pub mod engine;
pub mod error;
pub mod exit;
pub mod extension;
pub mod http;
pub mod ledger;
#[cfg(feature = "page")]
pub mod live_page;
pub mod outputs;
pub mod reference;
pub mod remote;
pub mod run;
pub mod study;
pub mod templates;
pub mod watch;
