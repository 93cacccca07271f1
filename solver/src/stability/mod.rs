//! What happens in time: periodic orbits of time marching, and which of them are stable.

pub mod along;
mod basin;
pub mod bifurcation;
mod branch_ends;
mod crossing;
pub mod disturbance;
pub mod endings;
pub mod multipliers;
pub mod nearby;
pub mod polish;
pub mod recheck;
mod returns;
pub mod settling;
pub mod shooting;
mod symmetry;
pub mod verification;
