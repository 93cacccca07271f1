//! Windows that fit the backbones they are said to be of.

use crate::curves::BackboneCurve;
use crate::overview::{Omissions, Overview};
use std::collections::HashMap;

/// Leaves out windows that are not windows of the backbones.
pub(super) fn fit_windows<'b>(
    overview: &mut Overview,
    backbones: impl Iterator<Item = &'b BackboneCurve>,
    omissions: &mut Omissions,
) {
    let thresholds: HashMap<usize, &[f64]> =
        backbones.map(|backbone| (backbone.mode + 1, &backbone.threshold.values[..])).collect();
    if thresholds.is_empty() {
        return;
    }
    for level in &mut overview.levels {
        let count = level.windows.len();
        level.windows.retain(|window| {
            let threshold = thresholds.get(&window.mode).copied().unwrap_or_default();
            let [first, last, best] = window.points;
            first <= best && best <= last && last < threshold.len() && threshold[best] == window.threshold
        });
        if level.windows.len() < count {
            let what = format!("{} of {count} windows at A = {} are", count - level.windows.len(), level.amplitude);
            omissions.left_out(what, "they are none of the backbone");
        }
    }
}
