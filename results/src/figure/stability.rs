//! What of a branch is unstable, by time marching: its line is dashed there.

use super::column_store::ColumnStore;
use super::data::{Axis, Series};
use super::smooth::smooth;
use super::style::Style;
use crate::curves::{Column, Curve};

/// Gaps in a curve along what of it is unstable, for each of the axes up.
pub(super) fn unstable(
    branch: &Curve,
    curve: &Series,
    axes: (&Axis, &[Axis]),
    columns: &mut ColumnStore,
) -> Option<Series> {
    let mut gaps = straight_gaps(branch, curve, columns)?;
    let shown = branch.amplitude.iter().take(axes.1.len());
    let heights: Vec<Vec<f64>> = shown.map(|column| where_unstable(branch, &column.values)).collect();
    let heights: Vec<&[f64]> = heights.iter().map(Vec::as_slice).collect();
    smooth(&mut gaps, (&branch.omega.values, &heights), axes, columns);
    Some(gaps)
}

/// The same, straight from point to point.
pub fn straight_gaps(branch: &Curve, curve: &Series, columns: &mut ColumnStore) -> Option<Series> {
    if !branch.unstable.contains(&true) {
        return None;
    }
    // A segment is drawn where both its ends are unstable.
    let shown = branch.amplitude.iter().take(curve.y.len());
    let y = shown.map(|column| columns.add(Column::short(where_unstable(branch, &column.values)))).collect();
    let style = Style::gaps(curve.style.width);
    Some(Series { kind: curve.kind, x: curve.x.clone(), y, style, level: curve.level, ..Series::default() })
}

/// Values at points that are unstable; not numbers elsewhere.
fn where_unstable(branch: &Curve, values: &[f64]) -> Vec<f64> {
    values
        .iter()
        .zip(&branch.unstable)
        .map(|(value, is_unstable)| if *is_unstable { *value } else { f64::NAN })
        .collect()
}
