//! Branches that pass through each other: a closed curve through a main branch is no isola, though none of its points lies on the
//! main branch. In a cyclic structure, say, motions that lose a symmetry of the structure leave the main branch at one point and come back to
//! it at another.

use crate::curve::problem::{inner, norm, weighted};
use crate::formulation::Formulation;
use crate::formulation::state::State;
use crate::response::branch::Branch;
use crate::response::forced::Forced;

/// Cosine between what separates two neighbouring points of a curve from another one, below which it passes through that one.
const OPPOSITE: f64 = -0.5;

/// Largest distance of the place between them from the other curve, as a share of theirs.
const BETWEEN: f64 = 0.2;

/// How far beyond the ends of a chord that place may be.
const OVERLAP: f64 = 0.2;

/// Of the width of a curve, how far its points that are looked at are from each other, at least, the coarsest first: next to branch
/// points they may be many times nearer, and two branch points may be near to each other.
const SPACINGS: [f64; 3] = [2.5e-2, 2.5e-3, 2.5e-4];

/// How far the other curve may be from a chord of it, as a share of the distance of those points.
const SAG: f64 = 0.1;

/// Most bisections of a chord.
const DEPTH: usize = 6;

/// Crossings nearer than this, in numbers of points of the curve that is crossed, are one.
const SAME: f64 = 1e-2;

/// Relative distance of a state of a curve from what is interpolated between its points.
const NEAR: f64 = 0.05;

/// Whether a closed curve passes through another one where that has a branch point: from a point to the next it changes sides,
/// and along the other one, there, the determinant of the Jacobian bordered by the tangent changes its sign, as it does where another
/// solution crosses and nowhere else.
pub(super) fn passes_through<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    closed: &Branch,
    other: &Branch,
) -> bool {
    SPACINGS.into_iter().any(|share| passes_through_by(forced, closed, other, share))
}

/// The same by points of the closed curve that are so far apart, as a share of its width.
fn passes_through_by<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    closed: &Branch,
    other: &Branch,
    share: f64,
) -> bool {
    let (points, spacing) = spaced(forced, closed, share);
    let (low, high) = closed.frequency_range();
    let states = other.points.iter().map(|point| point.state.clone()).collect();
    let states = refined(forced, states, (low, high), SAG * spacing);
    let places = crossings(forced, &points, &states);
    // Beside each, and between it and the next ones.
    (0..places.len()).any(|k| {
        let middle = |neighbour: Option<&f64>| neighbour.map(|place| f64::midpoint(*place, places[k]));
        let before = middle(k.checked_sub(1).map(|k| &places[k])).unwrap_or(f64::MIN).max(places[k] - 1.0);
        let after = middle(places.get(k + 1)).unwrap_or(f64::MAX).min(places[k] + 1.0);
        let signs = [before, after].map(|place| orientation(forced, &states, place));
        matches!(signs, [Some(before), Some(after)] if before != after)
    })
}

/// Points of a closed curve that are not too near to each other, the first one again as the last, and how far apart they are at least.
fn spaced<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, closed: &Branch, share: f64) -> (Vec<State>, f64) {
    let problem = forced.problem();
    let metric = problem.metric().to_vec();
    let distance = |a: &[f64], b: &[f64]| norm(&metric, &difference(a, b));
    let all: Vec<Vec<f64>> = closed.points.iter().map(|point| problem.encode(&point.state)).collect();
    let width = all.iter().map(|y| distance(y, &all[0])).fold(0.0, f64::max);
    let spacing = share * width;
    let mut kept = vec![0];
    for (index, y) in all.iter().enumerate() {
        if distance(y, &all[kept[kept.len() - 1]]) >= spacing {
            kept.push(index);
        }
    }
    (kept.into_iter().chain([0]).map(|index| closed.points[index].state.clone()).collect(), spacing)
}

/// The states of a curve, between these frequencies with more of them, until it is no farther from its chords than `sag`.
fn refined<'m, F: Formulation<'m>>(
    forced: &mut Forced<'m, F>,
    mut states: Vec<State>,
    (low, high): (f64, f64),
    sag: f64,
) -> Vec<State> {
    for _ in 0..DEPTH {
        let mut more = Vec::with_capacity(2 * states.len());
        for pair in states.windows(2) {
            more.push(pair[0].clone());
            let is_level = pair[0].omega.max(pair[1].omega) >= low && pair[0].omega.min(pair[1].omega) <= high;
            if is_level && let Some(state) = between(forced, pair, 0.5) {
                let problem = forced.problem();
                let chord = problem.encode(&pair[0].interpolate(&pair[1], 0.5));
                let away = difference(&problem.encode(&state), &chord);
                if norm(problem.metric(), &away) > sag {
                    more.push(state);
                }
            }
        }
        more.extend(states.last().cloned());
        if more.len() == states.len() {
            break;
        }
        states = more;
    }
    states
}

/// The state of a curve between two of its points, if it converges near to what is interpolated.
fn between<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, pair: &[State], share: f64) -> Option<State> {
    let guess = pair[0].interpolate(&pair[1], share);
    forced.converge(&guess).ok().filter(|state| forced.distance(state, &guess) < NEAR)
}

/// Where a curve changes sides of another one: numbers of its states, and between them the share of the way to the next, in order.
fn crossings<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, points: &[State], states: &[State]) -> Vec<f64> {
    let (steps, chords) = (chords(forced, points), chords(forced, states));
    let metric = forced.problem().metric();
    let of_step = |step: &Chord| {
        let near = chords.iter().enumerate().filter(|(_, chord)| chord.is_level_with(step));
        near.filter_map(|(index, chord)| Some(index as f64 + chord.crossed_at(metric, step)?)).collect::<Vec<f64>>()
    };
    let mut places: Vec<f64> = steps.iter().flat_map(of_step).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|a, b| *a - *b < SAME);
    places
}

/// Sign of the determinant at a place of a curve, which is bordered by the direction to the next state; none if there is no telling.
fn orientation<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, states: &[State], place: f64) -> Option<f64> {
    let index = (place.max(0.0) as usize).min(states.len().checked_sub(2)?);
    let pair = &states[index..index + 2];
    let state = between(forced, pair, (place - index as f64).clamp(0.0, 1.0))?;
    let problem = forced.problem();
    let row = weighted(problem.metric(), &difference(&problem.encode(&pair[1]), &problem.encode(&pair[0])));
    let mut y = problem.encode(&state);
    problem.linearise(&mut y).is_finite().then_some(())?;
    problem.factor(&row).ok()?;
    Some(problem.orientation())
}

/// Two neighbouring points of a curve.
struct Chord {
    ends: [Vec<f64>; 2],
    omega: [f64; 2],
}

/// From state to state.
fn chords<'m, F: Formulation<'m>>(forced: &mut Forced<'m, F>, states: &[State]) -> Vec<Chord> {
    let problem = forced.problem();
    let points: Vec<Vec<f64>> = states.iter().map(|state| problem.encode(state)).collect();
    let chord = |(y, pair): (&[Vec<f64>], &[State])| Chord {
        ends: [y[0].clone(), y[1].clone()],
        omega: [pair[0].omega, pair[1].omega],
    };
    points.windows(2).zip(states.windows(2)).map(chord).collect()
}

impl Chord {
    /// Whether another one may cross it: there are frequencies that both have, or nearly.
    fn is_level_with(&self, other: &Self) -> bool {
        let span = |chord: &Self| {
            let [a, b] = chord.omega;
            let width = (b - a).abs();
            (a.min(b) - width, a.max(b) + width)
        };
        let ((low, high), (other_low, other_high)) = (span(self), span(other));
        low <= other_high && other_low <= high
    }

    /// Which share of the way along it a step of another curve leads from one side of it to the other, if it does.
    fn crossed_at(&self, metric: &[f64], step: &Self) -> Option<f64> {
        let [a, b] = &self.ends;
        let along = difference(b, a);
        let square = inner(metric, &along, &along);
        let share = |point: &[f64]| inner(metric, &along, &difference(point, a)) / square;
        let away = |point: &[f64]| -> Vec<f64> {
            let share = share(point);
            point.iter().zip(a).zip(&along).map(|((point, a), along)| point - a - share * along).collect()
        };
        let [from, to] = &step.ends;
        let (before, after) = (away(from), away(to));
        let (length, next) = (norm(metric, &before), norm(metric, &after));
        if square == 0.0 || inner(metric, &before, &after) >= OPPOSITE * length * next {
            return None;
        }
        let place = length / (length + next);
        let between: Vec<f64> = from.iter().zip(to).map(|(from, to)| from + place * (to - from)).collect();
        let is_through = norm(metric, &away(&between)) <= BETWEEN * (length + next);
        Some(share(&between)).filter(|share| is_through && (-OVERLAP..=1.0 + OVERLAP).contains(share))
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
