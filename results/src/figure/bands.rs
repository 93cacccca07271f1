//! What unstable motions turn into, in the figure of the response: from the smallest to the largest amplitude in a period.

use super::column_store::{ColumnStore, Ref};
use super::data::{Kind, Series};
use super::style::{Color, FINE, Style};
use crate::curves::{Beyond, Column, Curve};

/// Bars at the motions that were followed from a branch, in its colour, and bands, in another one than the insides of isolas, between those that are neighbours on an unstable stretch of it.
pub(super) fn bands(branch: &Curve, curve: &Series, color: Color, columns: &mut ColumnStore) -> Vec<Series> {
    let shown: Vec<&Beyond> = branch.beyond.iter().filter(|beyond| beyond.is_shown()).collect();
    if shown.is_empty() {
        return Vec::new();
    }
    // A band ends at what falls onto a branch, and at what is not clear.
    let is_band = |run: &&[Beyond]| run.len() > 1;
    let lasts = |a: &Beyond, b: &Beyond| a.is_shown() && b.is_shown() && lasts(branch, a, b);
    let monitors = branch.amplitude.len();
    let level = curve.level;
    let mut series = Vec::new();
    for run in branch.beyond.chunk_by(lasts).filter(is_band) {
        let x = vec![columns.exact(run.iter().map(|beyond| beyond.omega).collect())];
        let mut edge = |side: usize| -> Vec<Ref> {
            let of = |m: usize| Column::short(run.iter().map(|beyond| beyond.amplitudes[m][side]).collect());
            (0..monitors).map(|m| columns.add(of(m))).collect()
        };
        let (y, y2) = (edge(0), edge(1));
        series.push(Series {
            kind: Kind::Band,
            x,
            y,
            y2,
            style: Style::area(Color::Shade),
            level,
            ..Series::default()
        });
    }
    let bar = |omega: f64| [omega, omega, f64::NAN];
    let x = vec![columns.exact(shown.iter().flat_map(|beyond| bar(beyond.omega)).collect())];
    let heights = |m: usize| {
        let bar = |beyond: &&Beyond| [beyond.amplitudes[m][0], beyond.amplitudes[m][1], f64::NAN];
        Column::short(shown.iter().flat_map(bar).collect())
    };
    let y = (0..monitors).map(|m| columns.add(heights(m))).collect();
    series.push(Series { x, y, style: Style::line(color, FINE), level, ..Series::default() });
    series
}

/// Whether a branch is unstable all the way from one motion to the next.
fn lasts(branch: &Curve, a: &Beyond, b: &Beyond) -> bool {
    let (low, high) = (a.point.min(b.point), a.point.max(b.point));
    branch.unstable.get(low..=high).is_some_and(|stretch| stretch.iter().all(|is_unstable| *is_unstable))
}
