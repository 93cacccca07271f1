//! Branches as curves in frequency and harmonics of all displacements.

use super::study::Listed;
use solver::curve::outcome::Stop;
use solver::{Branch, Model, Outcome};

/// A point of a curve: frequency, and harmonics of all displacements.
#[derive(Clone)]
pub struct Place {
    pub omega: f64,
    pub motion: Vec<f64>,
}

fn norm(z: impl Iterator<Item = f64>) -> f64 {
    z.map(|z| z * z).sum::<f64>().sqrt()
}

impl Place {
    /// Size of the motion, m.
    pub fn size(&self) -> f64 {
        norm(self.motion.iter().copied())
    }

    /// Relative distance: the larger one of that in frequency and that in the motion, of `self`'s.
    pub fn distance(&self, other: &Place) -> f64 {
        let motion = norm(self.motion.iter().zip(&other.motion).map(|(a, b)| a - b)) / self.size();
        motion.max((self.omega - other.omega).abs() / self.omega)
    }

    /// Σ weight · place.
    fn combined(terms: &[(f64, &Place)]) -> Place {
        let motion = (0..terms[0].1.motion.len()).map(|i| terms.iter().map(|(w, p)| w * p.motion[i]).sum()).collect();
        Place { omega: terms.iter().map(|(w, p)| w * p.omega).sum(), motion }
    }
}

/// A branch as a curve.
pub struct Curve {
    pub places: Vec<Place>,
    pub dofs: usize,
    pub is_closed: bool,
    /// Why its first and its last point are where it ends, unless it is closed.
    ends: [Option<Stop>; 2],
}

/// Relative distance from a branch point within which what branches off may run along what it branches off.
const NEXT_TO: f64 = 1e-4;

/// Relative distance from which on a place is not on a curve, however coarse that is.
const NEAR: f64 = 0.01;

/// Frequencies and sizes of the motions along a chord: few chords have those of a place.
struct Span {
    omega: (f64, f64),
    size: (f64, f64),
}

impl Span {
    fn of(a: &Place, b: &Place) -> Self {
        let (largest, length) = (a.size().max(b.size()), norm(a.motion.iter().zip(&b.motion).map(|(a, b)| a - b)));
        Self { omega: (a.omega.min(b.omega), a.omega.max(b.omega)), size: (largest - length, largest) }
    }

    /// The chord is at least so far from a place of this frequency and size, relative to these.
    fn at_least(&self, omega: f64, size: f64) -> f64 {
        let beyond = |value: f64, (low, high): (f64, f64)| (low - value).max(value - high).max(0.0) / value;
        beyond(omega, self.omega).max(beyond(size, self.size))
    }
}

impl Curve {
    pub fn of(model: &Model, branch: &Branch) -> Self {
        let place = |point: &solver::BranchPoint| Place {
            omega: point.omega(),
            motion: (0..model.size()).flat_map(|dof| point.state.displacement(model, dof)).collect(),
        };
        let ends = match branch.outcome {
            Outcome::Open(first, last) => [Some(first), Some(last)],
            Outcome::Closed => [None; 2],
        };
        let (places, dofs) = (branch.points.iter().map(place).collect(), model.size());
        Self { places, dofs, is_closed: branch.is_closed(), ends }
    }

    /// Relative distance of a place from the curve, that is from the cubic through the four points nearest to it along the curve, or
    /// from the chord if that is nearer; and how far cubic and chord are apart there.
    pub fn distance(&self, place: &Place) -> (f64, f64) {
        self.distance_among(0..self.places.len().saturating_sub(1), place)
    }

    /// The same of these chords, by number.
    fn distance_among(&self, among: impl Iterator<Item = usize>, place: &Place) -> (f64, f64) {
        let chord = |i: usize| {
            let (a, b) = (&self.places[i], &self.places[i + 1]);
            let (size, omega) = (place.size(), place.omega);
            let scaled = |from: &Place, to: &Place| -> Vec<f64> {
                let motion = to.motion.iter().zip(&from.motion).map(|(t, f)| (t - f) / size);
                motion.chain([(to.omega - from.omega) / omega]).collect()
            };
            let (along, across) = (scaled(a, b), scaled(a, place));
            let square: f64 = along.iter().map(|z| z * z).sum();
            let product: f64 = along.iter().zip(&across).map(|(a, b)| a * b).sum();
            let share = if square > 0.0 { (product / square).clamp(0.0, 1.0) } else { 0.0 };
            let apart = place.distance(&Place::combined(&[(1.0 - share, a), (share, b)]));
            (apart, share)
        };
        let last = self.places.len().saturating_sub(1);
        let nearest = among.map(|i| (i, chord(i))).min_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let Some((i, (rough, share))) = nearest else { return (f64::INFINITY, 0.0) };
        if last < 3 {
            return (rough, 0.0);
        }
        let first = i.saturating_sub(1).min(last - 3);
        let (inside, four) = (i - first, [0, 1, 2, 3].map(|j| &self.places[first + j]));
        let mut at = [0.0; 4];
        for j in 1..4 {
            at[j] = at[j - 1] + four[j].distance(four[j - 1]).max(f64::MIN_POSITIVE);
        }
        let cubic = |t: f64| {
            let weight = |j: usize| (0..4).filter(|&k| k != j).map(|k| (t - at[k]) / (at[j] - at[k])).product::<f64>();
            Place::combined(&[0, 1, 2, 3].map(|j| (weight(j), four[j])))
        };
        let near = |t: f64| place.distance(&cubic(t));
        let (mut low, mut high) = (at[inside], at[inside + 1]);
        for _ in 0..40 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if near(a) < near(b) { high = b } else { low = a }
        }
        let chord_at = Place::combined(&[(1.0 - share, four[inside]), (share, four[inside + 1])]);
        let bulge = cubic(at[inside] + share * (at[inside + 1] - at[inside])).distance(&chord_at);
        (near(0.5 * (low + high)).min(rough), bulge)
    }

    /// The same without the steps at whose ends it is said to come to another branch, and without what is next to where it branches
    /// off one.
    fn apart(&self) -> Self {
        let count = self.places.len();
        let spare = |end: usize, along: &mut dyn Iterator<Item = &Place>| match self.ends[end] {
            Some(Stop::Joined) => 1,
            Some(Stop::Branching) => {
                let branch_point = &self.places[end * (count - 1)];
                along.take_while(|place| branch_point.distance(place) < NEXT_TO).count()
            }
            _ => 0,
        };
        let (first, last) = (spare(0, &mut self.places.iter()), spare(1, &mut self.places.iter().rev()));
        let own = first..(count - last).max(first);
        Self { places: self.places[own].to_vec(), ends: [None; 2], ..*self }
    }

    /// Whether a stretch of `other` runs along this curve: a few successive points of it lie on it.
    pub fn shares_a_stretch_of(&self, other: &Curve) -> bool {
        const SAME: f64 = 1e-5;
        let (mut successive, curve) = (0, self.apart());
        let spans: Vec<Span> = curve.places.windows(2).map(|pair| Span::of(&pair[0], &pair[1])).collect();
        other.apart().places.iter().any(|place| {
            let size = place.size();
            let near = (0..spans.len()).filter(|&i| spans[i].at_least(place.omega, size) < NEAR);
            let (distance, bulge) = curve.distance_among(near, place);
            successive = if distance < SAME + 0.02 * bulge { successive + 1 } else { 0 };
            successive == 3 || distance < 0.1 * SAME
        })
    }

    /// Largest angle between two successive motions, rad.
    pub fn largest_turn(&self) -> (f64, f64) {
        let angle = |pair: &[Place]| {
            let product: f64 = pair[0].motion.iter().zip(&pair[1].motion).map(|(a, b)| a * b).sum();
            ((product / (pair[0].size() * pair[1].size())).clamp(-1.0, 1.0).acos(), pair[0].omega)
        };
        self.places.windows(2).map(angle).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0.0))
    }

    /// Why a curve that is said to be closed is not, if it is not: its last point is no farther from its first than
    /// neighbours there are from each other, and the way on from the last to the first goes on as it does before and after.
    pub fn why_open(&self) -> Option<String> {
        let count = self.places.len();
        if !self.is_closed {
            return Some("it is not said to be closed".into());
        }
        if count < 8 {
            return Some(format!("{count} points"));
        }
        let at = |i: usize| &self.places[i % count];
        let step = |i: usize| at(i).distance(at(i + 1));
        let gap = step(count - 1);
        let neighbours = || (0..3).chain(count - 4..count - 1);
        let largest = neighbours().map(step).fold(0.0, f64::max);
        if gap > 2.0 * largest {
            return Some(format!("the last point is {gap:.1e} from the first, neighbours {largest:.1e}"));
        }
        // The same for every dof: a sheet may be near another in all but a small part of the motion.
        let width = at(0).motion.len() / self.dofs;
        for dof in 0..self.dofs {
            let part = |i: usize| at(i).motion[dof * width..(dof + 1) * width].iter();
            let step = |i: usize| norm(part(i).zip(part(i + 1)).map(|(a, b)| a - b));
            let (gap, largest) = (step(count - 1), neighbours().map(step).fold(0.0, f64::max));
            if gap > 3.0 * largest + 1e-6 * norm(part(0).copied()) {
                return Some(format!("dof {dof} is {gap:.1e} m from where it began, neighbours {largest:.1e} m"));
            }
        }
        let cosine = |i: usize| {
            let along = |i: usize| -> Vec<f64> {
                let motion = at(i + 1).motion.iter().zip(&at(i).motion).map(|(b, a)| (b - a) / at(i).size());
                motion.chain([(at(i + 1).omega - at(i).omega) / at(i).omega]).collect()
            };
            let (a, b) = (along(i), along(i + 1));
            let product: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
            product / (norm(a.into_iter()) * norm(b.into_iter()))
        };
        // A short last step says nothing of the direction.
        let corner = if gap < 0.01 * largest { 1.0 } else { cosine(count - 2).min(cosine(count - 1)) };
        (corner < 0.5).then(|| format!("it turns by {:.0}° where it closes", corner.acos().to_degrees()))
    }
}

/// What is wrong with the branches of a level as curves; nothing, if nothing is.
pub fn complaints(model: &Model, level: &[Listed]) -> Vec<String> {
    let curves: Vec<Curve> = level.iter().map(|listed| Curve::of(model, &listed.branch)).collect();
    let mut complaints = Vec::new();
    for (i, (listed, curve)) in level.iter().zip(&curves).enumerate() {
        if listed.kind == super::study::Kind::Isola
            && let Some(why) = curve.why_open()
        {
            complaints.push(format!("{} is an isola, but {why}", listed.name));
        }
        let (turn, omega) = curve.largest_turn();
        if turn > std::f64::consts::FRAC_PI_2 {
            complaints.push(format!(
                "{} turns by {:.0}° in a step at {omega:.8} rad/s",
                listed.name,
                turn.to_degrees()
            ));
        }
        for (other, along) in level.iter().zip(&curves).skip(i + 1) {
            if curve.shares_a_stretch_of(along) || along.shares_a_stretch_of(curve) {
                complaints.push(format!("{} and {} share a stretch", listed.name, other.name));
            }
        }
    }
    complaints
}
