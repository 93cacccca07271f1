//! Stability along a branch: points chosen where they tell something, bifurcations located between them.

use super::bifurcation::{Bifurcation, Known, between};
use super::multipliers::Outside;
use super::polish::{Around, Polish, PolishSettings, polish};
use crate::formulation::state::State;
use crate::response::branch::Branch;
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// How finely a branch is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct AlongSettings {
    /// How each point is polished.
    pub polish: PolishSettings,
    /// Points that the first pass spreads over the branch, special points besides.
    pub points: usize,
    /// Most points that are polished, those of the first pass included.
    pub most: usize,
}

impl Default for AlongSettings {
    fn default() -> Self {
        Self { polish: PolishSettings::default(), points: 24, most: 200 }
    }
}

/// A polished point of a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PolishedPoint {
    /// Number of the point on the branch.
    pub index: usize,
    /// What polishing it came to.
    pub polish: Polish,
}

/// What is known of the stability of a branch.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct BranchStability {
    /// Points, in the order of the arc.
    pub points: Vec<PolishedPoint>,
    /// Bifurcations, in the order of the arc.
    pub bifurcations: Vec<Bifurcation>,
}

/// Told of every polished point; breaking cancels what is left.
pub type PolishObserver<'o> = dyn FnMut(&PolishedPoint) -> ControlFlow<()> + 'o;

/// Polishes points of a branch, coarsely along the arc and then towards every change of the number of multipliers outside
/// the unit circle, and locates the bifurcations there; where points without an orbit nearby begin is refined as well. Two
/// changes within one interval of the first pass that undo each other are not seen.
///
/// Points may polish to orbits in another order of frequencies than their own: the marched frequency counts.
pub fn along(
    model: &Model,
    settings: &AlongSettings,
    branch: &Branch,
    observer: &mut PolishObserver<'_>,
) -> BranchStability {
    let mut pass = Pass { model, settings, branch, polished: BTreeMap::new() };
    let Some(()) = pass.run(observer) else { return pass.result(Vec::new()) };
    let mut bifurcations = Vec::new();
    for (a, b) in pass.pairs() {
        if b == pass.next(a)
            && let (Some(first), Some(last)) = (pass.known(a), pass.known(b))
        {
            bifurcations.extend(between(model, &first, &last, a));
        }
    }
    pass.result(bifurcations)
}

struct Pass<'a> {
    model: &'a Model,
    settings: &'a AlongSettings,
    branch: &'a Branch,
    polished: BTreeMap<usize, Polish>,
}

impl Pass<'_> {
    /// Polishes the first points, then halves intervals until no change can be located better; `None` if cancelled.
    fn run(&mut self, observer: &mut PolishObserver<'_>) -> Option<()> {
        for index in self.first() {
            self.polish(index, observer)?;
        }
        while self.polished.len() < self.settings.most {
            let changes = self.pairs().into_iter().filter(|&pair| self.changes(pair));
            let Some(index) = changes.filter_map(|pair| self.middle(pair)).next() else { break };
            self.polish(index, observer)?;
        }
        Some(())
    }

    /// Numbers of the points of the first pass.
    fn first(&self) -> Vec<usize> {
        let count = self.branch.points.len();
        let wanted = self.settings.points.clamp(2, count.max(2));
        let mut first: Vec<usize> = if count <= wanted {
            (0..count).collect()
        } else if self.branch.is_closed() {
            (0..wanted).map(|i| i * count / wanted).collect()
        } else {
            (0..wanted).map(|i| i * (count - 1) / (wanted - 1)).collect()
        };
        first.extend(self.branch.special.iter().map(|special| special.index));
        first.sort_unstable();
        first.dedup();
        first
    }

    fn state(&self, index: usize) -> &State {
        &self.branch.points[index].state
    }

    /// The point after this one.
    fn next(&self, index: usize) -> usize {
        (index + 1) % self.branch.points.len()
    }

    fn polish(&mut self, index: usize, observer: &mut PolishObserver<'_>) -> Option<()> {
        let count = self.branch.points.len();
        let closed = self.branch.is_closed();
        let before = if index > 0 || closed { (index + count - 1) % count } else { index };
        let after = if index + 1 < count || closed { (index + 1) % count } else { index };
        let way = (before != after).then(|| [self.state(before), self.state(after)]);
        let neighbour = self.neighbour(index).and_then(|near| {
            let polished = self.polished[&near].polished.as_ref()?;
            Some((self.state(near), &polished.orbit))
        });
        let around = Around { way, neighbour };
        let polish = polish(self.model, &self.settings.polish, self.state(index), around);
        let point = PolishedPoint { index, polish };
        let flow = observer(&point);
        self.polished.insert(index, point.polish);
        if flow.is_break() { None } else { Some(()) }
    }

    /// The nearest point along the arc that has an orbit.
    fn neighbour(&self, index: usize) -> Option<usize> {
        let count = self.branch.points.len();
        let apart = |other: usize| {
            let along = index.abs_diff(other);
            if self.branch.is_closed() { along.min(count - along) } else { along }
        };
        let orbits = self.polished.iter().filter(|(_, polish)| polish.polished.is_some());
        orbits.map(|(&other, _)| other).min_by_key(|&other| apart(other))
    }

    /// Neighbouring points among those that are polished.
    fn pairs(&self) -> Vec<(usize, usize)> {
        let indices: Vec<usize> = self.polished.keys().copied().collect();
        let mut pairs: Vec<(usize, usize)> = indices.windows(2).map(|pair| (pair[0], pair[1])).collect();
        if let (true, [first, .., last]) = (self.branch.is_closed(), indices.as_slice()) {
            pairs.push((*last, *first));
        }
        pairs
    }

    /// Whether something happens between two points.
    fn changes(&self, (a, b): (usize, usize)) -> bool {
        let dimension = |index: usize| {
            let polish = &self.polished[&index];
            let known = polish.polished.as_ref().filter(|_| polish.verdict.is_known());
            known.map(|polished| Outside::of(&polished.multipliers).count())
        };
        dimension(a) != dimension(b)
    }

    /// The point half way between two that are no neighbours.
    fn middle(&self, (a, b): (usize, usize)) -> Option<usize> {
        let count = self.branch.points.len();
        let apart = if b > a { b - a } else { b + count - a };
        (apart > 1).then_some((a + apart / 2) % count)
    }

    fn known(&self, index: usize) -> Option<Known> {
        let polish = &self.polished[&index];
        let polished = polish.polished.as_ref().filter(|_| polish.verdict.is_known())?;
        Some(Known { orbit: polished.orbit.clone(), multipliers: polished.multipliers.clone() })
    }

    fn result(self, bifurcations: Vec<Bifurcation>) -> BranchStability {
        let point = |(index, polish)| PolishedPoint { index, polish };
        BranchStability { points: self.polished.into_iter().map(point).collect(), bifurcations }
    }
}
