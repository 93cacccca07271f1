//! Numerics of Isola: contact harmonic balance, damped backbone, Melnikov windows, isolas.

pub mod aft;
pub mod amplitude;
pub mod arcs;
pub mod backbone;
pub mod branch;
pub mod continuation;
pub mod forced;
pub mod harmonics;
pub mod laws;
pub mod level;
pub mod linalg;
pub mod linear;
pub mod marching;
pub mod melnikov;
pub mod model;
pub mod newton;
pub mod pressure;
pub mod problem;
pub mod receptance;
pub mod scales;
pub mod seeds;
pub mod settings;
pub mod state;
pub mod walk;
pub mod windows;
