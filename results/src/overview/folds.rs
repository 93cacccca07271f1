//! Whether folds can be followed.

use solver::response::folds::{Critical, Extent, Quantity};
use solver::settings::Settings;
use solver::structure::Model;

/// Most folds that a run of this model follows.
pub fn most_folds(model: &Model, settings: &Settings) -> usize {
    if why_no_folds(model, settings).is_some() { 0 } else { settings.search.effort.folds() }
}

/// Why folds cannot be followed, if so: a law has no second derivatives.
pub fn why_no_folds(model: &Model, settings: &Settings) -> Option<String> {
    let extent = Extent { forcing: (1.0, 2.0), frequency: (1.0, 2.0), points: 1 };
    Critical::new(model, settings, Quantity::Frequency, extent).err().map(|error| error.to_string())
}
