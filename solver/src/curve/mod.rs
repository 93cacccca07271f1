//! Curves of solutions of an underdetermined system: Newton's method and continuation.

pub mod continuation;
pub mod newton;
pub mod problem;
