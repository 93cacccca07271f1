//! What a structure does: its backbones, the energy balance along them, its forced responses and how they are found.

pub mod account;
pub mod backbone;
pub mod branch;
pub mod certificate;
mod column;
pub mod columns;
mod corners;
pub mod critical;
mod critical_events;
pub mod folds;
pub mod forced;
pub mod forcing;
mod grazing;
mod known;
pub mod level;
pub mod melnikov;
pub mod modes;
pub mod name;
mod reach;
pub mod seeds;
mod special;
pub mod starts;
mod symmetry;
pub mod task;
pub mod trace;
mod truncation;
pub mod windows;
