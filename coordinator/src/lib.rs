//! The coordinator of Isola: from a study to its isolas, over workers wherever they are.

pub mod check;
pub mod ledger;
pub mod study;
