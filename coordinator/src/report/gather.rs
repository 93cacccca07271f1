//! Reads a report from the store. What cannot be read becomes a sentence in its place.

use super::curve::Curve;
use super::motion::Motions;
use super::verdict::{Evidence, verdict};
use super::{Account, BackboneCurve, Level, Monitor, Report, RunFacts, Ways};
use crate::store::{Reader, Result, RunHeader};
use crate::survey::{BranchRow, Lacks, Survey, whole};
use protocol::curve::Size;
use protocol::to_everyone::Stage;
use solver::backbone::{Backbone, BackbonePoint};
use solver::laws::LawKind;
use solver::model::Model;
use std::collections::HashSet;

/// Points of branches that a page takes without becoming heavy.
const POINTS: usize = 250_000;
/// Motions kept for all branches together, though at least one for each.
const MOTIONS: usize = 400;
/// Motions kept for one branch at most.
const MOTIONS_PER_BRANCH: usize = 40;

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
        let mut lacks = Lacks::default();
        if *selection != Selection::NoBranches {
            lacks.check(reader);
        }
        let mut survey = Survey::read(reader, &mut lacks)?;
        if let Selection::Amplitudes(list) = selection {
            survey.levels.retain(|level| list.contains(&level.value));
        }
        let header = survey.header.clone().map_or_else(|| reader.header(), Ok)?;
        let model = survey.model.clone().map_or_else(|| reader.genuine_model(), Ok)?;
        let model = model.model().map_err(|error| reader.corrupt(error))?;
        let stage = lacks.read("The stage of the run is", reader.stage());

        let backbone = lacks.read("The backbone is", read_backbone(reader, &Size::of(&model)));
        lacks.levels(&survey.levels, backbone.as_ref().is_none_or(Option::is_some));
        let backbone = backbone.flatten().map(|backbone| BackboneCurve::new(&backbone, &model));
        fit_windows(&mut survey, backbone.as_ref(), &mut lacks);
        let reach = lacks.read("The frequency range of the sweep is", reader.reach()).flatten();
        let drawn = drawn(&survey, selection, &mut lacks);
        let motions = Motions::new(&model, header.settings.harmonics.count);
        let (branches, motions) = curves(reader, &drawn, Size::of(&model), motions, &mut lacks);
        let account = Account::read(reader, &header.study, &survey.levels, &mut lacks);

        let monitors = monitors(&model);
        let evidence = Evidence {
            levels: &survey.levels,
            backbone: backbone.as_ref(),
            monitor: &monitors[0].name,
            gap: monitors[0].gap,
        };
        Ok(Self {
            verdict: verdict(&evidence),
            omega: reach.map(|reach| reach.frequency),
            ways: Ways::new(&survey.levels, backbone.as_ref()),
            run: facts(header, model.name, stage, lacks.sentences().cloned().collect()),
            monitors,
            levels: survey.levels.iter().map(Level::from).collect(),
            branches,
            backbone,
            motions,
            account,
            survey,
            lacks,
        })
    }
}

/// Leaves out windows that are not windows of the backbone.
fn fit_windows(survey: &mut Survey, backbone: Option<&BackboneCurve>, lacks: &mut Lacks) {
    let Some(threshold) = backbone.map(|backbone| &backbone.threshold.values) else { return };
    for level in &mut survey.levels {
        let count = level.windows.len();
        level.windows.retain(|window| {
            let [first, last, best] = window.points;
            first <= best && best <= last && last < threshold.len() && threshold[best] == window.threshold
        });
        if level.windows.len() < count {
            let what = format!("{} of {count} windows at A = {} are", count - level.windows.len(), level.amplitude);
            lacks.left_out(what, "they are none of the backbone");
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
        made: jiff::Timestamp::now().to_string(),
        missing,
    }
}

/// Monitored dofs, with their clearances where they are normal to the casing.
pub fn monitors(model: &Model) -> Vec<Monitor> {
    let gap = |dof: usize| {
        model.elements.iter().find_map(|element| match &element.law {
            LawKind::Contact(law) => {
                matches!(element.channels[0][..], [(normal, _)] if normal == dof).then_some(law.gap)
            }
            _ => None,
        })
    };
    model.monitors.iter().map(|&dof| Monitor { name: model.dofs[dof].clone(), gap: gap(dof) }).collect()
}

fn read_backbone(reader: &Reader, size: &Size) -> Result<Option<Backbone>> {
    let message = reader.backbone()?;
    let backbone = message.map(|message| message.backbone(size).map_err(|error| reader.corrupt(error))).transpose()?;
    let is_somewhere = |point: &BackbonePoint| point.point.omega().is_finite() && point.arc.is_finite();
    match backbone {
        Some(backbone) if !backbone.points.iter().all(is_somewhere) => {
            Err(reader.corrupt("a frequency or an arc length is not a number"))
        }
        readable => Ok(readable),
    }
}

/// The branches that are drawn, with the index of their level.
fn drawn<'s>(survey: &'s Survey, selection: &Selection, lacks: &mut Lacks) -> Vec<(usize, &'s BranchRow)> {
    let levels = &survey.levels;
    let stride = match selection {
        Selection::NoBranches => return Vec::new(),
        Selection::All | Selection::Amplitudes(_) => 1,
        Selection::Fitting => {
            let points: usize = survey.branches().map(|(_, branch)| branch.points).sum();
            points.div_ceil(POINTS).max(1)
        }
    };
    let chosen: HashSet<usize> = (0..levels.len()).rev().step_by(stride).collect();
    if chosen.len() < levels.len() {
        let (drawn, all) = (chosen.len(), levels.len());
        let sentence = format!(
            "Branches are drawn for {drawn} of {all} forcing levels: more would be too heavy; --levels chooses."
        );
        lacks.missing.push(sentence);
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
    lacks: &mut Lacks,
) -> (Vec<Curve>, Option<Motions>) {
    let mut curves: Vec<Curve> = Vec::new();
    let share = (MOTIONS / drawn.len().max(1)).clamp(1, MOTIONS_PER_BRANCH);
    for &(level, branch) in drawn {
        let read = whole(reader, branch).and_then(|result| {
            let curve = Curve::of(&result, level).map_err(|error| error.to_string())?;
            if let Some(curve) = &curve {
                motions.choose((curves.len(), curve), &result, &size, share).map_err(|error| error.to_string())?;
            }
            Ok(curve)
        });
        curves.extend(lacks.take(format_args!("The branch of task {} is", branch.task), read).flatten());
    }
    let motions = (!motions.points.is_empty()).then_some(motions);
    (curves, motions)
}
