//! The whole system: real processes on loopback, and what users of job systems expect of it.
//!
//! Nothing here waits for seconds to pass: tests wait for states of the store, messages and ends of processes, however
//! busy the machine is. Times are limits after which something has failed.

mod certificates;
mod checkpoints;
mod control;
mod extending;
mod faults;
mod first_steps;
mod hostile;
mod https;
mod input;
mod orders;
mod pages;
mod pipes;
mod secrets;
mod serving;
mod slow_links;
mod stalls;
mod stand_in;
mod sweeps;
mod usage;
mod viewers;

use std::time::Duration;

/// A study with isolas between its forcing levels.
pub const DAMPER: &str = "models/nonlinear_damper/study.toml";

/// Two of its levels, with an isola each.
pub const LEVELS: &[&str] = &["--amplitudes", "0.007,0.009"];

/// What is found on the way from the backbone, as it was traced: for tests of something else than searching and marching.
pub const BRIEF: &[&str] = &["--search", "none", "--verify", "none"];

/// Few random starts, for tests that need those of a search and not what most of its time goes into.
pub const FEW: &[&str] = &["--set", "search.starts=512"];

/// Branches that take a second or two each: small steps and many harmonics. Without random starts, which would take minutes.
pub const FINE: &[&str] = &[
    "--set",
    "search.effort=none",
    "--set",
    "harmonics.count=100",
    "--set",
    "continuation.max_step=0.001",
    "--set",
    "continuation.initial_step=0.001",
    "--set",
    "branch.max_points=100000",
];

/// Branches that do not end within a test, after a backbone of a few points.
pub const ENDLESS: &[&str] = &[
    "--amplitudes",
    "0.007,0.009",
    "--set",
    "backbone.max_points=10",
    "--set",
    "branch.max_amplitude=3",
    "--set",
    "branch.max_points=1000000000",
    "--set",
    "continuation.max_step=1e-8",
    "--set",
    "continuation.initial_step=1e-9",
    "--set",
    "continuation.min_step=1e-10",
];

/// A main branch that takes a while, after a backbone of a few points.
pub const LASTING: &[&str] = &[
    "--amplitudes",
    "0.009",
    "--verify",
    "none",
    "--set",
    "backbone.max_points=10",
    "--set",
    "harmonics.count=40",
    "--set",
    "branch.max_points=1000000",
    "--set",
    "continuation.max_step=3e-4",
    "--set",
    "continuation.initial_step=3e-4",
];

/// Leases that run out while a test waits for it, but not under a worker that has to share its core with others.
pub const SHORT: &[&str] = &["--lease", "5"];

/// Leases that do not run out within a test: its workers give no sign of life by themselves for a third of that.
pub const LONG: &[&str] = &["--lease", "900"];

/// A third of it.
pub const THIRD_OF_LONG: Duration = Duration::from_secs(300);
