//! Reads a report from the store. What cannot be read becomes a sentence in its place.

use super::curve::Curve;
use super::motion::Motions;
use super::verdict::{Evidence, verdict};
use super::words::count;
use super::{Account, BackboneCurve, Level, Monitor, Report, RunFacts, Ways};
use crate::store::{Reader, Result, RunHeader};
use crate::survey::{Survey, levels, survey};
use protocol::curve::Size;
use protocol::ids::TaskId;
use protocol::to_everyone::Stage;
use solver::backbone::Backbone;
use solver::laws::LawKind;
use solver::model::Model;
use std::collections::HashSet;

/// Points of branches that a page takes without becoming heavy.
const POINTS: usize = 250_000;
/// Motions kept for all branches together.
const MOTIONS: usize = 400;
/// Motions kept for one branch at most.
const MOTIONS_PER_BRANCH: usize = 40;

/// Which levels have their branches drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Selection {
    /// As many as a page takes.
    #[default]
    Fitting,
    /// All of them.
    All,
    /// Those of these forcing amplitudes.
    Amplitudes(Vec<f64>),
}

/// A branch in the store.
struct Stored {
    task: String,
    level: usize,
    points: usize,
}

impl Report {
    /// Reads a run, finished, in progress, cancelled or damaged.
    ///
    /// # Errors
    /// If there is no run, or if what it is about (header, model, levels) cannot be read.
    pub fn read(reader: &Reader, selection: &Selection) -> Result<Self> {
        let header = reader.header()?;
        let _snapshot = reader.snapshot()?;
        let Survey { levels: summaries, .. } = survey(reader)?;
        let stage = reader.stage()?;
        let rows = levels(reader)?;
        let model = header.model.model().map_err(|error| reader.corrupt(error))?;
        let size = Size::of(&model);
        let mut missing = Missing::default();

        let levels: Result<Vec<Level>> =
            rows.iter().zip(&summaries).map(|(row, summary)| Level::read(reader, row, summary)).collect();
        let levels = levels?;
        let backbone = missing.unless("the backbone", read_backbone(reader, &size)).flatten();
        let omega = missing.unless("the frequency range", reader.reach()).flatten().map(|reach| reach.frequency);
        let curve = backbone.as_ref().map(|backbone| BackboneCurve::new(backbone, &model));
        let stored = missing.unless("the list of branches", branches(reader)).unwrap_or_default();
        let chosen = missing.chosen(stored, &levels, selection);
        let (branches, motions) = missing.curves(reader, &model, header.settings.harmonics.count, &chosen);
        let account = missing.unless("the account", Account::read(reader, &header.study)).unwrap_or_default();
        missing.unfinished(stage, &levels, backbone.is_some());

        let monitors = monitors(&model);
        let evidence = Evidence {
            levels: &summaries,
            events: curve.as_ref().map_or(&[], |curve| &curve.events),
            monitor: &monitors[0].name,
            gap: monitors[0].gap,
        };
        Ok(Self {
            verdict: verdict(&evidence),
            omega,
            ways: Ways::new(&summaries, curve.as_ref()),
            run: facts(header, stage, missing.0),
            monitors,
            levels,
            branches,
            backbone: curve,
            motions,
            account,
        })
    }
}

fn facts(header: RunHeader, stage: Stage, missing: Vec<String>) -> RunFacts {
    RunFacts {
        id: header.run.to_string(),
        name: header.name,
        model: header.model.name,
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
    message.map(|message| message.backbone(size).map_err(|error| reader.corrupt(error))).transpose()
}

/// Branches by level: main, then isolas.
fn branches(reader: &Reader) -> Result<Vec<Stored>> {
    let sql = "SELECT task, (SELECT count(*) FROM levels AS lower \
               WHERE (lower.value, lower.level) < (levels.value, levels.level)) AS place, points \
               FROM branches JOIN levels USING (level) ORDER BY place, kind DESC, number";
    reader.all(sql, [], |row| Ok(Stored { task: row.get(0)?, level: row.get(1)?, points: row.get(2)? }))
}

/// Sentences about what is not there.
#[derive(Debug, Default)]
struct Missing(Vec<String>);

impl Missing {
    /// What was read, or a note that it could not be.
    fn unless<T>(&mut self, what: &str, read: Result<T>) -> Option<T> {
        read.map_err(|error| self.0.push(format!("Damaged: {what} cannot be read ({error})."))).ok()
    }

    /// The branches that are drawn.
    fn chosen(&mut self, stored: Vec<Stored>, levels: &[Level], selection: &Selection) -> Vec<Stored> {
        let wanted: HashSet<usize> = match selection {
            Selection::All => return stored,
            Selection::Amplitudes(list) => {
                (0..levels.len()).filter(|&level| list.contains(&levels[level].value)).collect()
            }
            Selection::Fitting => {
                let points: usize = stored.iter().map(|branch| branch.points).sum();
                let stride = points.div_ceil(POINTS).max(1);
                (0..levels.len()).rev().step_by(stride).collect()
            }
        };
        if wanted.len() < levels.len() {
            let (drawn, all) = (wanted.len(), levels.len());
            self.0.push(format!("Branches are drawn for {drawn} of {all} forcing levels; --levels chooses others."));
        }
        stored.into_iter().filter(|branch| wanted.contains(&branch.level)).collect()
    }

    /// Branches one after the other, each checked against its checksum.
    fn curves(
        &mut self,
        reader: &Reader,
        model: &Model,
        harmonics: usize,
        stored: &[Stored],
    ) -> (Vec<Curve>, Option<Motions>) {
        let mut curves: Vec<Curve> = Vec::new();
        let mut motions = Motions::new(model, harmonics);
        let share = (MOTIONS / stored.len().max(1)).clamp(1, MOTIONS_PER_BRANCH);
        let size = Size::of(model);
        for branch in stored {
            let what = format!("the branch of task {}", branch.task);
            let read = read_curve(reader, branch, (curves.len(), &mut motions), (&size, share));
            curves.extend(self.unless(&what, read).flatten());
        }
        let motions = (!motions.points.is_empty()).then_some(motions);
        (curves, motions)
    }

    /// What is still to come or was given up.
    fn unfinished(&mut self, stage: Stage, levels: &[Level], has_backbone: bool) {
        let pending: usize = levels.iter().map(|level| level.pending).sum();
        let dead: usize = levels.iter().map(|level| level.dead).sum();
        if !has_backbone {
            self.0.push("There is no backbone yet: nothing is predicted and no branch is computed.".into());
        }
        if pending > 0 {
            let why = if stage == Stage::Cancelled { "the run was cancelled" } else { "the run is not finished" };
            self.0.push(format!("{} still to come: {why}.", count(pending, "task")));
        }
        if dead > 0 {
            self.0.push(format!("{} given up after repeated failures: see the account.", count(dead, "task")));
        }
        for level in levels {
            if let Some(failure) = &level.main_failure {
                self.0.push(format!("A = {} has no main branch: {failure}.", level.amplitude));
            }
        }
    }
}

fn read_curve(
    reader: &Reader,
    branch: &Stored,
    (index, motions): (usize, &mut Motions),
    (size, share): (&Size, usize),
) -> Result<Option<Curve>> {
    let task = TaskId::new(&branch.task).map_err(|error| reader.corrupt(error))?;
    let Some(result) = reader.result(&task)? else { return Ok(None) };
    let curve = Curve::of(&result, branch.level).map_err(|error| reader.corrupt(error))?;
    if let Some(curve) = &curve {
        motions.choose((index, curve), &result, size, share).map_err(|error| reader.corrupt(error))?;
    }
    Ok(curve)
}
