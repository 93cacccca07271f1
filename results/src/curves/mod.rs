//! What a run has computed, as its figures need it: branches, backbone, largest responses, motions.

mod backbone;
mod branch;
mod column;
mod marched;
mod monitor;
mod motion;
mod resonance;

pub use backbone::{BackboneCurve, ModeShare, Peak, Piece};
pub use branch::{Beyond, Curve, largest};
pub use column::{Column, Quantity};
pub use marched::{MarchedPeriod, marched};
pub use monitor::{Monitor, Touch, monitors};
pub use motion::{Motion, Motions, Node};
pub use resonance::{Resonance, ResonanceComparison};
