//! Frequencies and lengths in the units of the study.

use crate::study::Study;
use results::words::{digits, number};

/// A frequency given in rad/s, in the unit of the study.
pub(super) fn frequency(study: &Study, omega: f64) -> String {
    let unit = study.frequency_unit();
    format!("{} {unit}", number(unit.factor() * omega))
}

/// Two frequencies given in rad/s, in the unit of the study.
pub(super) fn frequencies_between(study: &Study, low: f64, high: f64) -> String {
    let unit = study.frequency_unit();
    format!("{} to {} {unit}", number(unit.factor() * low), number(unit.factor() * high))
}

/// A length given in m, in the unit of the study, with so many digits.
pub(super) fn length(study: &Study, metres: f64, count: i32) -> String {
    let unit = study.units.of_table().length;
    format!("{} {unit}", digits(unit.factor() * metres, count))
}
