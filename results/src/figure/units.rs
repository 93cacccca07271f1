//! Axes in units that were asked for.

use super::data::{Axis, Figure, Unit};
use crate::summary_table::{FrequencyUnit, LengthUnit, UnitChoice};
use crate::words::{LENGTH_UNITS, digits};

/// Gives the axes of a figure these units.
pub fn convert(figure: &mut Figure, units: UnitChoice) {
    for axis in figure.panels.iter_mut().flat_map(|panel| panel.x.iter_mut().chain(&mut panel.y)) {
        match units.frequency {
            Some(unit) if axis.unit == Unit::si(&FrequencyUnit::RadianPerSecond.to_string()) => turn(axis, unit),
            _ => convert_length(&mut axis.unit, units.length),
        }
    }
}

/// Writes the frequencies of the legend behind its texts, in this unit: in files, for on the page the reader chooses it.
pub fn write_frequencies(figure: &mut Figure, unit: FrequencyUnit) {
    for entry in &mut figure.legend {
        let frequency = entry.frequency.take().map(|omega| digits(unit.factor() * omega, 4));
        entry.text += &frequency.map_or_else(String::new, |number| format!(" ({number} {unit})"));
    }
}

/// A unit of lengths becomes the one that was chosen, if one was.
pub(super) fn convert_length(unit: &mut Unit, chosen: Option<LengthUnit>) {
    let is_length = LENGTH_UNITS.iter().any(|(_, name)| unit.name == *name);
    if let Some(chosen) = chosen.filter(|_| is_length) {
        *unit = Unit { name: chosen.to_string(), factor: chosen.factor() };
    }
}

fn turn(axis: &mut Axis, unit: FrequencyUnit) {
    axis.unit = Unit { name: unit.to_string(), factor: unit.factor() };
    if unit == FrequencyUnit::Hertz {
        // ω is in rad/s.
        axis.title = axis.title.replace(" ω", "");
    }
}
