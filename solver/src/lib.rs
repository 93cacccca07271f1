//! Numerics of Isola: contact harmonic balance, damped backbone, Melnikov windows, isolas.
//!
//! The method is that of Vadcard, Thouverez & Batailly, *Computation of isolated periodic solutions for forced response
//! blade-tip/casing contact problems*, J. Eng. Gas Turbines Power 146(4) 041011, 2024: "the paper" of this documentation;
//! numbers in brackets are its equations.
//!
//! # From a model to its forced response
//!
//! ```
//! use solver::laws::{PolynomialSpring, Term};
//! use solver::{Backbone, Level, Model, Settings};
//!
//! // Duffing's oscillator: ẍ + 0.1 ẋ + x + x³ = A cos ωt.
//! let cubic = PolynomialSpring { terms: vec![Term { power: 3, coefficient: 1.0 }] };
//! let model = Model::builder("Duffing")
//!     .mass([[1.0]])
//!     .stiffness([[1.0]])
//!     .damping_ratio(0.05)
//!     .force("x1", 1.0)
//!     .element("spring", cubic, ["x1"])
//!     .build()?;
//! let mut settings = Settings::default();
//! settings.frequency.min = Some(0.5);
//! let backbone = Backbone::compute(&model, &settings)?;
//! let level = Level::compute(&model, &settings, &backbone, 0.3)?;
//! let peak = level.main().peak();
//! println!("{:.3} m at {:.3} rad/s", peak.amplitude(), peak.omega());
//! assert!(level.isolas().next().is_none() && peak.amplitude() > 1.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `examples/two_masses.rs` finds an isola; `examples/level.rs` reads a model folder.
//!
//! # Equations
//! SI units. Forcing A s cos(mωt), A dimensionless. A motion is a truncated Fourier series,
//!
//! <math display="block"><mi>x</mi><mo>(</mo><mi>t</mi><mo>)</mo><mo>=</mo><mi>Re</mi><munderover><mo>∑</mo><mrow><mi>k</mi><mo>=</mo><mn>0</mn></mrow><mi>H</mi></munderover><msub><mi>X</mi><mi>k</mi></msub><msup><mi>e</mi><mrow><mi>i</mi><mi>k</mi><mi>ω</mi><mi>t</mi></mrow></msup><mo>,</mo><mspace width="1em"/><msub><mi>X</mi><mi>k</mi></msub><mo>=</mo><msub><mi>a</mi><mi>k</mi></msub><mo>−</mo><mi>i</mi><msub><mi>b</mi><mi>k</mi></msub><mo>,</mo></math>
//!
//! stored as a0, a1, b1, a2, b2, …: nc = 2H + 1 numbers a series. Nonlinear forces stand on the left of the balance,
//!
//! <math display="block"><msub><mi>D</mi><mi>k</mi></msub><msub><mi>X</mi><mi>k</mi></msub><mo>+</mo><msub><mi>F</mi><mi>k</mi></msub><mo>=</mo><msub><mi>E</mi><mi>k</mi></msub><mo>,</mo><mspace width="1em"/><msub><mi>D</mi><mi>k</mi></msub><mo>=</mo><msubsup><mi>λ</mi><mi>k</mi><mn>2</mn></msubsup><mi>M</mi><mo>+</mo><msub><mi>λ</mi><mi>k</mi></msub><mi>C</mi><mo>+</mo><mi>K</mi><mo>,</mo><mspace width="1em"/><msub><mi>λ</mi><mi>k</mi></msub><mo>=</mo><mi>k</mi><mo>(</mo><mo>−</mo><mi>ζ</mi><mo>+</mo><mi>i</mi><mi>ω</mi><mo>)</mo><mo>;</mo></math>
//!
//! forced responses have ζ = 0, free ones E = 0. Rigid contact has gaps g = c − x_N ≥ 0, pressures λ(t) ≥ 0 and λ g = 0.
//! A forced response is predicted near a free motion where the forcing can supply what is dissipated,
//!
//! <math display="block"><mi>A</mi><mo>&gt;</mo><msup><mi>A</mi><mo>*</mo></msup><mo>=</mo><mfrac><mrow><mo>|</mo><msub><mi>R</mi><mtext>lin</mtext></msub><mo>+</mo><msub><mi>R</mi><mtext>nl</mtext></msub><mo>|</mo></mrow><mrow><mi>π</mi><mi>m</mi><mo>|</mo><msub><mi>X</mi><mi>m</mi></msub><mo>·</mo><mi>s</mi><mo>|</mo></mrow></mfrac><mo>.</mo></math>
//!
//! # Rooms
//! * [`structure`]: what a model is: matrices, modes, damping, laws; always valid
//! * [`files`]: models read from folders
//! * [`formulation`]: its harmonic balance, in two formulations behind one trait
//! * [`curve`]: curves of solutions of any system: Newton, continuation, ends, extrema
//! * [`response`]: backbone, energy balance, windows, seeds, branches, levels, fold and peak curves
//! * [`stability`]: marching in time, without harmonics: an independent check; its periodic orbits, multipliers, bifurcations
//!
//! Laws are a closed set: they travel in messages and files, so a new one is added to the library (one file, its `mod`
//! line and its row in a table) rather than from outside.

#![warn(clippy::missing_errors_doc)]

pub mod curve;
pub mod files;
pub mod formulation;
pub mod marching;
pub mod response;
pub mod settings;
pub mod stability;
pub mod structure;

pub use formulation::state::State;
pub use linalg;
pub use linalg::Matrix;
pub use marching::{Marching, MarchingSettings};
pub use response::backbone::{Backbone, BackboneError, BackbonePoint};
pub use response::branch::{Branch, BranchPoint, Outcome, SpecialKind, SpecialPoint};
pub use response::folds::{Critical, CriticalCurve, CriticalEvent, CriticalKind, Extent, Quantity};
pub use response::forced::{Forced, SearchRange};
pub use response::level::{BranchId, Level, LevelError};
pub use response::modes::{Backbones, LeftOut, ModesFollowed};
pub use response::windows::{Window, events, windows};
pub use settings::{ModeChoice, NumberList, Settings, Stretch};
pub use stability::along::{AlongSettings, BranchStability, End, along};
pub use stability::bifurcation::{Bifurcation, BifurcationKind, Obstacle, Unresolved};
pub use stability::multipliers::{Multiplier, Verdict};
pub use stability::polish::{Around, Polish, PolishSettings, Polished, polish};
pub use stability::shooting::Orbit;
pub use stability::verification::{Verification, verify};
pub use structure::{Model, ModelBuilder, ModelError, laws};

/// The README's code compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
