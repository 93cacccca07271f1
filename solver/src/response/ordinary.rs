//! What grows out of the linear response, and what is left of a walk between responses like that.

use crate::curve::continuation::Continuation;
use crate::curve::newton::{Constraint, Newton, NewtonSettings};
use crate::curve::problem::Failure;
use crate::curve::walk::{begin_at_bound, end_at_bound, relative_distance};
use crate::formulation::Formulation;
use crate::formulation::linear::forced_response;
use crate::formulation::state::State;
use crate::response::branch::{Outcome, Side, Stop, TracedPoint};
use crate::settings::FrequencySettings;

/// Relative distance of a response from the linear one up to which it counts as linear.
pub(super) const LINEAR: f64 = 1e-3;

/// Relative distance of a response from the linear one up to which it counts as the ordinary response, if Newton's method leads
/// there from the linear one.
const ORDINARY: f64 = 0.3;

/// See [`crate::response::forced::Forced::converge`].
pub(super) fn converge<'m, F: Formulation<'m>>(
    problem: &mut F,
    settings: &NewtonSettings,
    state: &State,
) -> Result<State, Failure> {
    let mut y = problem.encode(state);
    let origin = y.clone();
    let row = problem.parameter_row();
    let constraint = Constraint::Hyperplane { row: &row, origin: &origin };
    Newton::default().solve(problem, &mut y, constraint, settings)?;
    problem.decode(&y).map_err(|_| Failure::Singular)
}

/// See [`crate::response::forced::Forced::distance`].
pub(super) fn distance<'m, F: Formulation<'m>>(problem: &F, a: &State, b: &State) -> f64 {
    let (from, target) = (problem.encode(a), problem.encode(b));
    (0..problem.images())
        .map(|index| relative_distance(problem.motion_metric(), &problem.image(&from, index), &target))
        .fold(f64::INFINITY, f64::min)
}

/// Relative distance of a response from the linear one, and that; `None` at an undamped resonance.
fn away_from_linear<'m, F: Formulation<'m>>(problem: &F, state: &State) -> Option<(f64, State)> {
    let linear = forced_response(problem, state.forcing, state.omega).ok()?;
    Some((distance(problem, state, &linear), linear))
}

/// Whether a response is the linear one, nearly.
fn is_linear<'m, F: Formulation<'m>>(problem: &F, state: &State) -> bool {
    away_from_linear(problem, state).is_some_and(|(away, _)| away < LINEAR)
}

/// See [`crate::response::forced::Forced::is_ordinary`].
pub(super) fn is_ordinary<'m, F: Formulation<'m>>(problem: &mut F, settings: &NewtonSettings, state: &State) -> bool {
    let Some((away, linear)) = away_from_linear(problem, state) else { return false };
    away < LINEAR
        || (away < ORDINARY
            && converge(problem, settings, &linear).is_ok_and(|found| distance(problem, &found, state) < 1e-6))
}

/// Where a main branch leaves the frequencies swept for good: with the ordinary response, as far beyond them as its own resonance
/// has led it before, unless a bound was given on that side.
pub(super) struct Departure {
    swept: (f64, f64),
    given: FrequencySettings,
    /// The frequencies that it has been at since it has entered those swept, and these.
    reached: (f64, f64),
    has_entered: bool,
    points: usize,
    /// The first point of the ordinary response beyond the frequencies swept, and which way it goes from there.
    first: Option<(usize, f64)>,
}

impl Departure {
    /// From frequencies swept, with the bounds that were given.
    pub(super) fn new(swept: (f64, f64), given: FrequencySettings) -> Self {
        Self { swept, given, reached: swept, has_entered: false, points: 0, first: None }
    }

    /// Whether it leaves at the point that a walk has stepped to; asked of every one.
    pub(super) fn is_final<'m, F: Formulation<'m>>(
        &mut self,
        problem: &mut F,
        newton: &NewtonSettings,
        last: &TracedPoint,
    ) -> bool {
        let (omega, towards) = (last.point.omega(), last.curve.tangent[problem.len() - problem.parameters()]);
        self.points += 1;
        self.has_entered |= (self.swept.0..=self.swept.1).contains(&omega);
        // One that turns before it has come into the range may yet do so.
        if !self.has_entered {
            return false;
        }
        let leaves = |(low, high): (f64, f64)| (omega < low && towards < 0.0) || (omega > high && towards > 0.0);
        let (is_beyond, is_farthest) = (leaves(self.swept), leaves(self.reached));
        if self.given.min.is_none() {
            self.reached.0 = self.reached.0.min(omega);
        }
        if self.given.max.is_none() {
            self.reached.1 = self.reached.1.max(omega);
        }
        self.first = self.first.filter(|(_, way)| way * towards > 0.0);
        let is_asked = is_farthest || (is_beyond && self.first.is_none());
        let is_ordinary = is_asked && is_ordinary(problem, newton, &last.point.state);
        self.first = self.first.or(is_ordinary.then_some((self.points, towards)));
        is_farthest && is_ordinary
    }

    /// How a walk ends that stopped so: one that has not come as far beyond ends with the first point of the ordinary response there.
    pub(super) fn settled(&self, visited: &mut Vec<TracedPoint>, stop: Stop) -> Stop {
        match (self.first, stop) {
            (Some((index, _)), Stop::PointBudget | Stop::Stalled(_) | Stop::AmplitudeBound) => {
                visited.truncate(index + 1);
                Stop::FrequencyBound
            }
            _ => stop,
        }
    }
}

/// The frequencies of a study, and which of their bounds were given.
pub(super) struct Study {
    /// Lowest and highest, rad/s.
    pub(super) frequency: (f64, f64),
    pub(super) given: FrequencySettings,
}

/// What of a walk from a side that ended so belongs to a main branch, and how that begins and ends: what lies within the study's
/// frequencies, or within those up to which its own resonance leads where no bound was given, and on to the ordinary response.
pub(super) fn main_part<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    newton: &NewtonSettings,
    (visited, stop): (Vec<TracedPoint>, Stop),
    side: Side,
    Study { frequency: (low, high), given }: Study,
) -> (Vec<TracedPoint>, Outcome) {
    let is_given = |omega: f64| (given.min.is_some() && omega < low) || (given.max.is_some() && omega > high);
    let mut is_spare = |problem: &mut F, end: &TracedPoint| {
        is_given(end.point.omega()) || is_ordinary(problem, newton, &end.point.state)
    };
    let (first_turn, last_turn) = turns(&visited);
    let lowest = if given.min.is_some() { low } else { low.min(first_turn) };
    let highest = if given.max.is_some() { high } else { high.max(last_turn) };
    let grows = is_ordinary(continuation.problem(), newton, &visited[0].point.state);
    let (kept, is_cut) = trimmed(continuation, visited, (lowest, highest), stop, &mut is_spare);
    let is_bound_given = if side == Side::Below { given.min.is_some() } else { given.max.is_some() };
    // At a bound that was given the response may be another one than where it began.
    let begins_ordinarily = match is_cut && is_bound_given {
        true => is_ordinary(continuation.problem(), newton, &kept[0].point.state),
        false => grows,
    };
    let first = &kept[0].point;
    let touches = first.contact().iter().any(|&share| share > 0.0);
    let is_linear = !touches && is_linear(continuation.problem(), &first.state);
    let begin = match (begins_ordinarily, is_cut) {
        (true, _) if is_linear => Stop::Start,
        (true, _) | (_, true) => Stop::FrequencyBound,
        (false, false) => Stop::Rest,
    };
    (kept, Outcome::Open(begin, stop))
}

/// Whether what lies beyond a range may be left out of a branch that ends with this point there.
type IsSpare<'s, F> = dyn FnMut(&mut F, &TracedPoint) -> bool + 's;

/// What is left of a walk that ended so if it begins where it first enters a range of frequencies and ends where it last leaves
/// it, with points at the bounds themselves. A walk that is never inside keeps its ends, and so does one that does not leave, or
/// of which what lies beyond may not be left out. Told as well whether its beginning was left out.
fn trimmed<'m, F: Formulation<'m>>(
    continuation: &mut Continuation<'_, F>,
    mut visited: Vec<TracedPoint>,
    (low, high): (f64, f64),
    stop: Stop,
    is_spare: &mut IsSpare<'_, F>,
) -> (Vec<TracedPoint>, bool) {
    let slack = 1e-9 * high;
    let inside = |v: &TracedPoint| (low - slack..=high + slack).contains(&v.point.omega());
    let (Some(first), Some(last)) = (visited.iter().position(inside), visited.iter().rposition(inside)) else {
        return (visited, false);
    };
    let (begin, end) = (&visited[..=first], &visited[last..]);
    let begins = first > 0 && is_spare(continuation.problem(), &begin[0]);
    let ends = stop == Stop::FrequencyBound && end.len() > 1 && is_spare(continuation.problem(), &end[end.len() - 1]);
    if ends {
        visited.truncate(last + 2);
        end_at_bound(continuation, &mut visited, (low, high));
    }
    if begins {
        visited.drain(..first - 1);
        begin_at_bound(continuation, &mut visited, (low, high));
    }
    (visited, begins)
}

/// Lowest and highest frequency at which a curve turns back; infinite and zero if it does not.
fn turns(visited: &[TracedPoint]) -> (f64, f64) {
    let omega: Vec<f64> = visited.iter().map(|v| v.point.omega()).collect();
    let turning = omega.windows(3).filter(|three| (three[1] > three[0]) != (three[2] > three[1])).map(|three| three[1]);
    turning.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), omega| (low.min(omega), high.max(omega)))
}
