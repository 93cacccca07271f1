//! Harmonic balance against closed forms and against direct integration, neither of which shares code with it.

mod common;
mod duffing;
mod friction;
mod linear;
mod stops;
