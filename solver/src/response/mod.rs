//! What a structure does: its backbones, the energy balance along them, its forced responses and how they are found.

pub mod account;
pub mod backbone;
pub mod branch;
pub mod certificate;
mod column;
pub mod columns;
pub mod forced;
pub mod forcing;
pub mod level;
pub mod melnikov;
pub mod name;
pub mod seeds;
mod special;
pub mod task;
mod truncation;
pub mod windows;
