//! Workers against a coordinator of a few lines, on a real bus.

mod fake;
mod joining;
mod leases;
mod level;
mod processes;
mod study;
mod troubles;
