//! Curves of solutions of an underdetermined system: Newton's method, continuation, walking to an end, extrema.

pub mod continuation;
pub mod extrema;
pub mod identity;
pub mod least_norm;
pub mod newton;
pub mod outcome;
pub mod problem;
mod stabiliser;
pub mod walk;
