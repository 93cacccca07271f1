//! What the page is given: all that it shows, as JSON.

use crate::curves::{Curve, Motion, Node};
use crate::export;
use crate::figure::{
    Color, ColumnStore, Figure, Font, Frame, MotionAxis, PALETTE, Palette, Unit, convert, ladder, level_colors,
    motion_axes, place_for_page,
};
use crate::overview::{Level, WindowOutcome, briefly};
use crate::report::{CostAccount, Report, RunFacts, Sentence};
use crate::summary_table::UnitChoice;
use crate::told::{Told, length_in};
use crate::words::digits;
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// The JSON of the page.
#[derive(Serialize)]
pub struct PageData<'r> {
    run: &'r RunFacts,
    orders: &'r [PageOfOrder],
    verdict: &'r [Sentence],
    palette: Palette,
    /// The unit in which frequencies are shown until the reader chooses another one.
    frequency_unit: String,
    /// The unit of lengths of the run, if it has one; without, each is shown in that in which it is read best.
    length_unit: Option<Unit>,
    columns: &'r ColumnStore,
    levels: Vec<Level>,
    level_colors: Vec<Color>,
    branches: &'r [Curve],
    frames: Vec<Frame>,
    first_frame: usize,
    figures: BTreeMap<&'static str, Figure>,
    nothing: &'r BTreeMap<&'static str, String>,
    motions: Option<MotionData<'r>>,
    account: &'r CostAccount,
    words: Vec<(&'static str, &'static str)>,
}

/// The page of an order of motions, among those of a run that looks for several.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PageOfOrder {
    /// How many periods of the force its motions last.
    pub order: usize,
    /// Whether it is the run's first one.
    pub is_first: bool,
    /// Where it is, as seen from the page that names it; `None` is that page itself.
    pub file: Option<String>,
}

/// The motions that the page has.
#[derive(Serialize)]
struct MotionData<'r> {
    harmonics: usize,
    nodes: &'r [Node],
    points: Vec<MotionPoint<'r>>,
}

/// A motion, with the axes of its panels.
#[derive(Serialize)]
struct MotionPoint<'r> {
    #[serde(flatten)]
    motion: &'r Motion,
    words: Told,
    panels: Vec<MotionAxis>,
}

impl<'r> PageData<'r> {
    /// Of a report: labels are placed for the page here.
    pub fn new(report: &'r Report, orders: &'r [PageOfOrder]) -> Self {
        let subject = report.subject();
        let levels = &report.overview.levels;
        let frames: Vec<Frame> = report.backbone.as_ref().map_or_else(Vec::new, |backbone| {
            ladder(&subject, backbone).into_iter().map(|value| Frame::at(&subject, backbone, value)).collect()
        });
        let first = subject.first_level();
        let first_frame = frames.iter().position(|frame| frame.level.is_some() && frame.level == first).unwrap_or(0);
        let mut figures = report.figures.drawn.clone();
        let (font, units) = (Font::bundled(), report.units());
        for figure in figures.values_mut() {
            convert(figure, lengths(units));
            place_for_page(figure, &report.figures.columns, &frames, &font);
        }
        Self {
            run: &report.run,
            orders,
            verdict: &report.verdict,
            palette: PALETTE,
            frequency_unit: units.of_table().frequency.to_string(),
            length_unit: length_unit(units),
            columns: &report.figures.columns,
            levels: levels.iter().map(in_brief).collect(),
            level_colors: level_colors(levels.len()),
            branches: &report.branches,
            motions: figures.get("motion").map(|figure| MotionData::new(report, figure)),
            frames,
            first_frame,
            figures,
            nothing: &report.figures.nothing,
            account: &report.account,
            words: export::words().collect(),
        }
    }
}

impl<'r> MotionData<'r> {
    fn new(report: &'r Report, figure: &Figure) -> Self {
        let motions = &report.motions;
        let length = report.units().length;
        let point = |motion: &'r Motion| {
            let axes = motion_axes(figure, motions, &motion.coefficients.values);
            let panels = axes.into_iter().map(|axis| axis.with_length(length)).collect();
            MotionPoint { motion, words: words(report, motion), panels }
        };
        Self { harmonics: motions.harmonics, nodes: &motions.nodes, points: motions.points.iter().map(point).collect() }
    }
}

/// Units without that of frequencies, which the page turns itself.
pub(crate) fn lengths(units: UnitChoice) -> UnitChoice {
    UnitChoice { frequency: None, ..units }
}

/// The unit of lengths that was chosen.
pub(crate) fn length_unit(units: UnitChoice) -> Option<Unit> {
    units.length.map(|unit| Unit { name: unit.to_string(), factor: unit.factor() })
}

/// A level whose windows tell each reason once.
fn in_brief(level: &Level) -> Level {
    let mut level = level.clone();
    for window in &mut level.windows {
        if let WindowOutcome::NotFound(reasons) | WindowOutcome::Passed { told: reasons, .. } = &mut window.outcome {
            *reasons = briefly(reasons);
        }
    }
    level
}

/// Which motion it is.
fn words(report: &Report, motion: &Motion) -> Told {
    let Some(branch) = report.branches.get(motion.branch) else { return Told::default() };
    let amplitude = report.overview.levels.get(branch.level).map_or("", |level| &level.amplitude);
    let omega = branch.omega.values.get(motion.index).copied().unwrap_or(f64::NAN);
    let size = branch.amplitude.first().and_then(|column| column.values.get(motion.index)).copied();
    let point = format!("Point {} of {}, A = {amplitude}: ", motion.index, branch.name);
    let period = digits(1e3 * TAU / omega, 4);
    let size = length_in(size.unwrap_or(f64::NAN), report.units().length);
    Told::from(point).frequency(omega, 6).unit().text(format!(", one period lasts {period} ms, amplitude {size}."))
}
