//! Peaks and folds of branches, as they are marked.

use super::data::Series;
use super::style::{Color, MARK, Shape, Style};
use crate::curves::{Curve, largest};
use solver::response::branch::SpecialKind;
use solver::response::certificate::Standing;

/// A fold so near to the peak, as a share of the branch, is not marked: resonances turn back just below their peaks.
const NEAR_PEAK: f64 = 0.02;

/// What a point is called on the page.
pub(super) fn word(kind: SpecialKind) -> &'static str {
    match kind {
        SpecialKind::Start => "start",
        SpecialKind::Peak => "peak",
        SpecialKind::Fold => "fold",
        SpecialKind::BranchPoint => "branch point",
    }
}

/// How such points are marked.
pub(super) fn mark(kind: SpecialKind, color: Color) -> Style {
    let shape = if kind == SpecialKind::Peak { Shape::Triangle } else { Shape::Circle };
    Style::marks(color, shape, 0.8 * MARK, true)
}

/// Marks at the peaks and folds of a branch.
pub fn special_points<'s>(branch: &'s Curve, curve: &'s Series, color: Color) -> impl Iterator<Item = Series> + 's {
    let spread = |values: &[f64]| super::axis::bounds(values.iter().copied());
    let heights = branch.amplitude.first().map_or(&[][..], |column| &column.values);
    let ((left, right), (low, high)) = (spread(&branch.omega.values), spread(heights));
    let is_at_peak = move |i: usize| {
        let across = (branch.omega.values[i] - branch.omega_at_peak) / (right - left);
        let up = (heights[i] - branch.amplitude_at_peak) / (high - low);
        across.hypot(up) < NEAR_PEAK
    };
    [SpecialKind::Fold, SpecialKind::Peak].into_iter().filter_map(move |kind| {
        let special = branch.special.iter().filter(|special| special.kind == kind).map(|special| special.index);
        // The largest amplitude at an end is no peak: the response may be larger beyond.
        let is_end = |i: usize| branch.peak_standing == Some(Standing::AtLeast) && (i == 0 || i + 1 == heights.len());
        let is_wanted = |i: usize| if kind == SpecialKind::Peak { !is_end(i) } else { !is_at_peak(i) };
        let is_shown = |i: &usize| *i < heights.len() && is_wanted(*i);
        let places: Vec<usize> = special.filter(is_shown).collect();
        // Each monitored dof has its own peak.
        let places_of = |m: usize| match kind {
            SpecialKind::Peak if m > 0 => vec![largest(&branch.amplitude[m].values)],
            _ => places.clone(),
        };
        let marks = || Series {
            x: (0..curve.y.len()).map(|m| curve.x[0].at(&places_of(m))).collect(),
            y: curve.y.iter().enumerate().map(|(m, column)| column.at(&places_of(m))).collect(),
            style: mark(kind, color),
            level: curve.level,
            ..Series::default()
        };
        (!places.is_empty()).then(marks)
    })
}
