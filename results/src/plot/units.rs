//! Axes in units that were asked for.

use crate::figure::{Axis, Figure, Unit};
use crate::summary_table::{FrequencyUnit, UnitChoice};
use crate::words::LENGTH_UNITS;

/// Gives the axes of a figure these units.
pub fn convert(figure: &mut Figure, units: UnitChoice) {
    for axis in figure.panels.iter_mut().flat_map(|panel| panel.x.iter_mut().chain(&mut panel.y)) {
        let is_length = LENGTH_UNITS.iter().any(|(_, name)| axis.unit.name == *name);
        match (units.length, units.frequency) {
            (Some(unit), _) if is_length => axis.unit = Unit { name: unit.to_string(), factor: unit.factor() },
            (_, Some(unit)) if axis.unit == Unit::si(&FrequencyUnit::RadianPerSecond.to_string()) => turn(axis, unit),
            _ => {}
        }
    }
}

fn turn(axis: &mut Axis, unit: FrequencyUnit) {
    axis.unit = Unit { name: unit.to_string(), factor: unit.factor() };
    if unit == FrequencyUnit::Hertz {
        // ω is in rad/s.
        axis.title = axis.title.replace(" ω", "");
    }
}
