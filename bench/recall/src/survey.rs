//! The truth about a structure: its forced responses at every level.

use crate::balance::Balance;
use crate::closed::{digits, isola};
use crate::draw::Drawn;
use crate::known::{Extent, Known};
use crate::newton::onto_plane;
use crate::record::{Isola, Level, Record};
use crate::starts::{converged, responses};
use crate::structure::Structure;
use crate::walk::{Bounds, Curve, End, SIZE, walk};

/// Sizes of random motions, m.
const SIZES: (f64, f64) = (0.02, 50.0);

/// Harmonics: as many as Isola takes where nothing else is asked for.
pub const HARMONICS: usize = 10;

/// Frequencies that branches are followed through, times the bounds of the study.
const BEYOND: (f64, f64) = (0.3, 3.0);

/// Where main branches begin, times the lowest frequency of the study or of a resonance.
const BELOW: f64 = 0.6;

/// Most points of a walk.
const POINTS: usize = 6000;

/// Points of an isola that are led to other levels, and steps of the forcing on the way.
const LED: usize = 8;
const FORCING_STEPS: usize = 12;

/// A level while it is surveyed: its branches, the main one again, and the number of starts.
struct Surveyed<'b, 's> {
    known: Known<'b, 's>,
    main: Option<Curve>,
    starts: usize,
}

/// Times that a start has to have met every closed branch: branches that none has met are few then.
const MET: usize = 4;

/// Batches of starts that are tried for that, at least and at most.
const BATCHES: (usize, usize) = (2, 5);

/// Branches of a level above which there is no telling whether they are all: such a level is left out.
pub const CROWDED: usize = 24;

/// All levels of a structure: starts at each, then what was found at one led to the others until nothing is new.
pub fn survey(number: u64, drawn: &Drawn, starts: usize) -> Record {
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
            Surveyed { known, main, starts: tried }
        })
        .collect();
    lead(&balances, &mut levels);
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

/// How far branches are followed that are looked for in a range, rad/s.
pub fn bounds(range: (f64, f64)) -> Bounds {
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
    let Surveyed { known, main, starts } = surveyed;
    let size = balance.size();
    let is_within = |(low, high): (f64, f64)| low >= range.0 && high <= range.1;
    let mut isolas: Vec<Isola> = known
        .curves
        .iter()
        .filter(|(curve, _)| curve.is_closed())
        .map(|(curve, hits)| (curve, Extent::of(balance, &curve.points), *hits))
        .filter(|(_, extent, _)| is_within(extent.omega))
        .map(|(curve, extent, hits)| isola(balance, curve, &extent, hits))
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
