//! A backbone beyond a tongue: where a harmonic of its motion meets another mode, a backbone may end in motions of that mode alone, at a
//! multiple of its frequency, and begin anew on these elsewhere (G. Kerschen, M. Peeters, J. C. Golinval & A. F. Vakakis, Mech. Syst.
//! Signal Process. 23, 170–194, 2009).

use super::LEADS;
use super::known::Known;
use super::way::Way;
use crate::curve::continuation::Continuation;
use crate::curve::problem::inner;
use crate::curve::walk::{Bounds, TracedCurve, both_ways, walk};
use crate::formulation::Formulation;
use crate::response::branch::{BranchPoint, Observer, Outcome, Stop, TracedPoint};
use crate::response::columns::shares;
use crate::response::symmetry::up_to_branch_point;

/// How many times as large as the motion from which the tongue leaves those are with which it is looked for beyond, in this order.
const LARGER: [f64; 7] = [1.25, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0];

/// Most tongues that are left behind.
const MOST: usize = 4;

/// Where a backbone goes on that ends at a branch point, or in a tongue that was not walked to its end, and where that does if it ends so too:
/// curves walked both ways from motions that are larger than all before and alike. None where no such motion is found.
pub(super) fn beyond_tongues<'m, F: Formulation<'m>>(
    problem: &mut F,
    way: &Way<'_>,
    first: &TracedCurve<BranchPoint>,
    observer: &mut Observer<'_>,
) -> Vec<TracedCurve<BranchPoint>> {
    let mut beyond: Vec<TracedCurve<BranchPoint>> = Vec::new();
    while beyond.len() < MOST {
        let last = beyond.last().unwrap_or(first);
        if !way.ends_in_tongue(problem, last) {
            break;
        }
        let linear = &first.visited[0].curve.y;
        let share = |visited: &&TracedPoint| inner(problem.motion_metric(), &visited.curve.y, linear).abs();
        let Some(before) = last.visited.iter().max_by(|a, b| share(a).total_cmp(&share(b))) else { break };
        let mut known = Known::new(first, beyond.iter(), way.settings.continuation.newton);
        let next = LARGER.into_iter().find_map(|factor| {
            let found = way.larger(problem, &before.point.state, factor)?;
            (way.is_of_interest(problem, &found) && !known.has(problem, &found)).then_some(found)
        });
        let Some(next) = next else { break };
        let Some(next) = way.both_ways(problem, next, observer) else { break };
        beyond.push(next);
    }
    beyond
}

impl Way<'_> {
    /// Whether a curve ends at a branch point or, not walked to its end, where another mode leads.
    fn ends_in_tongue<'m, F: Formulation<'m>>(&self, problem: &mut F, curve: &TracedCurve<BranchPoint>) -> bool {
        let Outcome::Open(_, stop) = curve.outcome else { return false };
        let mode = self.settings.tracked(problem.model());
        let mut leads = |end: &TracedPoint| shares(problem.aft(), &end.point.state)[mode] > LEADS;
        match stop {
            Stop::Branching => true,
            Stop::PointBudget | Stop::Stalled(_) | Stop::Reversed => {
                curve.visited.last().is_some_and(|end| !leads(end))
            }
            _ => false,
        }
    }

    /// Both ways from a point, towards larger motions last.
    fn both_ways<'m, F: Formulation<'m>>(
        &self,
        problem: &mut F,
        y: Vec<f64>,
        observer: &mut Observer<'_>,
    ) -> Option<TracedCurve<BranchPoint>> {
        let direction = problem.growth(&y);
        let bounds = Bounds { closes: true, ..self.bounds };
        let mut one_way = |continuation: &mut Continuation<'_, F>| {
            up_to_branch_point(continuation, |continuation, branches_off| {
                let mut ending = |problem: &mut F, last: &TracedPoint| match branches_off(problem, last) {
                    None if self.is_beyond(problem, last) => Some(Stop::ForcingBound),
                    stop => stop,
                };
                walk(continuation, &bounds, observer, &mut ending)
            })
        };
        both_ways(problem, y, &direction, &self.settings.continuation, &mut one_way).ok()
    }
}
