//! Curves of solutions of an underdetermined system: Newton's method, continuation, walking to an end, extrema.

#[cfg(test)]
mod bent;
pub mod continuation;
pub mod corner;
mod crossing;
pub mod extrema;
mod frequencies;
pub mod identity;
pub mod least_norm;
pub mod newton;
pub mod outcome;
pub(crate) mod point;
pub mod problem;
pub mod record;
mod settings;
pub(crate) mod sides;
mod stabiliser;
pub mod switch;
pub mod walk;
