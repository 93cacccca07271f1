//! Which orbits are stable: tangents of the time marcher, polished orbits, multipliers, bifurcations, against differences,
//! closed forms, direct integration and marching.

mod common;
mod counts;
mod disturbance;
mod duffing;
mod growth;
mod hill;
mod jenkins;
mod lasting;
mod models;
mod settling;
mod stops;
mod symmetry;
mod tangent;
mod verification;
