//! Where along a branch contact begins and ends.
//!
//! Next to there the share of the period in contact is as the root of the height of the argument over its threshold (see
//! `formulation::pressure::touch`), which is smooth along the branch: the square of the share goes to zero as a straight line does. On the
//! side without contact it tells nothing.

use crate::curve::continuation::{Continuation, ContinuationSettings};
use crate::curve::problem::weighted;
use crate::curve::walk::Evaluated;
use crate::formulation::Formulation;
use crate::response::branch::BranchPoint;

/// A point that touches for no larger share of the period is taken for the one where contact begins or ends.
const GRAZING: f64 = 1e-4;

/// Share of the estimated way to there by which a point stays on the side with contact.
const KEPT: f64 = 1e-3;

/// Share of what is left of a way at which it is looked at, and by which that is less where Newton's method fails.
const HALF: f64 = 0.5;

/// A place is looked for until the way is known to this share of a step, or so many points were looked at.
const NARROW: f64 = 1e-8;
const MOST: usize = 40;

/// Lowest and highest frequency at which any contact of a branch touches, rad/s, its beginnings and ends between points located; `None` if
/// none does.
pub(super) fn contact_range<'m, F: Formulation<'m>>(
    problem: &mut F,
    settings: ContinuationSettings,
    points: &[BranchPoint],
    is_closed: bool,
) -> Option<(f64, f64)> {
    let count = points.len();
    let steps = if is_closed { count } else { count.saturating_sub(1) };
    let is_touching = |point: &BranchPoint| share(point) > 0.0;
    let ends = (0..steps).filter_map(|from| {
        let [from, to] = [from, (from + 1) % count].map(|index| &points[index]);
        match (is_touching(from), is_touching(to)) {
            (true, false) => Some([from, to]),
            (false, true) => Some([to, from]),
            _ => None,
        }
    });
    let located = ends.filter_map(|end| last(problem, settings, end));
    let touching = points.iter().filter(|point| is_touching(point)).map(BranchPoint::omega);
    let frequencies = located.chain(touching).map(|omega| (omega, omega));
    frequencies.reduce(|(low, high), (omega, _)| (low.min(omega), high.max(omega)))
}

/// Largest share of the period in contact of all contacts.
fn share(point: &BranchPoint) -> f64 {
    point.contact().iter().copied().fold(0.0, f64::max)
}

/// The frequency of the last point that touches on the way from one that does to its neighbour that does not; `None` if the first one is it,
/// or the way is lost at once.
fn last<'m, F: Formulation<'m>>(
    problem: &mut F,
    settings: ContinuationSettings,
    [from, to]: [&BranchPoint; 2],
) -> Option<f64> {
    let [from_y, to_y] = [from, to].map(|point| problem.encode(&point.state));
    let way: Vec<f64> = to_y.iter().zip(&from_y).map(|(to, from)| to - from).collect();
    let row = weighted(problem.metric(), &way);
    let mut continuation = Continuation::start(problem, from_y.clone(), &way, settings).ok()?;
    // Places as shares of the way, with the squares there.
    let mut before = None;
    let mut low = (0.0, share(from).powi(2));
    let (mut high, mut found) = (1.0, None);
    // How far towards the other side is looked, and from which motion: the nearest one that touches.
    let (mut ahead, mut near) = (HALF, from_y.clone());
    for _ in 0..MOST {
        if low.1 < GRAZING * GRAZING || high - low.0 < NARROW {
            break;
        }
        let zero = before.map(|(at, square): (f64, f64)| low.0 + low.1 * (low.0 - at) / (square - low.1));
        let zero = zero.filter(|zero| *zero > low.0 && *zero < high).map(|zero| zero - KEPT * (zero - low.0));
        let at = zero.filter(|_| ahead == HALF).unwrap_or(low.0 + ahead * (high - low.0));
        let y: Vec<f64> = near.iter().zip(&way).map(|(y, way)| y + (at - low.0) * way).collect();
        let curve = continuation.correct_on(y, &row).ok();
        let problem = continuation.problem();
        let Some(curve) = curve.filter(|curve| problem.are_neighbours(&from_y, &curve.y)) else {
            ahead *= HALF;
            continue;
        };
        let point = BranchPoint::evaluate(problem, &curve);
        match share(&point).powi(2) {
            0.0 => high = at,
            square => {
                before = Some(std::mem::replace(&mut low, (at, square)));
                (found, near) = (Some(point.omega()), curve.y);
            }
        }
        ahead = HALF;
    }
    found
}
