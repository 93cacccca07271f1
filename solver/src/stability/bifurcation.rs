//! Bifurcations of marched orbits: where a multiplier crosses the unit circle between two orbits of a branch.

use super::multipliers::{Multiplier, Outside, multipliers};
use super::shooting::{Orbit, Period, Point, Shooting, Way};
use crate::structure::Model;
use serde::{Deserialize, Serialize};

/// How a branch loses or regains stability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BifurcationKind {
    /// A real multiplier through 1, where the branch turns in frequency.
    Fold,
    /// A real multiplier through 1 where it does not: other responses of the same period branch off.
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
    /// Number of the point of the branch before it; the next one is after it.
    pub after: usize,
    /// The multiplier that crosses (of a pair either one), as found at the orbit.
    pub multiplier: Multiplier,
    /// Multipliers outside the unit circle before and after it, in the order of the arc.
    pub outside: [usize; 2],
    /// The orbit.
    pub orbit: Orbit,
}

/// An orbit with its multipliers.
#[derive(Debug, Clone)]
pub struct Known {
    /// The orbit.
    pub orbit: Orbit,
    /// Its multipliers, the largest first.
    pub multipliers: Vec<Multiplier>,
}

/// An orbit on the way from one to another.
struct Between {
    /// Share of the way.
    share: f64,
    multipliers: Vec<Multiplier>,
    found: Option<(Point, Period)>,
}

/// Most orbits that are computed to locate one bifurcation.
const EVALUATIONS: usize = 14;

/// A modulus as near to 1 as this is where it crosses: less than what the grid of time steps leaves uncertain.
const CROSSED: f64 = 1e-6;

/// Share of the way between two orbits to which a crossing is located if the modulus jumps, as it does where a contact
/// grazes.
const RESOLVED: f64 = 1e-3;

/// Where moduli at both ends of what is resolved are farther from 1 than this, they jump.
const JUMP: f64 = 0.02;

/// The bifurcations between two orbits that are neighbours on a branch, in the order of the arc. `after` is the number of
/// the point of the first one.
pub fn between(model: &Model, first: &Known, last: &Known, after: usize) -> Vec<Bifurcation> {
    // One grid for all of them: the finer one.
    let steps = first.orbit.steps.max(last.orbit.steps);
    let Ok(shooting) = Shooting::around(model, &Orbit { steps, ..first.orbit.clone() }) else { return Vec::new() };
    let (a, b) = (shooting.point_at(&first.orbit), shooting.point_at(&last.orbit));
    let Some(normal) = shooting.across(&a, &b) else { return Vec::new() };
    let mut search = Search { shooting, ends: [a, b], normal, after, found: Vec::new() };
    let end = |share, known: &Known| Between { share, multipliers: known.multipliers.clone(), found: None };
    search.locate(end(0.0, first), end(1.0, last));
    search.found
}

struct Search<'m> {
    shooting: Shooting<'m>,
    ends: [Point; 2],
    normal: Vec<f64>,
    after: usize,
    found: Vec<Bifurcation>,
}

impl Search<'_> {
    /// The orbit in the plane at a share of the way.
    fn at(&mut self, share: f64) -> Option<Between> {
        let [a, b] = &self.ends;
        let mix = |(a, b): (&f64, &f64)| a + share * (b - a);
        let start = Point { x: a.x.iter().zip(&b.x).map(mix).collect(), w: mix((&a.w, &b.w)) };
        let way = |searches| Way { plane: Some(&self.normal), searches, iterations: 10 };
        let found = match self.shooting.solve(&start, &way(false)) {
            Some(found) => found,
            None => self.shooting.solve(&start, &way(true))?,
        };
        let multipliers = multipliers(&found.1.monodromy).ok()?;
        Some(Between { share, multipliers, found: Some(found) })
    }

    /// Locates every bifurcation between two orbits.
    fn locate(&mut self, mut low: Between, mut high: Between) {
        for _ in 0..EVALUATIONS {
            let counts = [&low, &high].map(|end| Outside::of(&end.multipliers).count());
            if counts[0] == counts[1] {
                return;
            }
            let values = [&low, &high].map(|end| crossing(&end.multipliers, counts));
            let near = values.map(|value| value.abs() < CROSSED);
            if near != [false, false] || high.share - low.share < RESOLVED {
                break;
            }
            // Regula falsi, kept away from the ends: where it stalls, this is a bisection.
            let straight = values[0] / (values[0] - values[1]);
            let share = low.share + straight.clamp(0.1, 0.9) * (high.share - low.share);
            let Some(middle) = self.at(share) else { return };
            let count = Outside::of(&middle.multipliers).count();
            if count != counts[0] && count != counts[1] {
                // There are several: each in its own part.
                let copy = Between { share, multipliers: middle.multipliers.clone(), found: None };
                self.locate(low, copy);
                self.locate(middle, high);
                return;
            }
            if count == counts[0] { low = middle } else { high = middle }
        }
        self.accept(low, high);
    }

    /// Adds the bifurcation between two orbits close to each other.
    fn accept(&mut self, low: Between, high: Between) {
        let outside = [&low, &high].map(|end| Outside::of(&end.multipliers));
        let counts = outside.map(|outside| outside.count());
        let nearer = |end: &Between| crossing(&end.multipliers, counts).abs();
        let crosses_at_low = nearer(&low) < nearer(&high);
        let near = if crosses_at_low { &low } else { &high };
        let number = counts[0].min(counts[1]);
        let multiplier = near.multipliers[number];
        let jumps = [&low, &high].into_iter().all(|end| nearer(end) > JUMP);
        let kind = match (multiplier.is_real(), multiplier.re > 0.0) {
            _ if jumps => BifurcationKind::Grazing,
            (false, _) => BifurcationKind::NeimarkSacker,
            (true, false) => BifurcationKind::PeriodDoubling,
            (true, true) if self.turns(&low, &high) => BifurcationKind::Fold,
            (true, true) => BifurcationKind::BranchPoint,
        };
        let (near, far) = if crosses_at_low { (low, high) } else { (high, low) };
        let middle = || self.at(0.5 * (near.share + far.share)).and_then(|between| between.found);
        let Some((point, period)) = near.found.or(far.found).or_else(middle) else { return };
        let orbit = self.shooting.orbit(&point);
        self.found.push(Bifurcation {
            kind,
            omega: orbit.omega,
            amplitudes: period.amplitudes,
            after: self.after,
            multiplier,
            outside: counts,
            orbit,
        });
    }

    /// Whether the branch turns in frequency between two orbits: it goes on to higher frequencies at one of them and to
    /// lower ones at the other.
    fn turns(&mut self, low: &Between, high: &Between) -> bool {
        let ways = [low, high].map(|end| match &end.found {
            Some((point, period)) => self.shooting.advance(point, period, &self.normal),
            None => {
                let (point, period) = self.at(end.share)?.found?;
                self.shooting.advance(&point, &period, &self.normal)
            }
        });
        matches!(ways, [Some(before), Some(after)] if before * after < 0.0)
    }
}

/// What changes sign where the count of multipliers outside changes between two: the modulus, less 1, of the first one that
/// is inside at one end and outside at the other. It is continuous, even where two real multipliers merge into a pair.
fn crossing(multipliers: &[Multiplier], counts: [usize; 2]) -> f64 {
    multipliers[counts[0].min(counts[1])].modulus() - 1.0
}
