//! What marching says of a branch, without the orbits themselves: what is stored, sent and told.

use super::along::{AlongSettings, BranchStability, End, along};
use super::bifurcation::{Bifurcation, BifurcationKind, Unresolved};
use super::multipliers::{Multiplier, Verdict};
use super::polish::{Polish, Reason};
use crate::response::branch::{Branch, Observer};
use crate::settings::Stretch;
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Points of a first pass along a whole branch, special ones besides: an isola of a blade has four to eight bifurcations.
const POINTS: usize = 12;

/// Most points of a whole branch that are verified. Around a peak changes are not located.
const MOST: usize = 96;

/// Multipliers that are kept of an orbit: what of them is outside the unit circle, and what comes next.
const LEADING: usize = 4;

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
    /// the marched branch is displaced from that of the balance, and what is true of the orbit is told there.
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
    /// What is true of the orbit near the point of largest amplitude, if that was verified.
    pub peak: Option<Verdict>,
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
    let most = if stretch == Stretch::Peak { 0 } else { MOST };
    let settings = AlongSettings { stretch, points: POINTS, most, ..AlongSettings::default() };
    let found = along(model, &settings, branch, &mut |point| observer(&branch.points[point.index]));
    (found.end != End::Cancelled).then(|| Verification::new(&settings, branch, &found))
}

impl Verification {
    /// What is kept of what is known of a branch.
    pub fn new(settings: &AlongSettings, branch: &Branch, found: &BranchStability) -> Self {
        let (count, peak) = (branch.points.len(), branch.peak_index());
        let at_peak = found.points.iter().find(|point| point.index == peak);
        Self {
            count,
            is_closed: branch.is_closed(),
            stretch: settings.stretch,
            spacing: settings.spacing(count),
            peak: at_peak.map(|point| point.polish.verdict),
            points: found.points.iter().map(|point| VerifiedPoint::new(branch, point.index, &point.polish)).collect(),
            bifurcations: found.bifurcations.iter().map(|found| BifurcationPoint::new(branch, found)).collect(),
            unresolved: found.unresolved.clone(),
            end: found.end,
        }
    }

    /// The verdict of every point of the branch, `None` where it was not verified.
    ///
    /// Between two neighbouring orbits of the same verdict it is theirs, unless that may change in between or they are much farther
    /// apart than points of a first pass are. Two crossings between such neighbours that undo each other are
    /// not seen.
    pub fn verdicts(&self) -> Vec<Option<Verdict>> {
        let places = self.places();
        let mut verdicts = vec![None; self.count];
        places.iter().for_each(|&(at, verdict)| verdicts[at] = verdict);
        let around = places.last().zip(places.first()).filter(|_| self.goes_round() && places.len() > 1);
        let pairs = places.windows(2).map(|pair| [pair[0], pair[1]]).chain(around.map(|(last, first)| [*last, *first]));
        for [(a, first), (b, last)] in pairs {
            if first == last && first.is_some_and(|verdict| verdict.is_known() && self.lasts(verdict, a, b)) {
                let inner = std::iter::successors(Some((a + 1) % self.count), |i| Some((i + 1) % self.count));
                inner.take_while(|&i| i != b).for_each(|i| verdicts[i] = first);
            }
        }
        verdicts
    }

    /// Where something is told of orbits, in the order of the arc, and what: nothing where orbits that differ come together.
    fn places(&self) -> Vec<(usize, Option<Verdict>)> {
        let mut places: BTreeMap<usize, Option<Verdict>> = BTreeMap::new();
        for point in &self.points {
            let told = places.entry(point.at).or_insert(Some(point.verdict));
            *told = told.filter(|verdict| *verdict == point.verdict);
        }
        places.into_iter().collect()
    }

    /// Whether the arc was gone round as a whole.
    fn goes_round(&self) -> bool {
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

    /// Whether what holds at two places is known to hold between them: they are as near as neighbours of a first pass, and no
    /// multiplier is known to cross the unit circle in between, or not the only one outside.
    fn lasts(&self, verdict: Verdict, a: usize, b: usize) -> bool {
        let from_a = |to: usize| (to + self.count - a) % self.count;
        let matters = |outside: [usize; 2]| verdict != Verdict::Unstable || outside.contains(&0);
        let mut between = self.bifurcations.iter().filter(|bifurcation| from_a(bifurcation.at) <= from_a(b));
        let crosses = between.any(|bifurcation| matters(bifurcation.outside))
            || self.unresolved.iter().any(|unresolved| {
                let ends = [unresolved.first, unresolved.last].map(|index| self.place(index));
                self.overlap([a, b], ends)
            });
        // Orbits are told of a little off the points of the first pass.
        !crosses && from_a(b) <= self.spacing + self.spacing / 2
    }

    /// Whether two stretches of the arc, each from its first point to its last one, have points in common.
    fn overlap(&self, [a, b]: [usize; 2], [c, d]: [usize; 2]) -> bool {
        let from = |first: usize, to: usize| (to + self.count - first) % self.count;
        from(a, c) < from(a, b) || from(c, a) < from(c, d)
    }

    /// Where what is true of the orbit of a point is told.
    fn place(&self, index: usize) -> usize {
        self.points.iter().find(|point| point.index == index).map_or(index, |point| point.at)
    }

    /// Share of the points of the branch of which this is known, 0 to 1.
    pub fn share(&self, verdict: Verdict) -> f64 {
        let number = self.verdicts().into_iter().filter(|found| *found == Some(verdict)).count();
        number as f64 / self.count as f64
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
                && found.amplitudes.len() == monitors
                && finite(&found.amplitudes)
                && pairs(&[found.multiplier])
                && found.omega.is_finite()
        };
        self.points.is_sorted_by(|a, b| a.index < b.index)
            && self.points.iter().all(|point| point.index.max(point.at) < self.count)
            && !self.points.is_empty()
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
        let at = orbit.as_ref().map_or(index, |orbit| passing(branch, index, orbit.omega));
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
