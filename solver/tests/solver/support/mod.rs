//! What the answers of the solver are checked with: the harmonic balance and the motion of a model, each written once more
//! from its definition, and what a level lists.
#![allow(dead_code, reason = "each test file uses a part of it")]

pub mod balance;
pub mod fold_curves;
pub mod geometry;
pub mod hill;
pub mod linear;
pub mod march;
pub mod messages;
pub mod ring;
pub mod starts;
pub mod study;
