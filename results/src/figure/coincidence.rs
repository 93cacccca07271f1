//! Branches whose curves lie on each other: mirror images of the motions of a symmetric structure have the same amplitudes. They are drawn
//! once, under the names of all of them; else one's solid line would fill the other's dashes.

use super::data::Series;
use crate::curves::Curve;
use crate::words::listed;

/// No point of either curve is farther from the other, as a share of its width and height: less than lines are wide.
const SAME: f64 = 5e-3;

/// Which branches lie on each other, for every axis up.
#[derive(Debug, Clone)]
pub struct Coincidence {
    /// For each axis the number of the first branch that each branch lies on: its own where there is none.
    firsts: Vec<Vec<usize>>,
}

impl Coincidence {
    /// Of branches, for so many monitored dofs.
    pub fn of(branches: &[&Curve], monitors: usize) -> Self {
        let firsts = |m: usize| {
            let mut firsts: Vec<usize> = Vec::new();
            for (i, branch) in branches.iter().enumerate() {
                let is_beneath = |&k: &usize| firsts[k] == k && is_same(branches[k], branch, m);
                firsts.push((0..i).find(is_beneath).unwrap_or(i));
            }
            firsts
        };
        Self { firsts: (0..monitors).map(firsts).collect() }
    }

    /// Whether a branch lies on an earlier one, on this axis.
    pub fn is_hidden(&self, branch: usize, axis: usize) -> bool {
        self.firsts[axis][branch] != branch
    }

    /// The branches that a branch lies on, on any axis.
    pub fn beneath(&self, branch: usize) -> Vec<usize> {
        let mut beneath: Vec<usize> = self.firsts.iter().map(|firsts| firsts[branch]).collect();
        beneath.sort_unstable();
        beneath.dedup();
        beneath.retain(|&first| first != branch);
        beneath
    }

    /// The names of all that lie on a branch, one for each axis: `isola 1 and 2`.
    pub fn names(&self, branches: &[&Curve], branch: usize) -> Vec<String> {
        let of_axis = |firsts: &Vec<usize>| {
            let all: Vec<&Curve> = (0..branches.len()).filter(|&i| firsts[i] == branch).map(|i| branches[i]).collect();
            let mut numbers: Vec<usize> = all.iter().map(|curve| curve.number).collect();
            numbers.sort_unstable();
            match numbers.len() {
                0 | 1 => branches[branch].name.clone(),
                _ => {
                    let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
                    format!("{} {}", branches[branch].kind, listed(&numbers))
                }
            }
        };
        self.firsts.iter().map(of_axis).collect()
    }

    /// A series of a branch, which is not drawn on axes where the branch lies on an earlier one.
    pub fn veiled(&self, branch: usize, series: Series) -> Series {
        let hidden: Vec<bool> = (0..self.firsts.len()).map(|axis| self.is_hidden(branch, axis)).collect();
        if hidden.contains(&true) { Series { hidden, ..series } } else { series }
    }
}

/// Whether two branches of a level are of a kind and lie on each other.
fn is_same(one: &Curve, other: &Curve, axis: usize) -> bool {
    if (one.level, one.kind, one.closed) != (other.level, other.kind, other.closed) {
        return false;
    }
    let points = |curve: &Curve| -> Vec<Point> {
        let heights = curve.amplitude.get(axis).map_or(&[][..], |column| &column.values);
        let places = (0..curve.size.min(heights.len())).chain((curve.closed && !heights.is_empty()).then_some(0));
        places.map(|i| (curve.omega.values[i], heights[i])).collect()
    };
    let curves = [points(one), points(other)];
    let [Some(frame), Some(of_other)] = curves.each_ref().map(|points| Frame::around(points)) else { return false };
    // Most are told apart by their ends.
    let corners = [frame.share(of_other.low), frame.share(of_other.high)];
    let is_near = |(corner, place): (Point, f64)| (corner.0 - place).abs() <= SAME && (corner.1 - place).abs() <= SAME;
    let [one, other] = curves.map(|points| points.into_iter().map(|point| frame.share(point)).collect::<Vec<Point>>());
    corners.into_iter().zip([0.0, 1.0]).all(is_near) && is_along(&one, &other) && is_along(&other, &one)
}

type Point = (f64, f64);

/// What a curve takes up.
struct Frame {
    low: Point,
    high: Point,
}

impl Frame {
    /// `None` if there is nothing to be seen.
    fn around(points: &[Point]) -> Option<Self> {
        let (left, right) = super::axis::bounds(points.iter().map(|point| point.0));
        let (low, high) = super::axis::bounds(points.iter().map(|point| point.1));
        (right > left && high > low).then_some(Self { low: (left, low), high: (right, high) })
    }

    fn share(&self, point: Point) -> Point {
        let (width, height) = (self.high.0 - self.low.0, self.high.1 - self.low.1);
        ((point.0 - self.low.0) / width, (point.1 - self.low.1) / height)
    }
}

/// Whether all of these points are on a curve, straight from each of its points to the next.
fn is_along(points: &[Point], curve: &[Point]) -> bool {
    let is_on = |&(x, y): &Point, ends: &[Point]| {
        let (step, offset) = ((ends[1].0 - ends[0].0, ends[1].1 - ends[0].1), (x - ends[0].0, y - ends[0].1));
        let square = step.0.hypot(step.1).powi(2).max(f64::MIN_POSITIVE);
        let share = ((offset.0 * step.0 + offset.1 * step.1) / square).clamp(0.0, 1.0);
        (offset.0 - share * step.0).hypot(offset.1 - share * step.1) <= SAME
    };
    points.iter().all(|point| curve.windows(2).any(|ends| is_on(point, ends)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::Column;

    /// An isola of so many points, at two monitored dofs: the second one is larger by this factor.
    fn isola(number: usize, points: usize, factor: f64) -> Curve {
        let angles = (0..points).map(|i| std::f64::consts::TAU * (i as f64 + 0.3 * number as f64) / points as f64);
        let (omega, height): (Vec<f64>, Vec<f64>) = angles.map(|angle| (10.0 + angle.cos(), 2.0 + angle.sin())).unzip();
        let second = height.iter().map(|height| factor * height).collect();
        Curve {
            kind: "isola",
            number,
            name: format!("isola {number}"),
            closed: true,
            size: points,
            omega: Column::exact(omega),
            amplitude: vec![Column::exact(height), Column::exact(second)],
            level: 0,
            status: String::new(),
            task: String::new(),
            worker: String::new(),
            seconds: 0.0,
            rejections: 0,
            peak_standing: None,
            unstable: Vec::new(),
            stable: Vec::new(),
            beyond: Vec::new(),
            others: Vec::new(),
            special: Vec::new(),
            peak: 0,
            omega_at_peak: 0.0,
            amplitude_at_peak: 0.0,
        }
    }

    #[test]
    fn images_are_one_curve_where_their_amplitudes_are_the_same() {
        let other_level = Curve { level: 1, ..isola(4, 80, 1.0) };
        let branches = [isola(1, 90, 1.0), isola(2, 70, 1.1), isola(3, 80, 1.0), other_level];
        let branches: Vec<&Curve> = branches.iter().collect();
        let same = Coincidence::of(&branches, 2);
        let hidden = |axis| (0..4).map(|i| same.is_hidden(i, axis)).collect::<Vec<_>>();
        assert_eq!([hidden(0), hidden(1)], [[false, true, true, false], [false, false, true, false]]);
        assert_eq!([0, 1, 2].map(|branch| same.beneath(branch)), [vec![], vec![0], vec![0]]);
        assert_eq!(same.names(&branches, 0), ["isola 1, 2 and 3", "isola 1 and 3"]);
        assert_eq!(same.names(&branches, 3), ["isola 4", "isola 4"]);
        let veiled = |branch| same.veiled(branch, Series::default());
        assert_eq!(
            [veiled(0), veiled(1), veiled(2)].map(|series| [0, 1].map(|axis| series.is_drawn(axis))),
            [[true; 2], [false, true], [false; 2]]
        );
    }
}
