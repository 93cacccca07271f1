//! Stability along a branch: points chosen where they tell something, bifurcations located between them.

use super::bifurcation::{Bifurcation, Changes, Known, Obstacle, Unresolved, between};
use super::branch_ends::with_ends;
use super::crossing::Event;
use super::polish::{Around, Polish, PolishSettings, polish};
use super::returns::once_each;
use crate::formulation::state::State;
use crate::response::branch::Branch;
use crate::settings::Stretch;
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// How finely a branch is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct AlongSettings {
    /// How each point is polished.
    pub polish: PolishSettings,
    /// How much of it is looked at.
    pub stretch: Stretch,
    /// Points that the first pass spreads over the branch, special points besides.
    pub points: usize,
    /// Points that the first pass spreads over either side of a peak, where only what is around that is looked at.
    pub beside_peak: usize,
    /// Most points that are polished, those of the first pass included.
    pub most: usize,
}

impl Default for AlongSettings {
    fn default() -> Self {
        Self { polish: PolishSettings::default(), stretch: Stretch::Whole, points: 24, beside_peak: 1, most: 200 }
    }
}

impl AlongSettings {
    /// Largest distance of neighbours of the first pass on a branch of so many points, in points.
    pub fn spacing(&self, count: usize) -> usize {
        count.div_ceil(self.points.max(2) - 1)
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

/// How a pass along a branch ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// Every change that the first pass saw is between neighbours on the branch.
    #[default]
    Complete,
    /// [`AlongSettings::most`] points were polished before that.
    Budget,
    /// The observer broke it off.
    Cancelled,
}

/// What is known of the stability of a branch.
///
/// From one point with a verdict to the next one that has one, the number of multipliers outside changes by what happens at
/// the bifurcations and at what is unresolved between them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct BranchStability {
    /// Points, in the order of the arc.
    pub points: Vec<PolishedPoint>,
    /// Bifurcations, in the order of the arc.
    pub bifurcations: Vec<Bifurcation>,
    /// Crossings that could not be located, in the order of the arc.
    pub unresolved: Vec<Unresolved>,
    /// How the pass ended.
    pub end: End,
}

/// Told of every polished point; breaking cancels what is left.
pub type PolishObserver<'o> = dyn FnMut(&PolishedPoint) -> ControlFlow<()> + 'o;

/// Polishes points of a branch, coarsely along the arc and then towards every change of the number of multipliers outside
/// the unit circle, the widest interval first, and locates the bifurcations there; where points without an orbit nearby
/// begin is refined as well. Two changes within one interval of the first pass that undo each other are not seen.
///
/// Points may polish to orbits in another order of frequencies than their own: the marched frequency counts.
pub fn along(
    model: &Model,
    settings: &AlongSettings,
    branch: &Branch,
    observer: &mut PolishObserver<'_>,
) -> BranchStability {
    let mut pass = Pass { model, settings, branch, polished: BTreeMap::new() };
    let end = pass.run(observer);
    let Changes { bifurcations, unresolved } = pass.account(end);
    let bifurcations = once_each(bifurcations);
    let bifurcations = with_ends(branch, bifurcations, |end| pass.polished.get(&end)?.polished.as_ref());
    let point = |(index, polish)| PolishedPoint { index, polish };
    let points = pass.polished.into_iter().map(point).collect();
    BranchStability { points, bifurcations, unresolved, end }
}

struct Pass<'a> {
    model: &'a Model,
    settings: &'a AlongSettings,
    branch: &'a Branch,
    polished: BTreeMap<usize, Polish>,
}

impl Pass<'_> {
    /// Polishes the first points, then halves intervals until no change can be located better.
    fn run(&mut self, observer: &mut PolishObserver<'_>) -> End {
        for index in self.first() {
            if self.polish(index, observer).is_break() {
                return End::Cancelled;
            }
        }
        while let Some(index) = self.widest() {
            if self.polished.len() >= self.settings.most {
                return End::Budget;
            }
            if self.polish(index, observer).is_break() {
                return End::Cancelled;
            }
        }
        End::Complete
    }

    /// The middle of the widest interval in which something happens: none of them waits for the noise in another.
    fn widest(&self) -> Option<usize> {
        let changes = self.pairs().into_iter().filter(|&pair| self.changes(pair));
        changes.max_by_key(|&pair| self.apart(pair)).and_then(|pair| self.middle(pair))
    }

    /// Numbers of the points of the first pass: spread over the arc, and special ones.
    fn first(&self) -> Vec<usize> {
        let count = self.branch.points.len();
        let wanted = self.settings.points.clamp(2, count.max(2));
        let spread: Vec<usize> = match self.settings.stretch {
            Stretch::Peak => self.around_peak(),
            Stretch::Whole if count <= wanted => (0..count).collect(),
            Stretch::Whole if self.branch.is_closed() => (0..wanted).map(|i| i * count / wanted).collect(),
            Stretch::Whole => (0..wanted).map(|i| i * (count - 1) / (wanted - 1)).collect(),
        };
        let looked_at = spread[0]..=spread[spread.len() - 1];
        let special = self.branch.special.iter().map(|special| special.index);
        let is_whole = self.settings.stretch == Stretch::Whole;
        // Two folds change the number of multipliers outside and change it back: what is between them is looked at.
        let folds: Vec<usize> = self.branch.folds().collect();
        let around = folds.last().zip(folds.first()).filter(|_| self.branch.is_closed());
        let pairs = folds.windows(2).map(|pair| (pair[0], pair[1])).chain(around.map(|(last, first)| (*last, *first)));
        let between = pairs.filter_map(|pair| self.middle(pair));
        let special = special.chain(between).filter(|index| is_whole || looked_at.contains(index));
        let mut first: Vec<usize> = spread.iter().copied().chain(special).collect();
        first.sort_unstable();
        first.dedup();
        first
    }

    /// The peak and points on either side of it, as far as the first pass along the whole branch has its next one.
    fn around_peak(&self) -> Vec<usize> {
        let (peak, last) = (self.branch.peak_index(), self.branch.points.len() - 1);
        let spacing = self.settings.spacing(last + 1);
        let beside = self.settings.beside_peak.clamp(1, spacing);
        let sides = (1..=beside).map(|k| k * spacing / beside);
        let before = sides.clone().rev().map(|by| peak.saturating_sub(by));
        before.chain([peak]).chain(sides.map(|by| (peak + by).min(last))).collect()
    }

    /// Whether the arc is gone round as a whole.
    fn goes_round(&self) -> bool {
        self.branch.is_closed() && self.settings.stretch == Stretch::Whole
    }

    fn state(&self, index: usize) -> &State {
        &self.branch.points[index].state
    }

    fn polish(&mut self, index: usize, observer: &mut PolishObserver<'_>) -> ControlFlow<()> {
        let count = self.branch.points.len();
        let closed = self.branch.is_closed();
        let before = if index > 0 || closed { (index + count - 1) % count } else { index };
        let after = if index + 1 < count || closed { (index + 1) % count } else { index };
        let between = (before != after).then(|| [self.state(before), self.state(after)]);
        let neighbour = self.neighbour(index).and_then(|near| {
            let polished = self.polished[&near].polished.as_ref()?;
            Some((self.state(near), &polished.orbit))
        });
        let around = Around { between, neighbour };
        let polish = polish(self.model, &self.settings.polish, self.state(index), around);
        let point = PolishedPoint { index, polish };
        let flow = observer(&point);
        self.polished.insert(index, point.polish);
        flow
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
        if let (true, [first, .., last]) = (self.goes_round(), indices.as_slice()) {
            pairs.push((*last, *first));
        }
        pairs
    }

    /// Whether something happens between two points, or may happen.
    fn changes(&self, (a, b): (usize, usize)) -> bool {
        match (self.known(a), self.known(b)) {
            (Some(a), Some(b)) => a.event(&b) != Some(Event::Nothing),
            (a, b) => a.is_some() != b.is_some(),
        }
    }

    /// Intervals of the branch from one point to another one after it.
    fn apart(&self, (a, b): (usize, usize)) -> usize {
        if b > a { b - a } else { b + self.branch.points.len() - a }
    }

    /// The point half way between two that are no neighbours.
    fn middle(&self, (a, b): (usize, usize)) -> Option<usize> {
        let apart = self.apart((a, b));
        (apart > 1).then_some((a + apart / 2) % self.branch.points.len())
    }

    fn known(&self, index: usize) -> Option<Known> {
        let polish = &self.polished[&index];
        let polished = polish.polished.as_ref().filter(|_| polish.verdict.is_known())?;
        let (orbit, multipliers) = (polished.orbit.clone(), polished.multipliers.clone());
        Some(Known { orbit, multipliers, margin: polished.margin })
    }

    /// What is known from one point to another one, both included.
    fn path(&self, first: usize, last: usize) -> Vec<Numbered> {
        let apart = self.apart((first, last));
        let numbers = (0..=apart).map(|by| (first + by) % self.branch.points.len());
        let polished = numbers.filter(|index| self.polished.contains_key(index));
        polished.filter_map(|index| Some((index, self.known(index)?))).collect()
    }

    /// What happens along the branch, every change of the number of multipliers outside accounted for.
    fn account(&self, end: End) -> Changes {
        let mut order: Vec<usize> = self.polished.keys().copied().collect();
        let Some(start) = order.iter().position(|&index| self.known(index).is_some()) else {
            return Changes::default();
        };
        if self.goes_round() {
            order.rotate_left(start);
            order.push(order[0]);
        }
        let mut account = Account { pass: self, end, found: Changes::default(), last: None, doubtful: None };
        order.into_iter().for_each(|index| account.go_on_to(index));
        account.end_doubt();
        account.found
    }
}

/// A point with its number.
type Numbered = (usize, Known);

/// Changes from point to point.
struct Account<'a> {
    pass: &'a Pass<'a>,
    end: End,
    found: Changes,
    /// The last point with a verdict, and whether there were others since.
    last: Option<(Numbered, bool)>,
    /// The last point before multipliers came so near the circle that it is not known on which side they are.
    doubtful: Option<Numbered>,
}

impl Account<'_> {
    fn go_on_to(&mut self, index: usize) {
        let Some(known) = self.pass.known(index) else {
            self.last.iter_mut().for_each(|(_, is_gap)| *is_gap = true);
            return;
        };
        let now = (index, known);
        if let Some((last, is_gap)) = self.last.take() {
            self.compare(last, &now, is_gap);
        }
        self.last = Some((now, false));
    }

    fn compare(&mut self, last: Numbered, now: &Numbered, is_gap: bool) {
        if is_gap {
            self.end_doubt_at(&last);
            return self.leave(&last, now, Obstacle::NoOrbit);
        }
        let first = self.doubtful.take();
        // A crossing is beyond doubt once the multiplier has left the circle on the other side.
        if let Some(first) = first.as_ref().filter(|first| first.1.event(&now.1).is_some()) {
            return self.locate(first, now);
        }
        match last.1.event(&now.1) {
            None => self.doubtful = Some(first.unwrap_or(last)),
            Some(Event::Nothing) => self.doubtful = first,
            Some(_) => {
                self.doubtful = first;
                self.end_doubt_at(&last);
                self.locate(&last, now);
            }
        }
    }

    fn end_doubt(&mut self) {
        if let Some((last, _)) = self.last.take() {
            self.end_doubt_at(&last);
        }
    }

    fn end_doubt_at(&mut self, last: &Numbered) {
        if let Some(first) = self.doubtful.take() {
            self.leave(&first, last, Obstacle::WithinNoise);
        }
    }

    /// Locates what happens between two points.
    fn locate(&mut self, first: &Numbered, last: &Numbered) {
        let path = self.pass.path(first.0, last.0);
        // Where nothing happens between points with others between them these are not asked.
        let is_fine = path.windows(2).all(|pair| {
            let ends = (pair[0].0, pair[1].0);
            self.pass.middle(ends).is_none() || !self.pass.changes(ends)
        });
        match self.end {
            End::Cancelled => self.leave(first, last, Obstacle::Cancelled),
            _ if !is_fine => self.leave(first, last, Obstacle::Budget),
            _ => {
                let Changes { bifurcations, unresolved } = between(self.pass.model, &path);
                self.found.bifurcations.extend(bifurcations);
                self.found.unresolved.extend(unresolved);
            }
        }
    }

    /// Leaves what happens between two points at that it does.
    fn leave(&mut self, (first, before): &Numbered, (last, after): &Numbered, reason: Obstacle) {
        let outside = [before, after].map(Known::outside);
        if Event::between(&outside[0], &outside[1]) != Event::Nothing {
            let outside = outside.map(|outside| outside.count());
            self.found.unresolved.push(Unresolved { first: *first, last: *last, outside, reason });
        }
    }
}
