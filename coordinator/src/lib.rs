//! Isola: from a study to its isolas.

pub mod check;
pub mod study;
