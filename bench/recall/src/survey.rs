//! The truth about a structure: its forced responses at every level.

use crate::balance::Balance;
use crate::draw::Drawn;
use crate::images::is_attached;
use crate::known::{Extent, Known};
use crate::newton::onto_plane;
use crate::quadrature::norm;
use crate::record::{Hint, Isola, Level, Record, Resonance, Standing};
use crate::shooting;
use crate::starts::{converged, responses, with_harmonics};
use crate::structure::Structure;
use crate::walk::{Bounds, Curve, End, branch, walk};

/// Sizes of random motions, m.
const SIZES: (f64, f64) = (0.02, 50.0);

/// Harmonics: as many as Isola takes where nothing else is asked for.
pub const HARMONICS: usize = 10;

/// Frequencies that branches are followed through, times the bounds of the study.
const BEYOND: (f64, f64) = (0.3, 3.0);

/// Where main branches begin, times the lowest frequency of the study or of a resonance.
const BELOW: f64 = 0.6;

/// Most points of a walk, and the largest motion, m.
const POINTS: usize = 6000;
const SIZE: f64 = 300.0;

/// Largest relative change with twice the harmonics.
const TRUNCATION: f64 = 0.08;

/// Narrowest range of an isola, of its frequency.
const NARROWEST: f64 = 1e-6;

/// Points of an isola that are led to other levels, and steps of the forcing on the way.
const LED: usize = 8;
const FORCING_STEPS: usize = 12;

/// Points of an isola that are confirmed by time integration.
const MARCHED: usize = 4;

/// A level while it is surveyed: its branches, the main one again, and the number of starts.
struct Surveyed<'b, 's> {
    known: Known<'b, 's>,
    main: Option<Curve>,
    starts: usize,
    /// Branches that were found without hints.
    own: usize,
}

/// Times that a start has to have met every closed branch: branches that none has met are few then.
const MET: usize = 4;

/// Batches of starts that are tried for that, at least and at most.
const BATCHES: (usize, usize) = (2, 5);

/// Branches of a level above which there is no telling whether they are all: such a level is left out.
pub const CROWDED: usize = 24;

/// Starts near where a hint says that there is something.
const HINTED: usize = 3000;

/// All levels of a structure: starts at each, then what was found at one led to the others until nothing is new.
///
/// Where `hints` say that there is something at a level, and nothing was found, it is looked for there once more.
pub fn survey(number: u64, drawn: &Drawn, starts: usize, hints: &[Hint]) -> Record {
    let structure = Structure::new(&drawn.model);
    let balances: Vec<Balance> =
        drawn.forcings.iter().map(|&forcing| Balance::new(&structure, HARMONICS, forcing)).collect();
    let range = (drawn.range[0], drawn.range[1]);
    let mut levels: Vec<Surveyed> = balances
        .iter()
        .enumerate()
        .map(|(index, balance)| {
            let main = main(balance, range);
            let mut known = Known::new(balance, bounds(range));
            known.curves.extend(main.iter().cloned().map(|curve| (curve, 0)));
            let tried = search(&mut known, balance, range, number * 1000 + index as u64, starts);
            Surveyed { known, main, starts: tried, own: 0 }
        })
        .collect();
    lead(&balances, &mut levels);
    for (balance, surveyed) in balances.iter().zip(&mut levels) {
        surveyed.own = surveyed.known.curves.len();
        let here = hints
            .iter()
            .filter(|hint| hint.number == number && (hint.forcing - balance.forcing).abs() < 1e-9 * balance.forcing);
        here.for_each(|hint| look(&mut surveyed.known, balance, hint));
    }
    let list = balances.iter().zip(&levels);
    let levels = list.map(|(balance, surveyed)| level(balance, surveyed, range)).collect();
    Record { number, kind: drawn.kind, model: drawn.model.clone(), range: drawn.range, levels }
}

/// Random starts, in batches, until none of the closed branches is met rarely; their number.
fn search(known: &mut Known, balance: &Balance, range: (f64, f64), seed: u64, batch: usize) -> usize {
    let mut attempts = responses(balance, range, SIZES, seed);
    for tried in 1..=BATCHES.1 {
        for (y, tangent) in attempts.by_ref().take(batch).flatten() {
            known.add(&y, &tangent);
        }
        let is_rare = |(curve, hits): &(Curve, usize)| curve.is_closed() && *hits < MET;
        let is_enough = tried >= BATCHES.0 && !known.curves.iter().any(is_rare);
        if is_enough || known.curves.len() > CROWDED {
            return tried * batch;
        }
    }
    BATCHES.1 * batch
}

/// Random starts of the frequencies and the size of a hint.
fn look(known: &mut Known, balance: &Balance, hint: &Hint) {
    let sizes = (0.1 * hint.peak, 3.0 * hint.peak);
    let attempts = responses(balance, (hint.omega[0], hint.omega[1]), sizes, hint.number);
    let before = known.curves.len();
    for (y, tangent) in attempts.take(HINTED).flatten() {
        known.add(&y, &tangent);
        if known.curves.len() > before + 2 {
            return;
        }
    }
}

fn bounds(range: (f64, f64)) -> Bounds {
    Bounds { omega: (BEYOND.0 * range.0, BEYOND.1 * range.1), size: SIZE, points: POINTS }
}

/// Ordinary continuation from below all resonances: the whole main branch if it comes out above.
fn main(balance: &Balance, range: (f64, f64)) -> Option<Curve> {
    let size = balance.size();
    let lowest = balance.structure.frequencies[0] / balance.structure.harmonic as f64;
    let omega = BELOW * lowest.min(range.0);
    let mut upwards = vec![0.0; size + 1];
    upwards[size] = 1.0;
    let mut y = vec![0.0; size + 1];
    y[size] = omega;
    let mut quiet = balance.clone();
    let mut tangent = None;
    for step in 1..=FORCING_STEPS {
        quiet.forcing = balance.forcing * step as f64 / FORCING_STEPS as f64;
        let origin = y.clone();
        tangent = Some(onto_plane(&quiet, &mut y, &upwards, &origin)?.1);
    }
    let (points, end) =
        walk(balance, &y, &tangent?, &Bounds { omega: (0.8 * omega, BEYOND.1 * range.1), ..bounds(range) });
    (end == End::Above).then_some(Curve { points, ends: (End::Below, end) })
}

/// Leads isolas from each level to the next, up and down.
fn lead(balances: &[Balance], levels: &mut [Surveyed]) {
    let count = balances.len();
    let up = (1..count).map(|to| (to - 1, to));
    let down = (1..count).rev().map(|from| (from, from - 1));
    for (from, to) in up.clone().chain(down).chain(up) {
        let closed = levels[from].known.curves.iter().filter(|(curve, _)| curve.is_closed());
        let seeds: Vec<Vec<f64>> = closed
            .flat_map(|(curve, _)| {
                let points = &curve.points;
                (0..LED).map(|i| points[i * points.len() / LED].clone())
            })
            .collect();
        for seed in seeds {
            if let Some((y, tangent)) = led(&balances[from], &balances[to], &seed) {
                levels[to].known.add(&y, &tangent);
            }
        }
    }
}

/// A response at another level, by steps of least norm.
fn led(from: &Balance, to: &Balance, seed: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let mut between = to.clone();
    let mut at = (seed.to_vec(), Vec::new());
    for step in 1..=FORCING_STEPS {
        between.forcing = from.forcing * (to.forcing / from.forcing).powf(step as f64 / FORCING_STEPS as f64);
        at = converged(&between, &at.0)?;
    }
    Some(at)
}

fn level(balance: &Balance, surveyed: &Surveyed, range: (f64, f64)) -> Level {
    let Surveyed { known, main, starts, own } = surveyed;
    let size = balance.size();
    let is_within = |(low, high): (f64, f64)| low >= range.0 && high <= range.1;
    let mut isolas: Vec<Isola> = known
        .curves
        .iter()
        .enumerate()
        .filter(|(_, (curve, _))| curve.is_closed())
        .map(|(index, (curve, hits))| (curve, Extent::of(balance, &curve.points), *hits, index >= *own))
        .filter(|(_, extent, ..)| is_within(extent.omega))
        .map(|(curve, extent, hits, hinted)| Isola { hinted, ..isola(balance, curve, &extent, hits) })
        .collect();
    isolas.sort_by(|a, b| a.omega[0].total_cmp(&b.omega[0]));
    let peak = main.as_ref().and_then(|curve| {
        let points: Vec<Vec<f64>> = curve.points.iter().filter(|y| y[size] >= range.0).cloned().collect();
        let Extent { peak, at, .. } = Extent::of(balance, &points);
        (at + 1 < points.len()).then_some(peak)
    });
    let open = known.curves.iter().filter(|(curve, _)| !curve.is_closed()).count() - usize::from(main.is_some());
    let main = peak.map(|(omega, peak)| [digits(omega), digits(peak)]);
    let crowded = known.curves.len() > CROWDED;
    Level { forcing: balance.forcing, starts: *starts, main, isolas, open, crowded }
}

fn isola(balance: &Balance, curve: &Curve, extent: &Extent, hits: usize) -> Isola {
    let points = &curve.points;
    let deviations: Vec<Option<f64>> = (0..MARCHED)
        .map(|i| shooting::deviation(balance, &points[(extent.at + i * points.len() / MARCHED) % points.len()]))
        .collect();
    let confirmed: Vec<f64> = deviations.into_iter().flatten().filter(|deviation| *deviation <= TRUNCATION).collect();
    let (low, high) = extent.omega;
    let is_resolved = 2 * confirmed.len() >= MARCHED && high - low > NARROWEST * high;
    let change = if is_resolved { change_with_twice(balance, curve, extent) } else { None };
    let holds = change.is_some_and(|change| change <= TRUNCATION);
    let standing = match (is_attached(balance, points), holds) {
        (true, _) => Standing::Attached,
        (false, true) => Standing::Isola,
        (false, false) => Standing::Unresolved,
    };
    Isola {
        resonance: resonance(balance, &points[extent.at]),
        omega: [digits(extent.omega.0), digits(extent.omega.1)],
        peak: [digits(extent.peak.0), digits(extent.peak.1)],
        standing,
        change: change.map(|change| (1e4 * change).round() / 1e4),
        marched: [confirmed.len(), MARCHED],
        deviation: (1e4 * confirmed.iter().copied().fold(0.0, f64::max)).round() / 1e4,
        hits,
        hinted: false,
    }
}

/// Nine digits: more than branches are compared by.
fn digits(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

/// Largest relative change of frequencies, width and peak with twice the harmonics; none where there is no isola then.
fn change_with_twice(balance: &Balance, curve: &Curve, extent: &Extent) -> Option<f64> {
    let twice = Balance::new(balance.structure, 2 * balance.harmonics(), balance.forcing);
    let points = &curve.points;
    let (y, tangent) = [0, points.len() / 2].iter().find_map(|shift| {
        converged(&twice, &with_harmonics(&points[(extent.at + shift) % points.len()], balance, &twice))
    })?;
    let (low, high) = extent.omega;
    let bounds = Bounds { omega: (0.8 * low, 1.25 * high), size: SIZE, points: 1500 };
    let again = branch(&twice, &y, &tangent, &bounds);
    if !again.is_closed() {
        return None;
    }
    let Extent { omega, peak, .. } = Extent::of(&twice, &again.points);
    let relative = |a: f64, b: f64| (a - b).abs() / b;
    let width = relative(omega.1 - omega.0, high - low);
    Some(
        [relative(omega.0, low), relative(omega.1, high), width, relative(peak.1, extent.peak.1)]
            .into_iter()
            .fold(0.0, f64::max),
    )
}

/// Which mode moves fastest at a point, and with which harmonic.
fn resonance(balance: &Balance, y: &[f64]) -> Resonance {
    let structure = balance.structure;
    if structure.harmonic > 1 {
        return Resonance::SubHarmonic;
    }
    let n = structure.size();
    let speed = |j: usize, k: usize| {
        let direction: Vec<f64> = (0..n).map(|i| structure.mass[i] * structure.shapes[(i, j)]).collect();
        let q = balance.series(y, &direction);
        k as f64 * norm(&q[2 * k - 1..=2 * k])
    };
    let all = (0..n).flat_map(|j| (1..=balance.harmonics()).map(move |k| (j, k)));
    match all.max_by(|a, b| speed(a.0, a.1).total_cmp(&speed(b.0, b.1))) {
        Some((0, 1)) => Resonance::FirstMode,
        Some((_, 1)) => Resonance::OtherMode,
        _ => Resonance::SuperHarmonic,
    }
}
