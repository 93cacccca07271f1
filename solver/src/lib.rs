//! Numerics of Isola: contact harmonic balance, damped backbone, Melnikov windows, isolas.
//!
//! The method is that of Vadcard, Thouverez & Batailly, *Computation of isolated periodic solutions for forced response
//! blade-tip/casing contact problems*, J. Eng. Gas Turbines Power 146(4) 041011, 2024: "the paper" of this documentation;
//! numbers in brackets are its equations.
//!
//! # Conventions
//! SI units. Forcing f(t) = A s cos(mωt), A dimensionless. A motion is x(t) = Re Σ_{k=0..H} X_k e^{ikωt} with
//! X_k = a_k − i b_k, stored as a0, a1, b1, a2, b2, … Nonlinear forces F stand on the left: D_k X_k + F_k = E_k with the
//! dynamic stiffness D_k = λ_k² M + λ_k C + K, λ_k = k(−ζ + iω); forced responses have ζ = 0, free ones E = 0. Normal gaps
//! are g = c − x_N ≥ 0 with pressures λ(t) ≥ 0.
//!
//! # Way of the data
//! [`files::load`] or [`structure::Model::builder`] → [`structure::Model`] → [`response::backbone::Backbone`] → [`windows`] → [`seeds`] → [`task`] → [`response::level::Level`], with [`settings::Settings`];
//! [`marching`] checks the results independently.

pub mod curve;
pub mod files;
pub mod formulation;
pub mod linalg;
pub mod response;
pub mod settings;
pub mod stability;
pub mod structure;
