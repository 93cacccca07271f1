//! What time marching says of branches: their lines are dashed where they are unstable, and pale where nothing is known although other
//! parts were verified. Where nothing was verified at all nothing is pale, and the legend says so.

use super::column_store::ColumnStore;
use super::data::{Axis, Entry, Kind, Series};
use super::smooth::smooth;
use super::style::{self, BOLD, Color, Style, THIN};
use crate::curves::{Column, Curve};
use crate::overview::NOT_KNOWN;
use solver::response::branch::BranchKind;

/// How branches of a figure are marked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Marking {
    has_unstable: bool,
    /// Whether others, and what is known of them, will follow.
    is_growing: bool,
    /// Whether a solid line means that it is stable, and a pale one that nothing is known: not while verifications are still to come.
    has_unknown: bool,
    /// Whether nothing was verified.
    is_unverified: bool,
    /// Whether main branches alone, whose lines are thin, are unstable somewhere, and whether of them, as a rule of most of each, it is not
    /// known.
    of_mains: (bool, bool),
}

/// What solid lines say of branches none of which was verified.
const UNVERIFIED: &str = "nothing was verified";

/// The kind of branches whose lines are thin.
const MAIN: &str = BranchKind::Main.name();

impl Marking {
    /// Of branches that are all there.
    pub fn of<'c>(branches: impl Iterator<Item = &'c Curve> + Clone) -> Self {
        let is_verified = branches.clone().any(|branch| !branch.stable.is_empty());
        let is_unknown = |branch: &Curve| (0..branch.size).any(|i| !is_known(branch, i));
        let has_unknown = is_verified && branches.clone().any(is_unknown);
        let unknown_of_mains = branches.clone().any(|branch| branch.kind == MAIN && is_unknown(branch));
        let growing = Self::growing(branches);
        let of_mains = (growing.of_mains.0, unknown_of_mains);
        Self { has_unknown, is_growing: false, is_unverified: !is_verified, of_mains, ..growing }
    }

    /// Of branches that others, and what is known of them, will follow.
    pub fn growing<'c>(branches: impl Iterator<Item = &'c Curve>) -> Self {
        let unstable: Vec<&Curve> = branches.filter(|branch| branch.unstable.contains(&true)).collect();
        let of_mains = (unstable.iter().all(|branch| branch.kind == MAIN), false);
        Self {
            has_unstable: !unstable.is_empty(),
            is_growing: true,
            has_unknown: false,
            is_unverified: false,
            of_mains,
        }
    }

    /// What the legend says, curves being of a colour.
    pub fn entries(self, color: Color) -> impl Iterator<Item = Entry> {
        let unstable = if self.is_growing { "unstable (solid: stable, or not known)" } else { "unstable" };
        let width = |is_of_mains| if is_of_mains { THIN } else { BOLD };
        let (unstable_width, unknown_width) = (width(self.of_mains.0), width(self.of_mains.1));
        let entries = [
            (self.has_unstable, unstable.to_string(), Style::line(color, unstable_width).with_dash(1)),
            (self.has_unknown, NOT_KNOWN.into(), Style::line(color.pale(), unknown_width + style::EDGE)),
            (self.is_unverified, format!("{NOT_KNOWN}: {UNVERIFIED}"), Style::line(color, BOLD)),
        ];
        let shown = entries.into_iter().filter(|(is_there, ..)| *is_there);
        shown.map(|(_, text, style)| Entry::new(text, Kind::Line, style))
    }

    /// What lies over a curve: what is not known of it, then gaps along what of it is unstable, for each of the axes up.
    pub(super) fn over(
        self,
        branch: &Curve,
        curve: &Series,
        axes: (&Axis, &[Axis]),
        columns: &mut ColumnStore,
    ) -> Vec<Series> {
        let pale = Style::line(curve.style.color.pale(), curve.style.width + style::EDGE);
        let unknown = self.has_unknown.then(|| unknown(branch, curve));
        let parts = [unknown.map(|is_there| (is_there, pale)), Some((gaps(branch), Style::gaps(curve.style.width)))];
        let drawn =
            parts.into_iter().flatten().filter(|(is_there, _)| is_there.contains(&true)).map(|(is_there, style)| {
                let mut part = straight(branch, curve, (&is_there, style), columns);
                let shown = branch.amplitude.iter().take(axes.1.len());
                let heights: Vec<Vec<f64>> = shown.map(|column| only(&column.values, &is_there)).collect();
                let heights: Vec<&[f64]> = heights.iter().map(Vec::as_slice).collect();
                smooth(&mut part, (&branch.omega.values, &heights), axes, columns);
                part
            });
        drawn.collect()
    }
}

/// Gaps in a curve along what of it is unstable, straight from point to point.
pub fn straight_gaps(branch: &Curve, curve: &Series, columns: &mut ColumnStore) -> Option<Series> {
    let is_there = gaps(branch);
    let style = Style::gaps(curve.style.width);
    is_there.contains(&true).then(|| straight(branch, curve, (&is_there, style), columns))
}

/// A segment is drawn where both its ends are unstable.
fn gaps(branch: &Curve) -> Vec<bool> {
    (0..branch.size).map(|i| branch.unstable.get(i) == Some(&true)).collect()
}

/// A segment is drawn where one of its ends is not known.
fn unknown(branch: &Curve, curve: &Series) -> Vec<bool> {
    let count = branch.size;
    let is_unknown = |i: usize| !is_known(branch, i);
    let goes_round = curve.kind == Kind::Closed;
    let before = |i: usize| if i > 0 { Some(i - 1) } else { goes_round.then(|| count - 1) };
    let after = |i: usize| if i + 1 < count { Some(i + 1) } else { goes_round.then_some(0) };
    let is_beside = |i: usize| before(i).is_some_and(is_unknown) || after(i).is_some_and(is_unknown);
    (0..count).map(|i| is_unknown(i) || is_beside(i)).collect()
}

/// Whether a point is known to be stable or unstable.
fn is_known(branch: &Curve, i: usize) -> bool {
    [&branch.stable, &branch.unstable].into_iter().any(|which| which.get(i) == Some(&true))
}

fn straight(branch: &Curve, curve: &Series, (is_there, style): (&[bool], Style), columns: &mut ColumnStore) -> Series {
    let shown = branch.amplitude.iter().take(curve.y.len());
    let y = shown.map(|column| columns.add(Column::short(only(&column.values, is_there)))).collect();
    Series { kind: curve.kind, x: curve.x.clone(), y, style, level: curve.level, ..Series::default() }
}

/// Values where something is there; not numbers elsewhere.
fn only(values: &[f64], is_there: &[bool]) -> Vec<f64> {
    values.iter().zip(is_there).map(|(value, is)| if *is { *value } else { f64::NAN }).collect()
}
