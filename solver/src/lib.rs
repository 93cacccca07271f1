//! Numerics of Isola: contact harmonic balance, damped backbone, Melnikov windows, isolas.

pub mod aft;
pub mod harmonics;
pub mod laws;
pub mod linalg;
pub mod model;
