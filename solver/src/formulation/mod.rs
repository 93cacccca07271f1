//! Harmonic balance: the equations of a structure for a truncated Fourier series, in two formulations.

pub mod aft;
pub mod arcs;
pub mod displacement;
pub mod harmonics;
pub mod linear;
pub mod pressure;
pub mod receptance;
pub mod scales;
pub mod state;
pub mod unknown;
