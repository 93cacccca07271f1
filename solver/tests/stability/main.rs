//! Which orbits are stable: tangents of the time marcher, polished orbits, multipliers, bifurcations, against differences,
//! closed forms, direct integration and marching.

mod models;
mod tangent;
