//! Modes that do not vibrate.

use results::words::digits;
use solver::response::modes::ModesFollowed;
use solver::settings::{BackboneEquation, Settings};
use solver::structure::Model;

/// Of each mode that is followed along its damped free motion, and has none: so much damping is often one in other units.
pub(super) fn overdamped(model: &Model, settings: &Settings) -> Vec<String> {
    let followed = ModesFollowed::choose(model, settings).followed;
    followed.into_iter().filter_map(|mode| of_mode(model, settings, mode)).collect()
}

/// The same of the primary mode, without which there is no sweep.
pub(super) fn overdamped_primary(model: &Model, settings: &Settings) -> Option<String> {
    of_mode(model, settings, settings.tracked())
}

fn of_mode(model: &Model, settings: &Settings, mode: usize) -> Option<String> {
    let is_free = settings.backbone.equation == BackboneEquation::DampedMode && !model.modes().is_rigid(mode);
    let ratio = model.damping().rates()[mode] / (2.0 * model.modes().frequencies[mode]);
    (is_free && ratio >= 1.0).then(|| {
        format!(
            "mode {} is overdamped (ratio {}): no resonance, no backbone; are the units of the damping right?",
            mode + 1,
            digits(ratio, 3)
        )
    })
}
