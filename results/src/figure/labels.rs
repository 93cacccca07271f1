//! Labels where there is room: beside their points, within the panel, off the curves and off each other.

use super::data::Side;
use super::line::{Line, cross};
use super::rectangle::Rect;
use super::strands::Strands;
use super::text::LINE;

/// Distances of a label from its point that are tried, for texts of [`TEXT`], and how many crossings of curves each is as
/// bad as.
const DISTANCES: [(f64, usize); 6] = [(3.0, 0), (8.0, 2), (20.0, 5), (40.0, 8), (70.0, 12), (110.0, 17)];
/// Size of texts for which these distances are.
const TEXT: f64 = 9.3;
/// From this distance on a line leads from the label to its point.
const FAR: f64 = 10.0;
/// How bad each point of a curve is that a label covers.
const CROSSING: usize = 2;
/// How bad it is if a label without a line stands nearer to another curve than to its own one.
const ELSEWHERE: usize = 6;
/// How bad it is if a label lies over faint curves.
const FAINT: usize = 4;
/// A label that covers more of the curves than so many of their points is left out.
const COVERED: usize = 8;
/// Between a mark and a label.
const BESIDE_MARK: f64 = 0.8;
/// A line from a label ends so far before its point.
const END: f64 = 8.0;
/// Distance from the edges of the panel, where ticks are.
const EDGE: f64 = 5.0;
/// Distance of the points at which a curve is tested, px, and size of the cells in which they are counted.
const STEP: f64 = 3.0;
/// Directions that are tried, right and down of the point, the best first.
const ABOVE: [(f64, f64); 8] =
    [(0.0, -1.0), (1.0, -1.0), (-1.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (0.0, 1.0)];
const BESIDE: [(f64, f64); 8] =
    [(1.0, -1.0), (1.0, 1.0), (1.0, 0.0), (-1.0, -1.0), (-1.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0)];
const LEVEL: [(f64, f64); 3] = [(1.0, 0.0), (1.0, -1.0), (1.0, 1.0)];

/// Distances downwards, as shares of those to the right; all but the first where a line leads to the point.
const SLOPES: [f64; 3] = [0.6, 1.4, 0.25];
/// Labels are no farther from their points than this, for texts of [`TEXT`].
const LONGEST: f64 = 120.0;

/// How large a panel and its texts are, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Width inside of the axes.
    pub width: f64,
    /// Height inside of the axes.
    pub height: f64,
    /// Size of texts.
    pub text: f64,
}

/// Where a label stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Which part of the text is at the end of the offset: −1, 0, 1 for left, centre, right; and for top, centre, bottom.
    pub anchor: (i8, i8),
    /// From the point to there, right and down, px.
    pub offset: (f64, f64),
    /// Whether a line leads there.
    pub has_leader: bool,
    /// The room it takes.
    pub area: Rect,
}

/// A curve in shares of the axes, right and up, that labels keep off.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// Its points; NaN in gaps.
    pub points: Vec<(f64, f64)>,
    /// Whether a label beside it may be taken for its.
    pub may_have_label: bool,
    /// Whether it is so thin that a label may lie over it, if there is no better place.
    pub is_faint: bool,
}

/// A mark at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Where, in shares of the axes, right and up.
    pub at: (f64, f64),
    /// How wide it is in files, px.
    pub size: f64,
}

/// A point; right and down from the panel's upper left corner.
type Point = (f64, f64);

/// What is where in a panel.
#[derive(Debug, Clone)]
pub struct Room {
    field: Field,
    reach: f64,
    curves: Cells,
    faint: Cells,
    strands: Strands,
    taken: Vec<Rect>,
    leaders: Vec<Point>,
    lines: Vec<Line>,
}

impl Room {
    /// With curves and marks.
    pub fn new(field: Field, has_leaders: bool, curves: &[Obstacle], marks: &[Mark]) -> Self {
        let curves: Vec<(Vec<Point>, &Obstacle)> =
            curves.iter().map(|curve| (dense(&curve.points, field), curve)).collect();
        let named = curves.iter().filter(|(_, curve)| curve.may_have_label);
        let strands = Strands::new(named.map(|(points, _)| points.as_slice()));
        let points = |is_faint| {
            let wanted = curves.iter().filter(move |(_, curve)| curve.is_faint == is_faint);
            wanted.flat_map(|(points, _)| points.iter().copied())
        };
        let half = |size: f64| 0.5 * size * field.text / TEXT + BESIDE_MARK;
        let marks = marks.iter().map(|mark| (place(mark.at, field), half(mark.size)));
        let marks = marks.filter(|(point, _)| is_somewhere(point));
        Self {
            field,
            reach: if has_leaders { f64::INFINITY } else { FAR },
            curves: Cells::new(points(false), field),
            faint: Cells::new(points(true), field),
            strands,
            taken: marks.map(|(point, half)| around(point, half)).collect(),
            leaders: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Takes the place of a label of this width that covers least of the curves and is not far from its point, if there is
    /// one; the point in shares of the axes.
    pub fn take(&mut self, at: (f64, f64), width: f64, side: Side) -> Option<Spot> {
        let point = Some(place(at, self.field)).filter(is_somewhere)?;
        let spot = self.best(point, width, side)?;
        self.leaders.extend(way(&spot, point));
        self.lines.extend(leader(&spot, point));
        self.taken.push(spot.area);
        Some(spot)
    }

    fn best(&self, point: Point, width: f64, side: Side) -> Option<Spot> {
        let directions = match side {
            Side::Above => ABOVE.to_vec(),
            Side::Below => ABOVE.map(|(right, down)| (right, -down)).to_vec(),
            Side::Right => BESIDE.to_vec(),
            Side::Level => LEVEL.to_vec(),
        };
        let near = DISTANCES.iter().filter(|(distance, _)| *distance < self.reach);
        let spots = near.flat_map(|&(distance, penalty)| {
            let slopes = if distance < FAR { &SLOPES[..1] } else { &SLOPES };
            let places =
                directions.iter().flat_map(move |side| slopes.iter().map(move |slope| (*side, slope * distance)));
            let near = places.filter(move |(side, rise)| (side.0 * distance).hypot(side.1 * rise) <= LONGEST);
            near.map(move |(side, rise)| (self.spot(point, width, side, (distance, rise)), penalty))
        });
        let free = spots.filter(|(spot, _)| self.is_free(spot, point));
        let own = self.strands.through(point);
        let is_elsewhere = |spot: &Spot| !spot.has_leader && self.strands.is_elsewhere(&spot.area, point, &own);
        let rated = free.map(|(spot, far)| {
            let is_over_faint = self.faint.count(&spot.area) > 0;
            let far = far + if is_elsewhere(&spot) { ELSEWHERE } else { 0 } + if is_over_faint { FAINT } else { 0 };
            (self.curves.count(&spot.area), far, spot)
        });
        let clear = rated.filter(|(covered, ..)| *covered <= COVERED);
        clear.min_by_key(|(covered, far, _)| CROSSING * covered + far).map(|(.., spot)| spot)
    }

    /// Beside a point, right and down of it as `side` says, at distances for texts of [`TEXT`].
    fn spot(&self, point: Point, width: f64, side: (f64, f64), distances: (f64, f64)) -> Spot {
        let (scale, height) = (self.field.text / TEXT, LINE * self.field.text);
        let offset = (side.0 * distances.0 * scale, side.1 * distances.1 * scale);
        let left = point.0 + offset.0 + 0.5 * (side.0 - 1.0) * width;
        let top = point.1 + offset.1 + 0.5 * (side.1 - 1.0) * height;
        Spot {
            anchor: (-side.0 as i8, -side.1 as i8),
            offset,
            has_leader: offset.0.hypot(offset.1) > FAR * scale,
            area: Rect { left, top, right: left + width, bottom: top + height },
        }
    }

    /// Whether a label may be here, with the line that leads to its point.
    fn is_free(&self, spot: &Spot, point: Point) -> bool {
        let area = &spot.area;
        let is_across = area.left >= EDGE && area.right <= self.field.width - EDGE;
        let is_within = is_across && area.top >= 1.0 && area.bottom <= self.field.height - 1.0;
        let is_taken = |other: &Rect| area.overlaps(other) || way(spot, point).iter().any(|p| other.holds(p));
        let is_crossed = |other: &Line| leader(spot, point).is_some_and(|own| cross(own, *other));
        let is_apart = !self.leaders.iter().any(|p| area.holds(p)) && !self.lines.iter().any(is_crossed);
        is_within && is_apart && !self.taken.iter().any(is_taken)
    }
}

impl Spot {
    /// The anchor as Bokeh names it.
    pub fn anchor_name(&self) -> &'static str {
        match self.anchor {
            (-1, -1) => "top_left",
            (0, -1) => "top_center",
            (1, -1) => "top_right",
            (-1, 0) => "center_left",
            (1, 0) => "center_right",
            (-1, _) => "bottom_left",
            (1, _) => "bottom_right",
            (_, 1) => "bottom_center",
            _ => "center_center",
        }
    }
}

/// How many points of curves are left and above of the corners of cells.
#[derive(Debug, Clone)]
struct Cells {
    columns: usize,
    rows: usize,
    sums: Vec<u32>,
}

impl Cells {
    fn new(points: impl Iterator<Item = Point>, field: Field) -> Self {
        let columns = (field.width / STEP).ceil().max(1.0) as usize;
        let rows = (field.height / STEP).ceil().max(1.0) as usize;
        let mut sums = vec![0; (columns + 1) * (rows + 1)];
        for (x, y) in points {
            let (column, row) = ((x / STEP).floor(), (y / STEP).floor());
            if (0.0..columns as f64).contains(&column) && (0.0..rows as f64).contains(&row) {
                sums[(row as usize + 1) * (columns + 1) + column as usize + 1] += 1;
            }
        }
        for row in 1..=rows {
            let mut along = 0;
            for column in 1..=columns {
                along += sums[row * (columns + 1) + column];
                sums[row * (columns + 1) + column] = along + sums[(row - 1) * (columns + 1) + column];
            }
        }
        Self { columns, rows, sums }
    }

    /// How many points are in the cells that a rectangle covers.
    fn count(&self, area: &Rect) -> usize {
        let column = |x: f64| (x / STEP).clamp(0.0, self.columns as f64) as usize;
        let row = |y: f64| (y / STEP).clamp(0.0, self.rows as f64) as usize;
        let (left, right) = (column(area.left), column((area.right + STEP).floor()).max(column(area.left)));
        let (top, bottom) = (row(area.top), row((area.bottom + STEP).floor()).max(row(area.top)));
        let sum = |row: usize, column: usize| self.sums[row * (self.columns + 1) + column] as usize;
        sum(bottom, right) + sum(top, left) - sum(top, right) - sum(bottom, left)
    }
}

fn is_somewhere(point: &Point) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// The line that leads from a label to its point, if there is one.
fn leader(spot: &Spot, point: Point) -> Option<Line> {
    spot.has_leader.then_some([point, (point.0 + spot.offset.0, point.1 + spot.offset.1)])
}

/// Points of the line that leads from a label to its point, up to the mark there.
fn way(spot: &Spot, point: Point) -> Vec<Point> {
    let distance = spot.offset.0.hypot(spot.offset.1);
    let count = if spot.has_leader { ((distance - END) / STEP).max(0.0) as usize } else { 0 };
    let at = |i: usize| 1.0 - i as f64 * STEP / distance;
    (1..count).map(|i| (point.0 + at(i) * spot.offset.0, point.1 + at(i) * spot.offset.1)).collect()
}

/// What a mark covers.
fn around((x, y): Point, half: f64) -> Rect {
    Rect { left: x - half, top: y - half, right: x + half, bottom: y + half }
}

fn place((right, up): (f64, f64), field: Field) -> Point {
    (right * field.width, (1.0 - up) * field.height)
}

/// Points along the visible part of a curve.
fn dense(curve: &[(f64, f64)], field: Field) -> Vec<Point> {
    let is_near = |share: &(f64, f64)| (-0.5..=1.5).contains(&share.0) && (-0.5..=1.5).contains(&share.1);
    let mut points = Vec::new();
    for pair in curve.windows(2).filter(|pair| is_near(&pair[0]) && is_near(&pair[1])) {
        let (a, b) = (place(pair[0], field), place(pair[1], field));
        let steps = ((b.0 - a.0).abs().max((b.1 - a.1).abs()) / STEP).ceil();
        // What is shorter than a step counts for as much of one.
        if steps <= 1.0 {
            let is_new = points.last().is_none_or(|last: &Point| (a.0 - last.0).hypot(a.1 - last.1) >= 0.5 * STEP);
            points.extend(is_new.then_some(a));
            continue;
        }
        let at = |i: usize| i as f64 / steps;
        points.extend((0..steps as usize).map(|i| (a.0 + at(i) * (b.0 - a.0), a.1 + at(i) * (b.1 - a.1))));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: Field = Field { width: 300.0, height: 200.0, text: 10.0 };

    #[test]
    fn labels_keep_off_each_other_marks_and_curves() {
        let curve: Vec<(f64, f64)> = (0..=10).map(|i| (f64::from(i) / 10.0, 0.5)).collect();
        let curve = Obstacle { points: curve, may_have_label: true, is_faint: false };
        let mut room = Room::new(FIELD, true, &[curve], &[Mark { at: (0.5, 0.5), size: 6.0 }]);
        let spots: Vec<Spot> = (0..4).map_while(|_| room.take((0.5, 0.5), 60.0, Side::Above)).collect();
        assert_eq!(spots.len(), 4);
        assert!(!spots[0].has_leader, "{:?}", spots[0]);
        for (i, spot) in spots.iter().enumerate() {
            assert!(spots[..i].iter().all(|other| !other.area.overlaps(&spot.area)), "{spots:?}");
            assert!(spot.area.bottom <= 100.0 || spot.area.top >= 100.0, "{spot:?} is on the curve");
            assert!(!spot.area.overlaps(&around((150.0, 100.0), 3.0)), "{spot:?} is on the mark");
        }
    }

    /// However near to each other their points are.
    #[test]
    fn lines_of_labels_do_not_cross() {
        let points: Vec<(f64, f64)> =
            (0..8).map(|i| (0.4 + 0.02 * f64::from(i), 0.5 + 0.1 * f64::from(i % 3))).collect();
        let marks: Vec<Mark> = points.iter().map(|&at| Mark { at, size: 6.0 }).collect();
        let mut room = Room::new(FIELD, true, &[], &marks);
        let take = |&at| Some(leader(&room.take(at, 40.0, Side::Above)?, place(at, FIELD)));
        let found: Vec<Option<Line>> = points.iter().filter_map(take).collect();
        let lines: Vec<Line> = found.iter().copied().flatten().collect();
        assert!(found.len() > 5 && lines.len() > 2, "{found:?}");
        let is_crossed = |line: &Line| lines.iter().any(|other| cross(*line, *other));
        assert!(!lines.iter().any(is_crossed), "{lines:?}");
    }

    /// Between two curves a label is beside its own, or a line leads there.
    #[test]
    fn labels_are_nearest_to_their_curves() {
        let curve = |up: f64| {
            let points = (0..=10).map(|i| (f64::from(i) / 10.0, up)).collect();
            Obstacle { points, may_have_label: true, is_faint: false }
        };
        let spot = |others: &[f64]| {
            let curves: Vec<Obstacle> = others.iter().chain(&[0.5]).map(|&up| curve(up)).collect();
            Room::new(FIELD, true, &curves, &[]).take((0.5, 0.5), 60.0, Side::Above).unwrap()
        };
        // Another one is 16 px above the own one: the text between is nearer to it.
        let (alone, between) = (spot(&[]), spot(&[0.58]));
        assert!(alone.area.bottom <= 100.0 && !alone.has_leader, "{alone:?}");
        assert!(between.area.top >= 100.0, "{between:?}");
        assert!(spot(&[0.58, 0.42]).has_leader);
    }

    /// Where lines across leave no room between them, labels lie over those that are faint, and over no others.
    #[test]
    fn labels_lie_over_faint_lines_if_they_have_to() {
        let line = |up: f64, is_faint| Obstacle { points: vec![(0.0, up), (1.0, up)], may_have_label: false, is_faint };
        let spot = |is_faint, step: f64| {
            let lines: Vec<Obstacle> = (1..20).map(|i| line(step * f64::from(i), is_faint)).collect();
            Room::new(FIELD, true, &lines, &[]).take((0.5, 0.52), 60.0, Side::Below)
        };
        assert!(spot(false, 0.05).is_none());
        assert!(spot(true, 0.05).is_some_and(|spot| !spot.has_leader));
        // Between lines that are far apart there is room without.
        let area = spot(true, 0.25).unwrap().area;
        assert!((1..4).all(|i| !(area.top..area.bottom).contains(&(50.0 * f64::from(i)))), "{area:?}");
    }

    #[test]
    fn labels_stay_inside() {
        let mut room = Room::new(FIELD, true, &[], &[]);
        let spot = room.take((1.0, 1.0), 60.0, Side::Above).unwrap();
        assert!(spot.area.right <= 300.0 && spot.area.top >= 0.0, "{spot:?}");
        assert!(room.take((0.5, 0.5), 400.0, Side::Above).is_none());
        assert!(room.take((f64::NAN, 0.5), 40.0, Side::Above).is_none());
        assert!(room.take((1e300, -1e300), 40.0, Side::Above).is_none());
    }
}
