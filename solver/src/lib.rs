//! Numerics of Isola: contact harmonic balance, damped backbone, Melnikov windows, isolas.

pub mod aft;
pub mod continuation;
pub mod harmonics;
pub mod laws;
pub mod linalg;
pub mod model;
pub mod newton;
pub mod pressure;
pub mod problem;
pub mod receptance;
pub mod scales;
pub mod state;
