//! Curves beside labels: whether a label stands nearer to another one than to its own.

use super::rectangle::Rect;
use std::collections::HashMap;

/// A curve so near to the point of a label is its own, px.
const OWN: f64 = 4.0;
/// Points are kept in cells of this size, px.
const CELL: f64 = 24.0;

/// A point; right and down from the panel's upper left corner, px.
type Point = (f64, f64);

/// Points of curves, by cells, each with the number of its curve.
#[derive(Debug, Clone, Default)]
pub(super) struct Strands {
    cells: HashMap<(i64, i64), Vec<(usize, Point)>>,
}

impl Strands {
    /// Of curves, each as points close to each other.
    pub fn new<'c>(curves: impl Iterator<Item = &'c [Point]>) -> Self {
        let mut cells: HashMap<(i64, i64), Vec<(usize, Point)>> = HashMap::new();
        for (number, points) in curves.enumerate() {
            for &point in points {
                cells.entry((cell(point.0), cell(point.1))).or_default().push((number, point));
            }
        }
        Self { cells }
    }

    /// Curves that go through a point.
    pub fn through(&self, point: Point) -> Vec<usize> {
        let near = self.within(point, (OWN, OWN)).filter(|(_, other)| distance(point, *other) <= OWN);
        let mut found: Vec<usize> = near.map(|(number, _)| *number).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Whether another curve is nearer to a label, at its edge or at its middle, than its own ones are, and its point. None is if there is
    /// no own one: then it is about a line across, say.
    pub fn is_elsewhere(&self, area: &Rect, point: Point, own: &[usize]) -> bool {
        if own.is_empty() {
            return false;
        }
        let middle = (0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom));
        let half = (0.5 * (area.right - area.left), 0.5 * (area.bottom - area.top));
        let (mut beside, mut there) = (area.distance(point), distance(middle, point));
        let reach = (there.max(half.0 + beside), there.max(half.1 + beside));
        let near: Vec<&(usize, Point)> = self.within(middle, reach).collect();
        for (_, other) in near.iter().filter(|(number, _)| own.contains(number)) {
            (beside, there) = (beside.min(area.distance(*other)), there.min(distance(middle, *other)));
        }
        let others = near.iter().filter(|(number, _)| !own.contains(number));
        others.into_iter().any(|(_, other)| area.distance(*other) < beside || distance(middle, *other) < there)
    }

    /// Points of the cells around a point.
    fn within(&self, (x, y): Point, reach: Point) -> impl Iterator<Item = &(usize, Point)> {
        let rows = cell(y - reach.1)..=cell(y + reach.1);
        let columns = cell(x - reach.0)..=cell(x + reach.0);
        let places = columns.flat_map(move |column| rows.clone().map(move |row| (column, row)));
        places.filter_map(|place| self.cells.get(&place)).flatten()
    }
}

fn cell(place: f64) -> i64 {
    (place / CELL).floor() as i64
}

fn distance(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}
