//! Exit codes besides 0, as the help lists them.

/// Something went wrong.
pub const ERROR: u8 = 1;
/// The command line asks for what makes no sense.
pub const USAGE: u8 = 2;
/// Ended with tasks missing, with results that others contradict, or without something stored that is damaged.
pub const INCOMPLETE: u8 = 3;
/// Every task is done, but what was asked for is not known for certain: see `results::overview::doubts`.
pub const DOUBTFUL: u8 = 4;
/// Somebody wanted the process to end.
pub const INTERRUPTED: u8 = 130;
