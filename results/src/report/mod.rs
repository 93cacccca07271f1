//! A run as page and figures show it, read from the store at any stage: one [`Report`].

mod account;
mod evidence;
mod fit;
mod folded;
mod losses;
mod missed;
mod ordinary;
mod predictions;
mod ranges;
mod read;
mod sentence;
mod stability;
#[cfg(test)]
mod tests;
mod verdict;

pub use crate::curves::{BackboneCurve, Curve, Monitor, monitors};
pub use account::CostAccount;
pub use read::{Report, RunFacts, Selection};
pub use sentence::Sentence;
