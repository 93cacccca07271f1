//! The whole system: real processes on loopback, and what users of job systems expect of it.

mod control;
mod faults;
mod input;
mod pages;
mod sweeps;
mod viewers;

/// A study with isolas whose branches take a second or two each: small steps and many harmonics.
pub const SLOW: &[&str] = &[
    "--amplitudes",
    "0.007,0.009",
    "--set",
    "harmonics.count=100",
    "--set",
    "continuation.max_step=0.001",
    "--set",
    "continuation.initial_step=0.001",
    "--set",
    "branch.max_points=100000",
];

/// Its file.
pub const DAMPER: &str = "models/nonlinear_damper/study.toml";
