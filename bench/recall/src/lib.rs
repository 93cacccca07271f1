//! How many isolas of random small structures Isola finds.
//!
//! `truth` draws structures and finds their forced responses by code of its own: a harmonic balance in which all dofs
//! stay, from thousands of random starts a forcing level, branches closed by its own continuation, samples confirmed
//! by time integration. What it found is stored in `truth/`. `recall` runs `isola sweep` on the same models and
//! compares; what is listed beyond the truth is followed anew with the equations of the truth.
//!
//! Motions are Σ a_k cos kτ + b_k sin kτ, τ = ωt, ω the frequency of the response; the forcing is A s cos mτ. SI units.

pub mod balance;
pub mod closed;
pub mod comparison;
pub mod confirm;
pub mod draw;
pub mod images;
pub mod known;
pub mod model;
pub mod newton;
pub mod product;
pub mod quadrature;
pub mod record;
pub mod shooting;
pub mod starts;
pub mod structure;
pub mod survey;
pub mod tally;
pub mod walk;
