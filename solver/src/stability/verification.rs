//! What marching says of a branch, without the orbits themselves: what is stored, sent and told.

use super::along::{AlongSettings, BranchStability, End, along};
use super::bifurcation::{Bifurcation, BifurcationKind, Unresolved};
use super::multipliers::{Multiplier, Verdict};
use super::polish::{Polish, Reason};
use super::shooting::{Orbit, Shooting};
use crate::response::branch::{Branch, Observer};
use crate::settings::Stretch;
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Least number of points of a first pass along a whole branch, special ones besides: an isola of a blade has four to eight
/// bifurcations.
const POINTS: usize = 12;

/// Points of a whole branch that are verified at most besides those that a first pass spreads over it. Around a peak changes are not located.
const MORE: usize = 84;

/// Work, a period with its tangent at each, of the points of a first pass ([`Shooting::work`]): what is cheap is looked
/// at point by point, so that nothing between points is left to guess.
const WORK: f64 = 2e8;

/// Neighbours on a branch may be told of so many points apart: orbits pass a little off the points that they are polished from.
const DISPLACED: usize = 4;

/// Multipliers that are kept of an orbit: what of them is outside the unit circle, and what comes next.
const LEADING: usize = 4;

/// An orbit no farther than this from the point that it was polished from is that point's own: where points are close together its
/// frequency tells nothing better.
const OWN: f64 = 1e-3;

/// More multipliers than any model has.
const MOST_OUTSIDE: usize = 1 << 20;

/// The marched orbit near a point of a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MarchedOrbit {
    /// Its frequency, rad/s.
    pub omega: f64,
    /// Largest |x| of each monitored dof, m.
    pub amplitudes: Vec<f64>,
    /// Distance from the solution of the balance, rms over a period and all modes, relative to the latter without its mean.
    pub distance: f64,
    /// The largest multipliers, the largest first.
    pub multipliers: Vec<Multiplier>,
    /// Moduli that are 1 within this are not known to be on either side of the unit circle.
    pub margin: f64,
    /// Share of the energy supplied in a period that impacts take.
    pub impacts: f64,
}

/// A point of a branch that was verified.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VerifiedPoint {
    /// Number of the point on the branch.
    pub index: usize,
    /// Number of the point at which the branch passes the frequency of the orbit, as near as it comes to that on the same part:
    /// the marched branch is displaced from that of the balance, and what is true of the orbit is told there. Its own if it is not.
    pub at: usize,
    /// Whether its orbit is stable, or why that is not known.
    pub verdict: Verdict,
    /// Why there is no verdict.
    pub reason: Option<Reason>,
    /// The orbit, if there is one nearby.
    pub orbit: Option<MarchedOrbit>,
}

/// A bifurcation of the marched orbits of a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BifurcationPoint {
    /// What happens.
    pub kind: BifurcationKind,
    /// Marched frequency, rad/s.
    pub omega: f64,
    /// Largest |x| of each monitored dof, m.
    pub amplitudes: Vec<f64>,
    /// Number of the point of the branch before it; the next one that is verified is after it.
    pub after: usize,
    /// Number of the point at which the branch passes its frequency, as of [`VerifiedPoint::at`].
    pub at: usize,
    /// The multiplier that crosses the unit circle (of a pair either one).
    pub multiplier: Multiplier,
    /// Multipliers outside the unit circle before and after it, in the order of the arc.
    pub outside: [usize; 2],
}

/// What marching says of a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Verification {
    /// Number of points of the branch.
    pub count: usize,
    /// Whether the branch is a closed curve.
    pub is_closed: bool,
    /// How much of it was looked at.
    pub stretch: Stretch,
    /// Largest distance of neighbours of the first pass along it, in points.
    pub spacing: usize,
    /// Numbers of the points of the branch that are folds of the balance.
    pub folds: Vec<usize>,
    /// Number of the point of largest amplitude.
    pub peak: usize,
    /// Points that were verified, in the order of the arc.
    pub points: Vec<VerifiedPoint>,
    /// Bifurcations, in the order of the arc.
    pub bifurcations: Vec<BifurcationPoint>,
    /// Multipliers that cross the unit circle where it could not be located, in the order of the arc.
    pub unresolved: Vec<Unresolved>,
    /// How the pass along the branch ended.
    pub end: End,
}

/// Verifies a stretch of a branch by time marching: [`along`] it, without the orbits. `None` if `observer`, told of every
/// point that was verified, breaks.
pub fn verify(model: &Model, branch: &Branch, stretch: Stretch, observer: &mut Observer<'_>) -> Option<Verification> {
    verify_with_orbits(model, branch, stretch, observer).map(|(verification, _)| verification)
}

/// The same with the orbits themselves: one for every point that has one, in their order.
pub fn verify_with_orbits(
    model: &Model,
    branch: &Branch,
    stretch: Stretch,
    observer: &mut Observer<'_>,
) -> Option<(Verification, Vec<Orbit>)> {
    let settings = pass_settings(model, branch, stretch);
    let found = along(model, &settings, branch, &mut |point| observer(&branch.points[point.index]));
    let polished = found.points.iter().filter_map(|point| point.polish.polished.as_ref());
    let orbits = polished.map(|polished| polished.orbit.clone()).collect();
    (found.end != End::Cancelled).then(|| (Verification::new(&settings, branch, &found), orbits))
}

/// How finely a branch is looked at: all of its points where periods are cheap, and a few of a large model's.
fn pass_settings(model: &Model, branch: &Branch, stretch: Stretch) -> AlongSettings {
    let settings = AlongSettings { stretch, points: POINTS, most: 0, ..AlongSettings::default() };
    let work = branch.points.iter().map(|point| &point.state).min_by(|a, b| a.omega.total_cmp(&b.omega));
    let work = work.and_then(|slowest| Shooting::new(model, &settings.polish.marching, slowest).ok());
    let affordable = work.map_or(0, |shooting| (WORK / shooting.work()) as usize);
    match stretch {
        Stretch::Peak => AlongSettings { beside_peak: affordable / 2 / POINTS, ..settings },
        Stretch::Whole => {
            let points = affordable.clamp(POINTS, branch.points.len().max(POINTS));
            AlongSettings { points, most: points + MORE, ..settings }
        }
    }
}

impl Verification {
    /// What is kept of what is known of a branch.
    pub fn new(settings: &AlongSettings, branch: &Branch, found: &BranchStability) -> Self {
        let count = branch.points.len();
        Self {
            count,
            is_closed: branch.is_closed(),
            stretch: settings.stretch,
            spacing: settings.spacing(count),
            folds: branch.folds().collect(),
            peak: branch.peak_index(),
            points: found.points.iter().map(|point| VerifiedPoint::new(branch, point.index, &point.polish)).collect(),
            bifurcations: found.bifurcations.iter().map(|found| BifurcationPoint::new(branch, found)).collect(),
            unresolved: found.unresolved.clone(),
            end: found.end,
        }
    }

    /// The verdict of every point of the branch, `None` where it was not verified.
    ///
    /// Between two orbits that are neighbours along the branch and of the same verdict it is theirs, unless that may change in
    /// between, or they are told of much farther apart than points of a first pass are. Two crossings between such neighbours that undo
    /// each other are seen only if one is near a fold of the balance.
    pub fn verdicts(&self) -> Vec<Option<Verdict>> {
        let mut told: BTreeMap<usize, Option<Verdict>> = BTreeMap::new();
        let tell = |told: &mut BTreeMap<usize, Option<Verdict>>, at: usize, verdict: Verdict| {
            let known = told.entry(at).or_insert(Some(verdict));
            *known = known.filter(|known| *known == verdict);
        };
        self.points.iter().for_each(|point| tell(&mut told, point.at, point.verdict));
        // An end of an open branch was looked at itself, however far from it the frequency of its orbit is passed.
        for end in [self.points.first(), self.points.last()].into_iter().flatten().filter(|_| !self.is_closed) {
            if end.verdict.is_known() && [0, self.count - 1].contains(&end.index) {
                let beyond = end.at.min(end.index)..=end.at.max(end.index);
                beyond.filter(|&at| at != end.at).for_each(|at| tell(&mut told, at, end.verdict));
            }
        }
        // From where orbits that differ come together nothing follows.
        let is_clear = |told: &BTreeMap<usize, Option<Verdict>>, point: &VerifiedPoint| told[&point.at].is_some();
        let around = self.points.last().zip(self.points.first()).filter(|_| self.goes_round() && self.points.len() > 1);
        let pairs = self.points.windows(2).map(|pair| [&pair[0], &pair[1]]).chain(around.map(|(a, b)| [a, b]));
        for [a, b] in pairs.filter(|[a, b]| a.verdict == b.verdict && a.verdict.is_known() && self.lasts(a, b)) {
            if is_clear(&told, a) && is_clear(&told, b) {
                (1..self.from(a.at, b.at)).for_each(|i| tell(&mut told, (a.at + i) % self.count, a.verdict));
            }
        }
        let mut verdicts = vec![None; self.count];
        told.into_iter().for_each(|(at, verdict)| verdicts[at] = verdict);
        verdicts
    }

    /// What was found near the point of largest amplitude: the marched orbit there may be a little lower, or higher, at another
    /// frequency. `None` if it was not looked at.
    pub fn at_peak(&self) -> Option<&VerifiedPoint> {
        self.points.iter().find(|point| point.index == self.peak)
    }

    /// Number of monitored dofs of which it gives amplitudes; none where no orbit was found.
    pub fn monitors(&self) -> usize {
        self.points.iter().find_map(|point| point.orbit.as_ref()).map_or(0, |orbit| orbit.amplitudes.len())
    }

    /// Number of points from one to another after it.
    fn from(&self, first: usize, last: usize) -> usize {
        (last + self.count - first) % self.count
    }

    /// Whether a point lies between two others, the first of which is included.
    pub(super) fn is_between(&self, first: usize, last: usize, index: usize) -> bool {
        self.from(first, index) < self.from(first, last)
    }

    /// Whether the arc was gone round as a whole.
    pub(super) fn goes_round(&self) -> bool {
        self.is_closed && self.stretch == Stretch::Whole
    }

    /// The largest modulus of the multipliers at the points at which orbits pass, `None` at others and where several do.
    pub fn moduli(&self) -> Vec<Option<f64>> {
        let mut moduli = vec![None; self.count];
        for point in &self.points {
            let is_alone = self.points.iter().filter(|other| other.at == point.at).count() == 1;
            let orbit = point.orbit.as_ref().filter(|_| is_alone);
            moduli[point.at] = orbit.and_then(|orbit| orbit.multipliers.first()).map(Multiplier::modulus);
        }
        moduli
    }

    /// Whether what holds at two neighbours is known to hold between them: no multiplier is known to cross the unit circle in
    /// between, or not the only one outside, and none has to at a fold of the balance that no bifurcation accounts for.
    fn lasts(&self, a: &VerifiedPoint, b: &VerifiedPoint) -> bool {
        let is_between = |index: usize| self.is_between(a.index, b.index, index);
        let matters = |outside: [usize; 2]| a.verdict != Verdict::Unstable || outside.contains(&0);
        let mut bifurcations = self.bifurcations.iter().filter(|found| is_between(found.after));
        let mut unresolved = self.unresolved.iter().map(|unresolved| [unresolved.first, unresolved.last]);
        let is_fold_between = |&fold: &usize| fold != a.index && is_between(fold) && !self.is_accounted_for(fold);
        !bifurcations.any(|found| matters(found.outside))
            && !unresolved.any(|ends| self.overlap([a.index, b.index], ends))
            && !self.folds.iter().any(is_fold_between)
            && self.from(a.at, b.at) <= (self.spacing + self.spacing / 2).max(DISPLACED)
    }

    /// Whether a fold of the marched orbits was found near one of the balance.
    fn is_accounted_for(&self, fold: usize) -> bool {
        let folds = self.bifurcations.iter().filter(|found| found.kind == BifurcationKind::Fold);
        let off = |at: usize| self.from(at, fold).min(self.from(fold, at));
        let coarsest = self.count.div_ceil(POINTS - 1);
        folds.map(|found| off(found.at).min(off(found.after))).any(|off| off <= coarsest)
    }

    /// Whether two stretches of the arc, each from its first point to its last one, have points in common.
    fn overlap(&self, [a, b]: [usize; 2], [c, d]: [usize; 2]) -> bool {
        self.from(a, c) < self.from(a, b) || self.from(c, a) < self.from(c, d)
    }

    /// Share of the points of the branch of which this is known, 0 to 1.
    pub fn share(&self, verdict: Verdict) -> f64 {
        let number = self.verdicts().into_iter().filter(|found| *found == Some(verdict)).count();
        number as f64 / self.count as f64
    }

    /// Whether it agrees with another one of the same branch about what can be settled on: verdicts of every point that both
    /// verified, and kinds of bifurcations.
    pub fn agrees(&self, other: &Self) -> bool {
        let kinds = |found: &Self| found.bifurcations.iter().map(|found| found.kind).collect::<Vec<_>>();
        let same = |a: &VerifiedPoint, b: &VerifiedPoint| a.index != b.index || a.verdict == b.verdict;
        self.count == other.count
            && kinds(self) == kinds(other)
            && self.points.iter().all(|a| other.points.iter().all(|b| same(a, b)))
    }

    /// Whether it is one of a branch of so many points of a model with so many monitored dofs: every number finite, every index
    /// on the branch, in order.
    pub fn is_sound(&self, monitors: usize) -> bool {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let pairs = |values: &[Multiplier]| values.iter().all(|mu| finite(&[mu.re, mu.im]));
        let orbit = |orbit: &MarchedOrbit| {
            orbit.amplitudes.len() == monitors
                && finite(&orbit.amplitudes)
                && pairs(&orbit.multipliers)
                && !orbit.multipliers.is_empty()
                && finite(&[orbit.omega, orbit.distance, orbit.margin, orbit.impacts])
        };
        let bifurcation = |found: &BifurcationPoint| {
            found.after.max(found.at) < self.count
                && found.outside.iter().all(|&outside| outside <= MOST_OUTSIDE)
                && found.amplitudes.len() == monitors
                && finite(&found.amplitudes)
                && pairs(&[found.multiplier])
                && found.omega.is_finite()
        };
        self.points.is_sorted_by(|a, b| a.index < b.index)
            && self.points.iter().all(|point| point.index.max(point.at) < self.count)
            && !self.points.is_empty()
            && self.spacing.max(self.peak) <= self.count
            && self.folds.iter().all(|&fold| fold < self.count)
            && self.points.iter().all(|point| {
                point.orbit.as_ref().is_none_or(orbit) && (point.orbit.is_some() || !point.verdict.is_known())
            })
            && self.bifurcations.iter().all(bifurcation)
            && self.unresolved.iter().all(|unresolved| unresolved.first.max(unresolved.last) < self.count)
    }
}

impl VerifiedPoint {
    fn new(branch: &Branch, index: usize, polish: &Polish) -> Self {
        let orbit = polish.polished.as_ref().map(|polished| MarchedOrbit {
            omega: polished.orbit.omega,
            amplitudes: polished.amplitudes.clone(),
            distance: polished.distance,
            multipliers: polished.multipliers.iter().take(LEADING).copied().collect(),
            margin: polished.margin,
            impacts: polished.impacts,
        });
        let elsewhere = orbit.as_ref().filter(|orbit| orbit.distance > OWN);
        let at = elsewhere.map_or(index, |orbit| passing(branch, index, orbit.omega));
        Self { index, at, verdict: polish.verdict, reason: polish.reason, orbit }
    }
}

impl BifurcationPoint {
    fn new(branch: &Branch, found: &Bifurcation) -> Self {
        Self {
            kind: found.kind,
            omega: found.omega,
            amplitudes: found.amplitudes.clone(),
            after: found.after,
            at: passing(branch, found.after, found.omega),
            multiplier: found.multiplier,
            outside: found.outside,
        }
    }
}

/// Number of the point at which a branch comes nearest to a frequency on the way from point `index` along which it comes nearer.
fn passing(branch: &Branch, index: usize, omega: f64) -> usize {
    let count = branch.points.len();
    let off = |i: usize| (branch.points[i].omega() - omega).abs();
    let beside = |i: usize| {
        let ends = branch.is_closed() || i > 0 && i + 1 < count;
        let before = (ends || i > 0).then_some((i + count - 1) % count);
        let after = (ends || i + 1 < count).then_some((i + 1) % count);
        [before, after].into_iter().flatten()
    };
    let nearer = |&i: &usize| beside(i).min_by(|&a, &b| off(a).total_cmp(&off(b))).filter(|&next| off(next) < off(i));
    std::iter::successors(Some(index), nearer).last().unwrap_or(index)
}
