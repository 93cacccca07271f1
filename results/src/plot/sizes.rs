//! Sizes of texts in files, px.

/// Units in a point (1/72 inch).
const POINT: f64 = 96.0 / 72.0;
/// Size of titles.
pub const TITLE: f64 = 8.5 * POINT;
/// Size of numbers at ticks, and of legends.
pub const TICK: f64 = 7.5 * POINT;
/// Size of labels.
pub const LABEL: f64 = 7.0 * POINT;
