//! Motions and their images: with every motion that has m periods of the forcing in its own, the same motion some periods of the
//! forcing later is a response; where all laws are odd, or one-sided ones come in pairs, so is its mirror image, half a period later.
//! Most motions are their own images; those that are not branch off them, or are isolas of their own.

use crate::curve::continuation::Continuation;
use crate::curve::problem::{Problem, SAME_IMAGE, inner, norm};
use crate::curve::sides::away;
use crate::curve::walk::{Ending, Evaluated, TracedPoint, relative_distance};
use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::{Branch, BranchKind, BranchPoint, Outcome, SpecialKind, Stop};
use crate::structure::Model;
use std::ops::Range;

/// Of the largest distance from an image along a branch, the share below which its end lies next to a motion that is its own image.
const NEXT_TO: f64 = 0.05;

/// The same share below which a curve turns because of that: with a motion its image is at the same frequency or forcing, which is
/// why they hardly change there.
const TURNS: f64 = 0.1;

/// Beyond a fold next to a branch point less than this is left of the distance from an image where the curve ends, and the change of the
/// frequency or forcing since is more than what rounding makes of it at a branch point.
const NEARER: f64 = 0.5;
const RESOLVED: f64 = 1e-7;

/// How many points from a branch point the turn may be found that it makes: Newton's method fails next to it.
const TURN: usize = 2;

/// Cosine between the differences of two neighbouring motions from their images, below which one in between is its own image.
const FLIPPED: f64 = -0.5;

/// Distance from the image by an exchange of equal parts, relative to the motion, from which on a motion is another one than its image.
const ASYMMETRIC: f64 = 1e-2;

/// The same below which it is the same. Newton's method knows motions next to branch points to the root of its tolerance.
const SYMMETRIC: f64 = 1e-3;

/// Least cosine between a probe and the tangent.
const AHEAD: f64 = 0.9;

/// Most probes for where exactly a walk has come to a motion that is its own image.
const HALVINGS: usize = 20;

/// One way of a curve, walked by `go` with what ends it where motions are met that are their own images; there, the points up to where
/// that is are told.
pub(super) fn up_to_branch_point<'c, P: Problem, T: Evaluated<P>>(
    continuation: &mut Continuation<'c, P>,
    go: impl FnOnce(&mut Continuation<'c, P>, &mut Ending<'_, P, T>) -> (Vec<TracedPoint<T>>, Stop),
) -> (Vec<TracedPoint<T>>, Stop) {
    let mut branch_points = BranchPoints::from(continuation);
    let mut ending =
        |problem: &mut P, last: &TracedPoint<T>| branch_points.meets(problem, &last.curve.y).then_some(Stop::Branching);
    let (mut visited, stop) = go(continuation, &mut ending);
    if stop == Stop::Branching {
        branch_points.resolve(continuation, &mut visited);
    }
    (visited, stop)
}

/// What tells a walk along motions that are not their own images that it has come to one that is: what follows is the same curve
/// again, its continuation if there are more than two images, or that which it branches off. Along folds, also that what they are folds
/// of branches off there: what follows is the curve's image by the symmetry that is lost, or the branch points, which solve the equations
/// of folds, too.
struct BranchPoints {
    /// Numbers of the images, and how far the last motion was from each.
    away: Vec<(usize, Vec<f64>)>,
    /// Whether the walk has been away from motions that are their own images by an exchange, of each.
    asymmetric: Vec<bool>,
}

impl BranchPoints {
    /// From the current point of a walk on.
    fn from<P: Problem>(continuation: &mut Continuation<'_, P>) -> Self {
        let y = continuation.current().y.clone();
        let problem = continuation.problem();
        let metric = problem.motion_metric();
        let list = (1..problem.images()).map(|index| (index, away(problem, &y, index)));
        let away = list.filter(|(_, away)| norm(metric, away) > SAME_IMAGE * norm(metric, &y)).collect();
        let mut branch_points = Self { away, asymmetric: Vec::new() };
        branch_points.asymmetric = problem.asymmetries(&y).iter().map(|asymmetry| *asymmetry > ASYMMETRIC).collect();
        branch_points
    }

    /// Whether the next motion, or one between it and the last, is its own image.
    fn meets<P: Problem>(&mut self, problem: &P, y: &[f64]) -> bool {
        let next: Vec<Vec<f64>> = self.away.iter().map(|(index, _)| away(problem, y, *index)).collect();
        let is_met = self.is_passed(problem, y, &next);
        let asymmetries = problem.asymmetries(y);
        self.asymmetric.iter_mut().zip(asymmetries).for_each(|(was, now)| *was |= now > ASYMMETRIC);
        self.away.iter_mut().zip(next).for_each(|((_, last), next)| *last = next);
        is_met
    }

    fn is_passed<P: Problem>(&self, problem: &P, y: &[f64], next: &[Vec<f64>]) -> bool {
        let metric = problem.motion_metric();
        let asymmetries = problem.asymmetries(y);
        let is_symmetric = self.asymmetric.iter().zip(asymmetries).any(|(was, now)| *was && now < SYMMETRIC);
        is_symmetric
            || self.away.iter().zip(next).any(|((_, last), next)| {
                let (length, before) = (norm(metric, next), norm(metric, last));
                length < SAME_IMAGE * norm(metric, y) || inner(metric, next, last) < FLIPPED * length * before
            })
    }

    /// Puts points up to a motion which is its own image instead of the last one of a walk, whose step has led past it, along what it
    /// branches off or along its own images.
    fn resolve<P: Problem, T: Evaluated<P>>(
        mut self,
        continuation: &mut Continuation<'_, P>,
        visited: &mut Vec<TracedPoint<T>>,
    ) {
        let [.., before, last] = &visited[..] else { return };
        let (mut from, end) = (before.curve.clone(), last.curve.y.clone());
        let piece: Vec<f64> = end.iter().zip(&from.y).map(|(end, from)| end - from).collect();
        let mut step = norm(continuation.problem().metric(), &piece);
        visited.pop();
        self.meets(continuation.problem(), &from.y);
        let mut beyond = None;
        for _ in 0..HALVINGS {
            step *= 0.5;
            let Ok(curve) = continuation.probe(&from, step) else { continue };
            let problem = continuation.problem();
            let next: Vec<Vec<f64>> = self.away.iter().map(|(index, _)| away(problem, &curve.y, *index)).collect();
            let moved: Vec<f64> = curve.y.iter().zip(&from.y).map(|(y, from)| y - from).collect();
            let cosine = inner(problem.metric(), &moved, &from.tangent) / norm(problem.metric(), &moved);
            let is_next = cosine > AHEAD && problem.are_neighbours(&from.y, &curve.y);
            if !is_next || self.is_passed(problem, &curve.y, &next) {
                let size = norm(problem.motion_metric(), &curve.y);
                let is_own = next.iter().any(|away| norm(problem.motion_metric(), away) < SAME_IMAGE * size);
                beyond = if is_next && !is_own { Some(curve) } else { beyond };
                continue;
            }
            self.away.iter_mut().zip(next).for_each(|((_, last), next)| *last = next);
            let point = T::evaluate(continuation.problem(), &curve);
            visited.push(TracedPoint { curve: curve.clone(), point });
            from = curve;
        }
        if let Some(curve) = beyond {
            let point = T::evaluate(continuation.problem(), &curve);
            visited.push(TracedPoint { curve, point });
        }
    }
}

fn mean(states: &[Vec<f64>]) -> Vec<f64> {
    let mut mean = vec![0.0; states.first().map_or(0, Vec::len)];
    for state in states {
        mean.iter_mut().zip(state).for_each(|(mean, entry)| *mean += entry / states.len() as f64);
    }
    mean
}

/// How far the states of a curve are from states that are their own images, as shares of the farthest; none where all are.
pub(super) struct Asymmetry {
    shares: Vec<f64>,
    /// Frequencies or forcing amplitudes, in which the curve turns.
    parameters: Vec<f64>,
    outcome: Outcome,
}

impl Asymmetry {
    /// Along a branch.
    pub(super) fn of<'m, F: Formulation<'m>>(problem: &F, branch: &Branch) -> Self {
        Self::along(problem, &branch.points, |state| state.omega, branch.outcome)
    }

    /// Along a curve through these points that ends so, over this parameter.
    pub(super) fn along<'m, F: Formulation<'m>>(
        problem: &F,
        points: &[BranchPoint],
        parameter: impl Fn(&State) -> f64,
        outcome: Outcome,
    ) -> Self {
        let metric = problem.motion_metric();
        let motions: Vec<Vec<f64>> = points.iter().map(|point| problem.encode(&point.state)).collect();
        let mut shares = vec![1.0_f64; motions.len()];
        for index in 1..problem.images() {
            let distance = |y: &Vec<f64>| relative_distance(metric, &problem.image(y, index), y);
            let distances: Vec<f64> = motions.iter().map(distance).collect();
            let largest = distances.iter().copied().fold(0.0, f64::max);
            if largest > SAME_IMAGE {
                shares.iter_mut().zip(distances).for_each(|(share, distance)| *share = share.min(distance / largest));
            }
        }
        let outcome = match (outcome, &shares[..]) {
            (Outcome::Open(first, last), [begins, .., ends]) => Outcome::Open(at(first, *begins), at(last, *ends)),
            _ => outcome,
        };
        let parameters = points.iter().map(|point| parameter(&point.state)).collect();
        Self { shares, parameters, outcome }
    }

    /// The point of a branch that is farthest from its images, if the one where it was entered lies next to one that is its own image:
    /// from there a walk leads along what it branches off as well, or along its own image.
    pub(super) fn farther(&self, branch: &Branch) -> Option<usize> {
        let entered = branch.special.iter().find(|special| special.kind == SpecialKind::Start)?;
        let farthest = (0..self.shares.len()).max_by(|&a, &b| self.shares[a].total_cmp(&self.shares[b]));
        farthest.filter(|_| self.shares[entered.index] < NEXT_TO)
    }

    /// How the curve ends: where continuation fails next to a motion that is its own image, it is that which it fails at.
    pub(super) fn outcome(&self) -> Outcome {
        self.outcome
    }

    /// How many points at the beginning, and at the end, lie next to a branch point there.
    fn next_to_branch_points(&self) -> [usize; 2] {
        let Outcome::Open(first, last) = self.outcome else { return [0; 2] };
        let is_next_to = |share: &&f64| **share < TURNS;
        let count = |stop: Stop, points: usize| if stop == Stop::Branching { points.max(1 + TURN) } else { 0 };
        [
            count(first, self.shares.iter().take_while(is_next_to).count()),
            count(last, self.shares.iter().rev().take_while(is_next_to).count()),
        ]
    }

    /// Whether the curve turns at a point because of a branch point next to it.
    pub(super) fn turns(&self, index: usize) -> bool {
        let [begins, ends] = self.next_to_branch_points();
        let count = self.shares.len();
        let is_due = |end: usize| !self.goes_on(index, end);
        (index < begins.min(count / 2) && is_due(0)) || (index >= count - ends.min(count / 2) && is_due(count - 1))
    }

    /// Whether the curve comes nearer to the branch point where it ends after it has turned, along another way than before.
    fn goes_on(&self, index: usize, end: usize) -> bool {
        let back = self.parameters[end] / self.parameters[index] - 1.0;
        self.shares[end] < NEARER * self.shares[index] && back.abs() > RESOLVED
    }

    /// Lets a branch that branches off others end there, where it turns in frequency but has no fold.
    pub(super) fn end(&self, branch: &mut Branch) {
        branch.outcome = self.outcome;
        if !branch.is_branched() {
            return;
        }
        branch.kind = BranchKind::of_detached(&branch.outcome, false);
        let (folds, turns): (Vec<usize>, Vec<usize>) = branch.folds().partition(|&index| !self.turns(index));
        branch.special.retain(|special| special.kind != SpecialKind::Fold || folds.contains(&special.index));
        branch.keep(self.kept(&turns));
    }

    /// Which points are to be kept: where the curve turns at a branch point, what follows is its image.
    pub(super) fn kept(&self, turns: &[usize]) -> Range<usize> {
        let middle = self.shares.len() / 2;
        let begin = turns.iter().copied().filter(|&turn| turn < middle).min();
        let end = turns.iter().copied().filter(|&turn| turn >= middle).max();
        begin.unwrap_or(0)..end.map_or(self.shares.len(), |turn| turn + 1)
    }
}

/// Takes from the folds of a branch its turns at branch points: where it crosses motions that are their own images by an exchange of equal
/// parts it goes on as its own image, and its frequency turns, but nothing is singular along it.
pub(super) fn without_turns_at_crossings(model: &Model, branch: &mut Branch) {
    for exchange in model.exchanges() {
        let asymmetry = |point: &BranchPoint| exchange.asymmetry(model, &point.state.displacements(model));
        let shares: Vec<f64> = branch.points.iter().map(asymmetry).collect();
        let farthest = shares.iter().copied().fold(0.0, f64::max);
        let is_next_to = |index: usize| shares[index] < ASYMMETRIC.min(NEXT_TO * farthest);
        if farthest > ASYMMETRIC {
            branch.special.retain(|special| special.kind != SpecialKind::Fold || !is_next_to(special.index));
        }
    }
}

/// How a curve ends that stops so, at a motion with this share of the largest asymmetry.
fn at(stop: Stop, share: f64) -> Stop {
    let fails = matches!(stop, Stop::Stalled(_) | Stop::Reversed);
    if fails && share < NEXT_TO { Stop::Branching } else { stop }
}

/// The motions that a branch branches off, nearly: of each of its branch points the mean of its images.
pub(super) fn parents<'m, F: Formulation<'m>>(problem: &mut F, branch: &Branch) -> Vec<State> {
    let Outcome::Open(first, last) = branch.outcome else { return Vec::new() };
    let ends = [(first, branch.points.first()), (last, branch.points.last())];
    let ends = ends.into_iter().filter(|(stop, _)| *stop == Stop::Branching).filter_map(|(_, end)| end);
    let middle = problem.encode(&branch.points[branch.points.len() / 2].state);
    let of = |problem: &F, y: &[f64]| {
        let metric = problem.motion_metric();
        let distance = |y: &[f64], index: usize| relative_distance(metric, &problem.image(y, index), y);
        let others = (1..problem.images()).filter(|&index| distance(&middle, index) > SAME_IMAGE);
        let nearest = others.min_by(|&a, &b| distance(y, a).total_cmp(&distance(y, b)))?;
        Some(mean_of_images(problem, y, nearest))
    };
    let means: Vec<Vec<f64>> = ends.filter_map(|end| of(problem, &problem.encode(&end.state))).collect();
    means.iter().filter_map(|mean| problem.decode(mean).ok()).collect()
}

/// Mean of a motion, its image of this number, the image of that, and so on: it is its own image.
fn mean_of_images<'m, F: Formulation<'m>>(problem: &F, y: &[f64], index: usize) -> Vec<f64> {
    let images = problem.images();
    let count = (1..=images).find(|count| (count * index).is_multiple_of(images)).unwrap_or(1);
    let all: Vec<Vec<f64>> = (0..count).map(|number| problem.image(y, number * index % images)).collect();
    mean(&all)
}
