//! Reads a report from the store. What cannot be read becomes a sentence in its place.

use super::account::CostAccount;
use super::evidence::{Evidence, OrderFound, Structure};
use super::fit::fit_windows;
use super::folded::folded;
use super::ordinary::Ordinary;
use super::sentence::Sentence;
use super::verdict::verdict;
use crate::clock::now;
use crate::curves::{BackboneCurve, Curve, Monitor, Motions, ResonanceComparison, monitors};
use crate::figure::{Figures, Subject};
use crate::overview::{
    BranchRow, Level, Omissions, Overview, bounds, least_added, unfinished, verified_result, why_no_folds,
};
use crate::store::{CurveRow, Reader, Result, RunHeader};
use crate::summary_table::{UnitChoice, unit_of_forcing};
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use protocol::to_everyone::Stage;
use serde::Serialize;
use solver::response::backbone::{Backbone, BackbonePoint};
use solver::response::orders::orders;
use std::collections::HashSet;

/// Points of branches that a page takes without becoming heavy.
const POINTS: usize = 250_000;
/// Motions kept for all branches together, though at least one for each.
const MOTIONS: usize = 400;
/// Motions kept for one branch at most.
const MOTIONS_PER_BRANCH: usize = 40;

/// A run as page and figures show it: rad/s, m, N, J, s.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Which run.
    pub run: RunFacts,
    /// Where it is dangerous, from which forcing on, what ordinary continuation would have missed.
    pub verdict: [Sentence; 3],
    /// Its figures.
    pub figures: Figures,
    /// How it came about.
    pub account: CostAccount,
    /// Monitored dofs; the first one counts.
    pub monitors: Vec<Monitor>,
    /// What A = 1 is, where that takes few words.
    pub forcing_unit: Option<String>,
    /// The harmonic of the response that is forced.
    pub harmonic: usize,
    /// Orders of motions that the run looks for, this one among them.
    pub asked: Vec<usize>,
    /// Fold curves.
    pub curves: Vec<CurveRow>,
    /// Lowest and highest frequency of the sweep, rad/s; known when the backbone is.
    pub sweep: Option<(f64, f64)>,
    /// Branches, level by level, main before isolas.
    pub branches: Vec<Curve>,
    /// The backbone that figures are about, once it is known: see [`Self::turn_to_isola`].
    pub backbone: Option<BackboneCurve>,
    /// The backbones of other modes.
    pub further: Vec<BackboneCurve>,
    /// Frequency and amplitude of the largest response, three ways.
    pub resonance: ResonanceComparison,
    /// Motions at chosen points.
    pub motions: Motions,
    /// What was found, level by level.
    pub overview: Overview,
    /// What is missing.
    pub omissions: Omissions,
    /// Units that were chosen for it.
    chosen: UnitChoice,
}

/// Which run, and what is not there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RunFacts {
    /// Run.
    pub id: String,
    /// Name of the study.
    pub name: String,
    /// Name of the model.
    pub model: String,
    /// Where the study was read from.
    pub study_file: String,
    /// When the run was created, RFC 3339.
    pub created: String,
    /// Version of the program.
    pub program: String,
    /// `backbone`, `sweep`, `finished` or `cancelled`; `None` if it cannot be read.
    pub stage: Option<protocol::to_everyone::Stage>,
    /// When this was read, RFC 3339.
    pub made: String,
    /// What is not there, not yet, or damaged: a sentence each.
    pub missing: Vec<String>,
}

/// Which levels are shown.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Selection {
    /// All of them, the branches of as many as a page takes.
    #[default]
    Fitting,
    /// All of them.
    All,
    /// All of them, but no branches: for figures that show none.
    NoBranches,
    /// Those of these forcing amplitudes.
    Amplitudes(Vec<f64>),
}

impl Report {
    /// Reads a run, finished, in progress, cancelled or damaged (of one moment if the caller holds a snapshot).
    ///
    /// # Errors
    /// If there is no run, or if what it is about (header, model) cannot be read.
    pub fn read(reader: &Reader, selection: &Selection) -> Result<Self> {
        Self::read_in(reader, selection, UnitChoice::default())
    }

    /// The same, shown in these units where they are chosen, else in those of the run.
    ///
    /// # Errors
    /// Those of [`Report::read`].
    pub fn read_in(reader: &Reader, selection: &Selection, units: UnitChoice) -> Result<Self> {
        let mut omissions = Omissions::default();
        if *selection != Selection::NoBranches {
            omissions.check(reader);
        }
        let mut overview = Overview::read(reader, &mut omissions)?;
        if let Selection::Amplitudes(list) = selection {
            overview.levels.retain(|level| list.contains(&level.value));
        }
        let header = overview.header.clone().map_or_else(|| reader.header(), Ok)?;
        let model = overview.model.clone().map_or_else(|| reader.verified_model(), Ok)?;
        let model = model.model().map_err(|error| reader.corrupt(error))?;
        let stage = omissions.read("The stage of the run is", reader.stage());

        let backbone = omissions.read("The backbone is", read_backbone(reader, &Size::of(&model)));
        omissions.missing.extend(unfinished(&overview.levels, backbone.as_ref().is_none_or(Option::is_some)));
        let highest = overview.levels.iter().map(|level| level.value).fold(0.0, f64::max);
        let curve = |backbone: &Backbone| {
            let falls_short = backbone.falls_short(&model, &header.settings, highest);
            BackboneCurve { falls_short, ..BackboneCurve::new(backbone, &model) }
        };
        let mut backbone = backbone.flatten().as_ref().map(curve);
        let further =
            omissions.read("Further backbones are", read_further(reader, &Size::of(&model))).unwrap_or_default();
        let mut further: Vec<BackboneCurve> = further.iter().map(curve).collect();
        let modes = omissions.read("Which modes were followed is", reader.modes()).flatten();
        fit_windows(&mut overview, backbone.as_ref().into_iter().chain(&further), &mut omissions);
        for backbone in backbone.iter_mut().chain(&mut further) {
            backbone.keep_events_near(overview.levels.iter().map(|level| level.value));
        }
        let reach = omissions.read("The frequency range of the sweep is", reader.reach()).flatten();
        let drawn = drawn(&overview, selection, &mut omissions);
        let motions = Motions::new(&model, header.settings.harmonics.count);
        let (branches, motions) = curves(reader, &drawn, Size::of(&model), motions, &mut omissions);
        let account = CostAccount::read(reader, &header.study, &overview.levels, &mut omissions);

        let monitors = monitors(&model);
        let mut mains = omissions.read("How main branches end is", reader.main_outcomes()).unwrap_or_default();
        mains.retain(|(amplitude, _)| overview.levels.iter().any(|level| level.amplitude == *amplitude));
        let curves = omissions.read("The list of fold curves is", reader.curves()).unwrap_or_default();
        let pushes = omissions.read("The list of pushes is", reader.pushes()).unwrap_or_default();
        let turned = omissions.read("The list of motions is", reader.motions()).unwrap_or_default();
        let damaged = omissions.damaged.len();
        let told_in = units.or(UnitChoice::of_study(&header.study));
        let evidence = Evidence {
            damaged,
            motions: &turned,
            pushes: &pushes,
            levels: &overview.levels,
            backbone: backbone.as_ref(),
            further: &further,
            modes: modes.as_ref(),
            mains: &mains,
            folded: folded(&branches, &overview.levels),
            curves: &curves,
            search: omissions.read("What became of folds is", reader.search_counts()).unwrap_or_default(),
            why_no_folds: why_no_folds(&model, &header.settings),
            stage,
            structure: Structure::new(&model, &monitors[0]),
            harmonics: header.settings.harmonics.count,
            least_added: least_added(&model, reader.order().is_some()),
            bounds: bounds(header.settings.frequency, reach.map(|reach| reach.frequency), reader.order().is_some()),
            given: header.settings.frequency,
            max_amplitude: header.settings.branch.max_amplitude,
            reached: reach.map(|reach| reach.frequency),
            asked: orders(&model, &header.settings.search),
            orders: further_orders(reader, &mut omissions),
            is_further: reader.order().is_some(),
            ordinary: Box::new(|level, omega| {
                Ordinary::at(reader, &overview.levels, (&model, &header.settings), (level, omega))
            }),
            units: told_in.of_table(),
            length_unit: told_in.length,
        };
        let (answers, asked) = (verdict(&evidence), evidence.asked.clone());
        drop(evidence);
        let mut report = Self {
            chosen: units,
            verdict: answers,
            figures: Figures::default(),
            sweep: reach.map(|reach| reach.frequency),
            resonance: ResonanceComparison::new(&overview.levels, backbone.iter().chain(&further)),
            run: facts(header, model.name().to_string(), stage, omissions.sentences().cloned().collect()),
            asked,
            monitors,
            forcing_unit: unit_of_forcing(&model),
            harmonic: reader.order().unwrap_or(model.forcing().harmonic),
            branches,
            backbone,
            further,
            curves,
            motions,
            account,
            overview,
            omissions,
        };
        if let Some(number) = report.mode_of_isola(None) {
            report.put_first(number);
        }
        report.figures = Figures::new(&report.subject());
        Ok(report)
    }

    /// Draws its figures of another mode's backbone, by the number of the mode from 1.
    ///
    /// # Errors
    /// Which modes have one, if this has none.
    pub fn turn_to(&mut self, number: usize) -> std::result::Result<(), String> {
        let all = self.backbone.iter().chain(&self.further);
        let modes: Vec<String> = all.map(|backbone| (backbone.mode + 1).to_string()).collect();
        if !modes.contains(&number.to_string()) {
            return Err(match &modes[..] {
                [] => "the run has no backbone yet".into(),
                modes => {
                    format!("mode {number} has no backbone in this run: there are those of modes {}", modes.join(", "))
                }
            });
        }
        if self.put_first(number) {
            self.figures = Figures::new(&self.subject());
        }
        Ok(())
    }

    /// Whether another backbone, that of this mode, from 1, takes the place of the first.
    fn put_first(&mut self, number: usize) -> bool {
        let place = self.further.iter().position(|further| further.mode + 1 == number);
        if let Some(place) = place {
            let chosen = self.further.remove(place);
            self.further.extend(self.backbone.replace(chosen));
        }
        place.is_some()
    }

    /// The same of the mode whose window led to an isola of its frequencies at a level, by index, by default at the level to look at first;
    /// if none did there, at the lowest level where one did. If none did anywhere, or that mode has no backbone, nothing changes: figures are
    /// about the primary mode, the first one followed.
    pub fn turn_to_isola(&mut self, level: Option<usize>) {
        let is_turned = self.mode_of_isola(level).map_or(Ok(()), |number| self.turn_to(number));
        is_turned.unwrap_or_default();
    }

    fn mode_of_isola(&self, level: Option<usize>) -> Option<usize> {
        let level = level.or_else(|| self.subject().first_level());
        let own = level.and_then(|level| self.overview.levels[level].mode_of_isola());
        own.or_else(|| self.overview.levels.iter().find_map(Level::mode_of_isola))
    }

    /// Units in which it is shown.
    pub fn units(&self) -> UnitChoice {
        self.chosen.or(UnitChoice::of_study(&self.account.study))
    }

    /// What its figures are drawn from.
    pub fn subject(&self) -> Subject<'_> {
        Subject {
            levels: &self.overview.levels,
            branches: &self.branches,
            monitors: &self.monitors,
            forcing_unit: self.forcing_unit.as_deref().unwrap_or_default(),
            is_finished: self.run.stage == Some(Stage::Finished),
            harmonic: self.harmonic,
            backbone: self.backbone.as_ref(),
            further: &self.further,
            curves: &self.curves,
            sweep: self.sweep,
            resonance: &self.resonance,
            motions: &self.motions,
            missing: &self.run.missing,
        }
    }
}

fn facts(header: RunHeader, model: String, stage: Option<Stage>, missing: Vec<String>) -> RunFacts {
    RunFacts {
        id: header.run.to_string(),
        name: header.name,
        model,
        study_file: header.study_file.display().to_string(),
        created: header.created,
        program: header.program,
        stage,
        made: now(),
        missing,
    }
}

/// What was found of further orders of motions, if the reader tells of the first.
fn further_orders(reader: &Reader, omissions: &mut Omissions) -> Vec<OrderFound> {
    if reader.order().is_some() {
        return Vec::new();
    }
    let found = |order: usize, omissions: &mut Omissions| {
        let levels = reader.of_order(order).and_then(|further| Overview::read(&further, omissions));
        let levels = omissions.read(format_args!("What was found of motions of order {order} is"), levels);
        levels.map(|overview| OrderFound::new(order, &overview.levels))
    };
    let orders = omissions.read("Which orders of motions there are is", reader.further_orders()).unwrap_or_default();
    orders.into_iter().filter_map(|order| found(order, omissions)).collect()
}

fn read_backbone(reader: &Reader, size: &Size) -> Result<Option<Backbone>> {
    reader.backbone()?.map(|message| readable(reader, &message, size)).transpose()
}

fn read_further(reader: &Reader, size: &Size) -> Result<Vec<Backbone>> {
    reader.further_backbones()?.iter().map(|message| readable(reader, message, size)).collect()
}

/// A backbone that can be drawn.
fn readable(reader: &Reader, message: &BackboneMessage, size: &Size) -> Result<Backbone> {
    let backbone = message.backbone(size).map_err(|error| reader.corrupt(error))?;
    let is_somewhere = |point: &BackbonePoint| point.point.omega().is_finite() && point.arc().is_finite();
    if backbone.points.iter().all(is_somewhere) {
        Ok(backbone)
    } else {
        Err(reader.corrupt("a frequency or an arc length is not a number"))
    }
}

/// The branches that are drawn, with the index of their level.
fn drawn<'s>(overview: &'s Overview, selection: &Selection, omissions: &mut Omissions) -> Vec<(usize, &'s BranchRow)> {
    let levels = &overview.levels;
    let stride = match selection {
        Selection::NoBranches => return Vec::new(),
        Selection::All | Selection::Amplitudes(_) => 1,
        Selection::Fitting => {
            let points: usize = overview.branches().map(|(_, branch)| branch.points).sum();
            points.div_ceil(POINTS).max(1)
        }
    };
    let chosen: HashSet<usize> = (0..levels.len()).rev().step_by(stride).collect();
    if chosen.len() < levels.len() {
        let (drawn, all) = (chosen.len(), levels.len());
        let sentence = format!(
            "Branches are drawn for {drawn} of {all} forcing levels: more would be too heavy; --levels chooses."
        );
        omissions.missing.push(sentence);
    }
    let of_level = |i: usize| levels[i].branches.iter().map(move |branch| (i, branch));
    (0..levels.len()).filter(|i| chosen.contains(i)).flat_map(of_level).collect()
}

/// Branches one after the other, each checked against its checksum, and some of their motions.
fn curves(
    reader: &Reader,
    drawn: &[(usize, &BranchRow)],
    size: Size,
    mut motions: Motions,
    omissions: &mut Omissions,
) -> (Vec<Curve>, Motions) {
    let mut curves: Vec<Curve> = Vec::new();
    let share = (MOTIONS / drawn.len().max(1)).clamp(1, MOTIONS_PER_BRANCH);
    for &(level, branch) in drawn {
        let read = verified_result(reader, branch).and_then(|result| {
            let curve = Curve::of(&result, level).map_err(|error| error.to_string())?;
            let verified = omissions.read(
                format_args!("The stability of the branch of task {} is", branch.task),
                reader.verification(&branch.task),
            );
            let curve = curve.map(|curve| verified.flatten().iter().fold(curve, Curve::verified));
            let beyond = omissions.read(
                format_args!("What unstable motions of the branch of task {} turn into is", branch.task),
                reader.settlings(&branch.task),
            );
            let curve = curve.map(|curve| curve.beyond(&beyond.unwrap_or_default()));
            if let Some(curve) = &curve {
                motions.choose((curves.len(), curve), &result, &size, share).map_err(|error| error.to_string())?;
            }
            Ok(curve)
        });
        curves.extend(omissions.take(format_args!("The branch of task {} is", branch.task), read).flatten());
    }
    (curves, motions)
}
