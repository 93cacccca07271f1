//! Bifurcations of marched orbits: where a multiplier crosses the unit circle between two orbits of a branch.

use super::crossing::{Crossing, Event};
use super::multipliers::{Multiplier, Outside};
use super::shooting::{NewtonOptions, Orbit, Period, Point, Shooting};
use crate::structure::Model;
use serde::{Deserialize, Serialize};
use std::rc::Rc;

/// How a branch loses or regains stability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BifurcationKind {
    /// A real multiplier through 1, where the branch turns in frequency.
    Fold,
    /// A real multiplier through 1 where it does not: other responses of the same period branch off. Or the branch itself branches
    /// off another one there, and turns into its own image.
    BranchPoint,
    /// A real multiplier through −1: responses of twice the period branch off.
    PeriodDoubling,
    /// A complex pair through the circle: quasi-periodic motion branches off.
    NeimarkSacker,
    /// Multipliers jump over the circle: a contact is grazed.
    Grazing,
}

impl BifurcationKind {
    /// Its name in files and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::BranchPoint => "branch_point",
            Self::PeriodDoubling => "period_doubling",
            Self::NeimarkSacker => "neimark_sacker",
            Self::Grazing => "grazing",
        }
    }
}

impl std::fmt::Display for BifurcationKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// A bifurcation of the marched orbits of a branch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bifurcation {
    /// What happens.
    pub kind: BifurcationKind,
    /// Marched frequency ω, rad/s.
    pub omega: f64,
    /// Largest |x| of each monitored dof of the orbit there, m.
    pub amplitudes: Vec<f64>,
    /// Number of the point of the branch before it; the next one that is polished is after it.
    pub after: usize,
    /// The multiplier that crosses (of a pair either one), as found at the orbit; where multipliers jump, the one outside.
    pub multiplier: Multiplier,
    /// Multipliers outside the unit circle before and after it, in the order of the arc.
    pub outside: [usize; 2],
    /// Share of the way between these points within which it was found; smooth crossings are known better than that.
    pub width: f64,
    /// The orbit.
    pub orbit: Orbit,
}

/// Multipliers that cross somewhere between two orbits, but where and how is not known.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unresolved {
    /// Number of the point of the branch before it.
    pub first: usize,
    /// Number of the point after it.
    pub last: usize,
    /// Multipliers outside the unit circle at both.
    pub outside: [usize; 2],
    /// Why it is not known.
    pub reason: Obstacle,
}

/// Why a crossing could not be located.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Obstacle {
    /// Newton's method came to no orbit on the way.
    NotConverged,
    /// Several multipliers cross so near each other that they cannot be told apart.
    Several,
    /// A multiplier is as near to the circle as the grid of time steps leaves uncertain.
    WithinNoise,
    /// There are points in between without an orbit.
    NoOrbit,
    /// As many orbits as were allowed had been computed.
    Budget,
    /// Cancelled before.
    Cancelled,
}

/// An orbit with its multipliers.
#[derive(Debug, Clone)]
pub struct Known {
    /// The orbit.
    pub orbit: Orbit,
    /// Its multipliers, the largest first.
    pub multipliers: Vec<Multiplier>,
    /// Moduli that are 1 within this are not known to be on either side.
    pub margin: f64,
}

impl Known {
    /// The multipliers that are outside beyond doubt.
    pub fn outside(&self) -> Outside {
        Outside::of(&self.multipliers, self.margin)
    }

    /// What happens on the way to another orbit beyond doubt; `None` if a multiplier that crosses is not known to have left
    /// the circle at both ends.
    pub(super) fn event(&self, last: &Self) -> Option<Event> {
        let by = |sign: f64| {
            let ends = [self, last].map(|end| Outside::of(&end.multipliers, sign * end.margin));
            (Event::between(&ends[0], &ends[1]), ends[0].count() < ends[1].count())
        };
        (by(1.0) == by(-1.0)).then(|| by(1.0).0)
    }
}

/// What was found between two orbits, in the order of the arc.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Changes {
    /// Bifurcations.
    pub bifurcations: Vec<Bifurcation>,
    /// Crossings that could not be located.
    pub unresolved: Vec<Unresolved>,
}

/// An orbit on the way from one to another.
#[derive(Clone)]
struct Between {
    /// Known orbits up to it, and the share of the way to the next one.
    share: f64,
    /// What is taken to be outside.
    outside: Outside,
    multipliers: Vec<Multiplier>,
    /// Whether a multiplier is so near the circle that what is outside is not known.
    is_doubtful: bool,
    point: Rc<Point>,
    /// Its period, if that was marched here.
    period: Option<Rc<Period>>,
}

impl Between {
    fn new(share: f64, (multipliers, margin): (&[Multiplier], f64), point: Point, period: Option<Period>) -> Self {
        Self {
            share,
            outside: Outside::of(multipliers, 0.0),
            is_doubtful: multipliers.iter().any(|mu| mu.excess().abs() <= margin),
            multipliers: multipliers.to_vec(),
            point: point.into(),
            period: period.map(Rc::new),
        }
    }
}

/// Most orbits that are computed to locate one bifurcation: twice as many as bisection to [`FINEST`] needs.
const EVALUATIONS: usize = 34;

/// Most orbits that are computed between two neighbours of a branch.
const MOST: usize = 10 * EVALUATIONS;

/// A modulus as near to 1 as this is where it crosses: less than what the grid of time steps leaves uncertain.
const CROSSED: f64 = 1e-6;

/// Share of the way between two orbits to which a crossing is located if the modulus jumps, as it does where a contact
/// grazes.
const RESOLVED: f64 = 1e-3;

/// The same share where it still jumps at that one: behind the touch of an elastic stop a modulus changes like a square root, and
/// crosses where it has hardly begun to.
const FINEST: f64 = 1e-5;

/// Largest distance of an orbit between two neighbours from the straight way between them, in shares of its length: in the plane
/// across it there may be others far away.
const REACH: f64 = 1.0;
/// The way between orbits that are all but one is taken to be this long, scaled.
const SHORT: f64 = 1e-3;

/// Least distance of a multiplier from 1 where the direction of the branch is asked for: nearer to it, Φ − I is singular.
const FIRM: f64 = 1e-3;

/// The bifurcations on the way along a branch from one orbit to another; `path`: both, and those that are known between them, with
/// their numbers on the branch.
pub fn between(model: &Model, path: &[(usize, Known)]) -> Changes {
    let mut changes = Changes::default();
    let [(from, first), .., (to, last)] = path else { return changes };
    let outside = [first.outside(), last.outside()];
    let all = |reason| Unresolved { first: *from, last: *to, outside: outside.map(|outside| outside.count()), reason };
    match first.event(last) {
        Some(Event::Nothing) => return changes,
        Some(_) => {}
        None => {
            changes.unresolved.push(all(Obstacle::WithinNoise));
            return changes;
        }
    }
    let Some(mut search) = Search::new(model, path) else {
        changes.unresolved.push(all(Obstacle::NotConverged));
        return changes;
    };
    let end = |known: &Between, outside| Between { outside, is_doubtful: false, ..known.clone() };
    let [low, .., high] = &search.path[..] else { return changes };
    let (low, high) = (end(low, outside[0]), end(high, outside[1]));
    search.locate(low, high);
    search.found
}

struct Search<'m> {
    shooting: Shooting<'m>,
    /// Orbits that were known before, in the order of the arc.
    path: Vec<Between>,
    /// From each of them to the next one.
    normals: Vec<Vec<f64>>,
    /// Their numbers on the branch.
    numbers: Vec<usize>,
    /// Orbits that were looked for.
    orbits: usize,
    found: Changes,
}

impl<'m> Search<'m> {
    fn new(model: &'m Model, path: &[(usize, Known)]) -> Option<Self> {
        // One grid for all of them: the finest one.
        let steps = path.iter().map(|(_, known)| known.orbit.steps).max()?;
        let shooting = Shooting::around(model, &Orbit { steps, ..path[0].1.orbit.clone() }).ok()?;
        let numbers = path.iter().map(|(number, _)| *number).collect();
        let known = |(i, (_, known)): (usize, &(usize, Known))| {
            let point = shooting.point_at(&known.orbit);
            Between::new(i as f64, (&known.multipliers, known.margin), point, None)
        };
        let path: Vec<Between> = path.iter().enumerate().map(known).collect();
        let normals =
            path.windows(2).map(|pair| shooting.across(&pair[0].point, &pair[1].point)).collect::<Option<_>>()?;
        Some(Self { shooting, path, normals, numbers, orbits: 0, found: Changes::default() })
    }

    /// The interval between known orbits that a share of the way lies in.
    fn interval(&self, share: f64) -> usize {
        (share as usize).min(self.normals.len() - 1)
    }

    /// The orbit in the plane at a share of the way from one orbit to another.
    fn at(&mut self, low: &Between, high: &Between, part: f64) -> Option<Between> {
        self.orbits += 1;
        let (a, b) = (&low.point, &high.point);
        let mix = |(a, b): (&f64, &f64)| a + part * (b - a);
        let start = Point { x: a.x.iter().zip(&b.x).map(mix).collect(), w: mix((&a.w, &b.w)) };
        let share = low.share + part * (high.share - low.share);
        let interval = self.interval(share);
        let normal = &self.normals[interval];
        let length = self.shooting.distance(&self.path[interval].point, &self.path[interval + 1].point);
        let reach = REACH * length.max(SHORT);
        let mut solved = |searches| {
            let options = NewtonOptions { plane: Some(normal), searches, iterations: 10 };
            let found = self.shooting.solve(&start, &options);
            found.filter(|(point, _)| self.shooting.distance(&start, point) < reach)
        };
        let (point, period) = solved(false).or_else(|| solved(true))?;
        let multipliers = period.multipliers().ok()?;
        let margin = self.shooting.margin(&point, &period);
        Some(Between::new(share, (&multipliers, margin), point, Some(period)))
    }

    /// An orbit between two: a known one, and otherwise if possible at this share of the way between them.
    fn inside(&mut self, low: &Between, high: &Between, share: f64) -> Option<Between> {
        let known: Vec<&Between> =
            self.path.iter().filter(|known| low.share < known.share && known.share < high.share).collect();
        if let Some(known) = known.get(known.len() / 2) {
            return Some((*known).clone());
        }
        [share, 0.5, 0.35, 0.65, 0.1, 0.9].into_iter().find_map(|part| self.at(low, high, part))
    }

    /// Locates every bifurcation between two orbits.
    fn locate(&mut self, mut low: Between, mut high: Between) {
        let event = Event::between(&low.outside, &high.outside);
        if event == Event::Nothing {
            return;
        }
        let mut firm = [low.clone(), high.clone()];
        let mut is_halved = true;
        for _ in 0..EVALUATIONS {
            let width = high.share - low.share;
            let values = values(event, &low, &high);
            let is_located = width < FINEST || (width < RESOLVED && !jumps(event, &low, &high));
            if is_located || values.iter().flatten().any(|value| value.abs() < CROSSED) {
                break;
            }
            // Regula falsi, and bisection wherever that has stalled.
            let straight = match values {
                [Some(a), Some(b)] if is_halved => (a / (a - b)).clamp(0.01, 0.99),
                _ => 0.5,
            };
            if self.orbits >= MOST {
                return self.give_up(&low, &high, Obstacle::Budget);
            }
            let Some(mut middle) = self.inside(&low, &high, straight) else {
                return self.give_up(&low, &high, Obstacle::NotConverged);
            };
            let is_same = |end: &Between| Event::between(&middle.outside, &end.outside) == Event::Nothing;
            let goes_low = match (is_same(&low), is_same(&high)) {
                (false, false) if !middle.is_doubtful || event == Event::Several => {
                    // There are several: each in its own part.
                    self.locate(low, middle.clone());
                    return self.locate(middle, high);
                }
                (false, false) => event.is_nearer(&low.outside, &high.outside, &middle.outside),
                (is_low, _) => is_low,
            };
            let end = if goes_low { &mut low } else { &mut high };
            middle.outside = end.outside;
            *end = middle;
            is_halved = high.share - low.share <= 0.5 * width;
            let [first, last] = self::values(event, &low, &high).map(|value| value.is_some_and(|v| v.abs() >= FIRM));
            if goes_low && first {
                firm[0] = low.clone();
            } else if !goes_low && last {
                firm[1] = high.clone();
            }
        }
        self.accept(event, low, high, firm);
    }

    /// Adds the bifurcation between two orbits close to each other. `firm`: orbits before and after it at which the multiplier
    /// that crosses is not yet near the circle.
    fn accept(&mut self, event: Event, low: Between, high: Between, firm: [Between; 2]) {
        let Some(crossing) = crossing(event, &low, &high) else {
            return self.give_up(&low, &high, Obstacle::Several);
        };
        let (outer, inner) = crossing.excess();
        let width = high.share - low.share;
        let is_smooth = outer < CROSSED || inner.is_some_and(|inner| inner > -CROSSED);
        let jumps = !is_smooth && width < RESOLVED && crossing.jumps();
        let kind = match event {
            _ if jumps => BifurcationKind::Grazing,
            Event::AtMinusOne => BifurcationKind::PeriodDoubling,
            Event::Pair if !crossing.outer.is_real() => BifurcationKind::NeimarkSacker,
            Event::AtOne => match self.turns(firm) {
                Some(true) => BifurcationKind::Fold,
                Some(false) => BifurcationKind::BranchPoint,
                None => return self.give_up(&low, &high, Obstacle::NotConverged),
            },
            _ => return self.give_up(&low, &high, Obstacle::Several),
        };
        let outside = [&low, &high].map(|end| end.outside.count());
        let is_low_outer = outside[0] > outside[1];
        let at_outer = jumps || crossing.inner.is_none_or(|inner| outer < inner.excess().abs());
        let (near, far) = if is_low_outer == at_outer { (low, high) } else { (high, low) };
        let is_marched = |orbit: &Between| orbit.period.is_some();
        // Of a known one, at which the crossing may be, the period is marched once more.
        let marched = Some(near.clone()).filter(is_marched).or_else(|| self.at(&near, &far, 0.0));
        let marched = marched.or_else(|| Some(far.clone()).filter(is_marched)).or_else(|| self.at(&near, &far, 0.5));
        let Some(Between { point, period: Some(period), .. }) = marched else {
            let (low, high) = if near.share < far.share { (near, far) } else { (far, near) };
            return self.give_up(&low, &high, Obstacle::NotConverged);
        };
        let orbit = self.shooting.orbit(&point);
        self.found.bifurcations.push(Bifurcation {
            kind,
            omega: orbit.omega,
            amplitudes: period.amplitudes.clone(),
            after: self.numbers[self.interval(near.share.min(far.share))],
            multiplier: crossing.inner.filter(|_| !at_outer).unwrap_or(crossing.outer),
            outside,
            width,
            orbit,
        });
    }

    fn give_up(&mut self, low: &Between, high: &Between, reason: Obstacle) {
        let (first, last) = (self.numbers[self.interval(low.share)], self.numbers[high.share.ceil() as usize]);
        let outside = [low, high].map(|end| end.outside.count());
        self.found.unresolved.push(Unresolved { first, last, outside, reason });
    }

    /// Whether the branch turns in frequency between two orbits: it goes on to higher frequencies at one of them and to
    /// lower ones at the other.
    fn turns(&mut self, ends: [Between; 2]) -> Option<bool> {
        let [before, after] = ends.map(|end| {
            let marched = if end.period.is_some() { end } else { self.at(&end, &end, 0.0)? };
            let normal = &self.normals[self.interval(marched.share)];
            self.shooting.advance(&marched.point, marched.period.as_ref()?, normal)
        });
        Some(before? * after? < 0.0)
    }
}

/// The crossing between two orbits, the one with fewer multipliers outside being the inner one.
fn crossing(event: Event, low: &Between, high: &Between) -> Option<Crossing> {
    let (outer, inner) = if low.outside.count() > high.outside.count() { (low, high) } else { (high, low) };
    Crossing::of(event, &outer.multipliers, &inner.multipliers)
}

/// Whether the multiplier that crosses is far from where it comes from.
fn jumps(event: Event, low: &Between, high: &Between) -> bool {
    crossing(event, low, high).is_some_and(|crossing| crossing.jumps())
}

/// |μ| − 1 of the multiplier that crosses, at both orbits, as far as it is known there.
fn values(event: Event, low: &Between, high: &Between) -> [Option<f64>; 2] {
    let Some(crossing) = crossing(event, low, high) else { return [None; 2] };
    let (outer, inner) = crossing.excess();
    if low.outside.count() > high.outside.count() { [Some(outer), inner] } else { [inner, Some(outer)] }
}
