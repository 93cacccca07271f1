//! Numerics of Isola: contact harmonic balance, damped backbone, Melnikov windows, isolas.

pub mod laws;
pub mod linalg;
pub mod marching;
pub mod model;
