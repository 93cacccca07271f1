//! Which modes a range of frequencies can be of interest for.

use crate::settings::Settings;
use crate::structure::Model;

/// Backbones bend: a resonance within this factor of a bound can come into the range.
const BENDS: f64 = 2.0;
/// Where no upper bound is given: up to this multiple of the primary mode's eigenfrequency.
pub(super) const FAR: f64 = 4.0;

/// Whether a resonance of a mode can come into the range of frequencies, and its backbone starts within its own bounds.
pub(super) fn is_in_reach(model: &Model, settings: &Settings, mode: usize) -> bool {
    let frequencies = &model.modes().frequencies;
    let (omega, m) = (frequencies[mode], model.forcing().harmonic);
    let low = settings.frequency.min.map_or(0.0, |min| min / BENDS);
    let high = settings.frequency.max.map_or(FAR * frequencies[settings.tracked(model)], |max| BENDS * max);
    let own = &settings.backbone;
    let starts = own.min_frequency.is_none_or(|min| min <= omega) && own.max_frequency.is_none_or(|max| omega <= max);
    let mut resonances = (1..=m).filter(|k| m.is_multiple_of(*k)).map(|k| omega / k as f64);
    starts && resonances.any(|resonance| (low..=high).contains(&resonance))
}
