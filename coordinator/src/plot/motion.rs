//! One period at any point of a branch: displacements against the casing, pressures, spectrum, shape of the tip.

use super::axis::Axis;
use super::panel::Panel;
use super::scene::{Scene, level};
use super::sheet::Sheet;
use super::style::{GREY, LABEL, THIN, dash, marker, nth, solid};
use crate::error::Error;
use crate::report::words::{digits, length_unit};
use crate::report::{Curve, Motions, Node};
use crate::store::Reader;
use crate::survey::{BranchRow, whole};
use plotive::Rgba8;
use plotive::des::figure::LegendPos;
use plotive::style::MarkerShape;
use protocol::curve::Size;
use protocol::to_everyone::StoredResult;
use solver::harmonics::{complex, evaluate, width};
use std::f64::consts::TAU;

/// Instants of a period at which curves are computed.
const INSTANTS: usize = 512;
/// Instants at which the shape of the tip is drawn, evenly over the period T.
const SHAPES: [&str; 8] = ["0", "T/8", "T/4", "3T/8", "T/2", "5T/8", "3T/4", "7T/8"];
/// Room beside the last node for their labels.
const ROOM: f64 = 0.95;
/// Nodes that make a shape.
const SHAPE_NODES: usize = 3;
/// Harmonics below this share of the largest are not drawn.
const FLOOR: f64 = 1e-6;

/// The motion of a place: series of displacement, m, and predicted pressure, N.
struct Track<'n> {
    node: &'n Node,
    color: Rgba8,
    displacement: &'n [f64],
    pressure: &'n [f64],
}

/// The figure, at `A/branch/index` or at the highest isola's peak.
pub fn sheet(scene: &Scene<'_>, reader: &Reader, at: Option<&str>) -> Result<Sheet, Error> {
    let (row, amplitude, index) = match at {
        Some(text) => named(scene, text)?,
        None => highest(scene)?,
    };
    let header = reader.header()?;
    let model = reader.genuine_model()?.model().map_err(|error| reader.corrupt(error))?;
    let (result, curve) = stored(reader, row)?;
    let index = index.point(&curve, scene.monitor)?;
    let motions = Motions::new(&model, header.settings.harmonics.count);
    let motion = motions.at((0, index), &result, &Size::of(&model)).map_err(|error| reader.corrupt(error))?;
    let motion = motion.ok_or_else(|| Error::Other(format!("--at: {} has no point {index}", curve.name)))?;
    let nc = width(motions.harmonics);
    let series: Vec<&[f64]> = motion.coefficients.values.chunks(nc).collect();
    let count = motions.nodes.len();
    let tracks: Vec<Track<'_>> = motions
        .nodes
        .iter()
        .zip(series.chunks(2))
        .enumerate()
        .map(|(i, (node, pair))| Track { node, color: nth(i, count), displacement: pair[0], pressure: pair[1] })
        .collect();
    let omega = digits(curve.omega.values[index], 6);
    let title = format!("A = {amplitude}, {}, point {index}, ω = {omega} rad/s", curve.name);
    Ok(panels(&tracks, motions.harmonics, title))
}

fn panels(tracks: &[Track<'_>], harmonics: usize, title: String) -> Sheet {
    let has_contact = tracks.iter().any(|track| track.node.gap.is_some());
    let mut panels = vec![displacements(tracks)];
    panels.extend(has_contact.then(|| pressures(tracks)));
    panels.push(spectrum(tracks, harmonics));
    panels.extend((has_contact && tracks.len() >= SHAPE_NODES).then(|| shapes(tracks)));
    let legend = (tracks.len() > 1).then_some(LegendPos::Right);
    Sheet { columns: panels.len().min(2), panels, title: Some(title), legend }
}

/// Where on a branch.
enum Index {
    Peak,
    Point(usize),
}

impl Index {
    fn point(&self, curve: &Curve, monitor: usize) -> Result<usize, Error> {
        let amplitude = &curve.amplitude[monitor].values;
        match *self {
            Self::Peak => Ok((0..curve.size).max_by(|&i, &j| amplitude[i].total_cmp(&amplitude[j])).unwrap_or(0)),
            Self::Point(index) if index < curve.size => Ok(index),
            Self::Point(index) => {
                let last = curve.size.saturating_sub(1);
                Err(Error::Other(format!("--at: {} has no point {index}, but 0 to {last}, or peak", curve.name)))
            }
        }
    }
}

/// The point that `A/branch/index` names, with its forcing amplitude as typed in the study.
fn named<'s>(scene: &'s Scene<'_>, text: &str) -> Result<(&'s BranchRow, &'s str, Index), Error> {
    let usage =
        || Error::Other(format!("--at {text}: write A/branch/index, like \"20/isola 1/43\" or \"20/main/peak\""));
    let parts: Vec<&str> = text.split('/').map(str::trim).collect();
    let (amplitude, branch, index) = match parts[..] {
        [amplitude, branch] => (amplitude, branch, "peak"),
        [amplitude, branch, index] => (amplitude, branch, index),
        _ => return Err(usage()),
    };
    let summary = &scene.levels[level(scene.report, "--at", amplitude)?];
    let names: Vec<String> = summary.branches.iter().map(name).collect();
    let known = if names.is_empty() { "nothing yet".into() } else { names.join(", ") };
    let unknown = || Error::Other(format!("--at {text}: A = {} has no such branch, but {known}", summary.amplitude));
    let row = summary.branches.iter().find(|row| name(row) == branch).ok_or_else(unknown)?;
    let index = match index {
        "peak" => Index::Peak,
        digits => Index::Point(digits.parse().map_err(|_| usage())?),
    };
    Ok((row, &summary.amplitude, index))
}

/// The highest isola, else the highest branch.
fn highest<'s>(scene: &'s Scene<'_>) -> Result<(&'s BranchRow, &'s str, Index), Error> {
    let all = || scene.levels.iter().flat_map(|level| level.branches.iter().map(|row| (row, level.amplitude.as_str())));
    let by_amplitude = |a: &(&BranchRow, &str), b: &(&BranchRow, &str)| a.0.amplitude_max.total_cmp(&b.0.amplitude_max);
    let isola = all().filter(|(row, _)| row.kind != "main").max_by(by_amplitude);
    let (row, amplitude) = isola
        .or_else(|| all().max_by(by_amplitude))
        .ok_or_else(|| Error::Other("nothing to draw: no branch has been computed yet".into()))?;
    Ok((row, amplitude, Index::Peak))
}

fn name(row: &BranchRow) -> String {
    if row.kind == "main" { "main".into() } else { format!("{} {}", row.kind, row.number) }
}

fn stored(reader: &Reader, row: &BranchRow) -> Result<(StoredResult, Curve), Error> {
    let result = whole(reader, row).map_err(|error| reader.corrupt(error))?;
    let curve = Curve::of(&result, 0).map_err(|error| reader.corrupt(error))?;
    let curve = curve.ok_or_else(|| reader.corrupt(format!("the branch of task {} is missing", row.task)))?;
    Ok((result, curve))
}

/// Instants of a period, as shares of it.
fn instants() -> Vec<f64> {
    (0..=INSTANTS).map(|i| i as f64 / INSTANTS as f64).collect()
}

fn over_period(series: &[f64], factor: f64) -> Vec<f64> {
    instants().iter().map(|t| factor * evaluate(series, TAU * t)[0]).collect()
}

fn period() -> Axis {
    Axis::exact("time (periods)", (0.0, 1.0))
}

fn displacements(tracks: &[Track<'_>]) -> Panel {
    let (factor, unit) = unit(tracks);
    let curves: Vec<Vec<f64>> = tracks.iter().map(|track| over_period(track.displacement, factor)).collect();
    let gaps = tracks.iter().filter_map(|track| track.node.gap.map(|gap| gap * factor));
    let y = Axis::around(format!("displacement ({unit})"), curves.iter().flatten().copied().chain(gaps.clone()));
    let mut panel = Panel::new(period(), y);
    if let Some(gap) = gaps.reduce(f64::min) {
        panel.level(gap, GREY, dash(1));
        panel.label("gap", (1.0, gap), GREY);
    }
    for (track, curve) in tracks.iter().zip(&curves) {
        panel.line(&instants(), curve, solid(track.color, THIN), Some(&track.node.name));
    }
    panel
}

fn unit(tracks: &[Track<'_>]) -> (f64, &'static str) {
    let values = tracks.iter().flat_map(|track| over_period(track.displacement, 1.0));
    length_unit(values.fold(0.0, |largest, value| largest.max(value.abs())))
}

fn pressures(tracks: &[Track<'_>]) -> Panel {
    let curves: Vec<Vec<f64>> =
        tracks.iter().map(|track| over_period(track.pressure, 1.0).into_iter().map(|p| p.max(0.0)).collect()).collect();
    let mut panel =
        Panel::new(period(), Axis::around("contact pressure (N)", curves.iter().flatten().copied().chain([0.0])));
    for (track, curve) in tracks.iter().zip(&curves) {
        panel.line(&instants(), curve, solid(track.color, THIN), None);
    }
    panel
}

fn spectrum(tracks: &[Track<'_>], harmonics: usize) -> Panel {
    let (factor, unit) = unit(tracks);
    let size = |track: &Track<'_>, k: usize| match k {
        0 => factor * track.displacement[0].abs(),
        k => factor * complex(track.displacement, k).norm(),
    };
    let sizes: Vec<Vec<f64>> = tracks.iter().map(|track| (0..=harmonics).map(|k| size(track, k)).collect()).collect();
    let floor = FLOOR * sizes.iter().flatten().copied().fold(0.0, f64::max);
    let drawn = sizes.iter().flatten().copied().filter(|&size| size > floor);
    let x = Axis::around("harmonic k", (0..=harmonics).map(|k| k as f64));
    let mut panel = Panel::new(x, Axis::logarithmic(format!("harmonics |cₖ| ({unit})"), drawn));
    for (track, sizes) in tracks.iter().zip(&sizes) {
        let (k, sizes): (Vec<f64>, Vec<f64>) =
            sizes.iter().enumerate().filter(|(_, size)| **size > floor).map(|(k, &size)| (k as f64, size)).unzip();
        panel.line(&k, &sizes, solid(track.color, 0.6 * THIN), None);
        panel.points(&k, &sizes, marker(MarkerShape::Circle, track.color, 0.3 * LABEL, true), None);
    }
    panel
}

fn shapes(tracks: &[Track<'_>]) -> Panel {
    let (factor, unit) = unit(tracks);
    let at = |i: usize| {
        let phase = TAU * i as f64 / SHAPES.len() as f64;
        tracks.iter().map(|track| factor * evaluate(track.displacement, phase)[0]).collect::<Vec<f64>>()
    };
    let shapes: Vec<Vec<f64>> = (0..SHAPES.len()).map(at).collect();
    let places: Vec<f64> = (1..=tracks.len()).map(|place| place as f64).collect();
    let gap: Vec<f64> = tracks.iter().map(|track| track.node.gap.map_or(f64::NAN, |gap| gap * factor)).collect();
    let y = Axis::around(format!("shape of the tip ({unit})"), shapes.iter().chain([&gap]).flatten().copied());
    let mut panel = Panel::new(Axis::exact("contact node", (0.8, tracks.len() as f64 + ROOM)), y);
    panel.has_leaders = false;
    panel.line(&places, &gap, solid(GREY, THIN).with_pattern(dash(1)), None);
    for (shape, instant) in shapes.iter().zip(SHAPES) {
        panel.line(&places, shape, solid(GREY, THIN), None);
        let last = shape.len() - 1;
        panel.label(instant, (places[last], shape[last]), GREY);
    }
    panel
}
