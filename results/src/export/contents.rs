//! The contents of the files for MATLAB and NumPy. `EXPORTS.md` documents every name.

mod run;

use super::listed;
use super::value::{Group, Record, Value};
use crate::overview::Overview;
use crate::overview::{Omissions, detail, unfinished};
use crate::store::{Displacements, Reader, further_owner};
use protocol::array::{Array, ArrayError};
use protocol::backbone::BackboneMessage;
use protocol::branch::BranchMessage;
use protocol::columns::Columns;
use protocol::curve::{Motions, Points};
use protocol::level::typed;
use protocol::model::ModelMessage;
use protocol::to_everyone::StoredResult;
use solver::response::branch::{Outcome, SpecialKind};
use solver::response::columns::{self, Axis, Column};
use solver::structure::laws::Law;

/// What the contents of all files are read with.
pub(super) struct Contents<'r> {
    reader: &'r Reader,
    overview: &'r Overview,
    names: Option<Names>,
}

/// Names along the axes of arrays.
struct Names {
    displacements: Displacements,
    displacement_dofs: Vec<String>,
    monitors: Vec<String>,
    contacts: Vec<String>,
    modes: Vec<String>,
    arguments: Vec<String>,
}

impl Names {
    /// Of a model; `None` if its arrays do not fit.
    fn new(model: &ModelMessage) -> Option<Self> {
        let displacements = Displacements::new(model).ok()?;
        let contacts = model.elements.iter().filter(|element| element.law.rigid().is_some());
        let arguments = model
            .elements
            .iter()
            .flat_map(|element| (1..=element.channels.len()).map(|argument| format!("{} {argument}", element.name)));
        Some(Self {
            displacement_dofs: displacements.names(model).into_iter().map(String::from).collect(),
            displacements,
            monitors: monitors(model),
            contacts: contacts.map(|element| element.name.clone()).collect(),
            modes: (1..=model.dofs.len()).map(|mode| format!("mode {mode}")).collect(),
            arguments: arguments.collect(),
        })
    }

    fn add(&self, group: &mut Group<'_>) {
        group.add("displacement_dofs", self.displacement_dofs.clone());
        group.add("monitors", self.monitors.clone());
        group.add("contacts", self.contacts.clone());
        group.add("modes", self.modes.clone());
        group.add("arguments", self.arguments.clone());
    }
}

/// Owner of the arrays of the primary mode's backbone; those of others begin with it.
const BACKBONE: &str = "backbone";

impl<'r> Contents<'r> {
    /// Of a run.
    pub fn new(reader: &'r Reader, overview: &'r Overview) -> Self {
        Self { reader, overview, names: overview.model.as_ref().and_then(Names::new) }
    }

    /// The file of the run: everything but the points of branches. Notes what is missing.
    pub fn run(&self, omissions: &mut Omissions) -> Record {
        let (mut record, mut rest) = (Record::default(), Record::default());
        let backbone = omissions.take("The backbone is", backbone(self.reader));
        omissions.missing.extend(unfinished(&self.overview.levels, backbone.as_ref().is_none_or(Option::is_some)));
        run::header(&mut record.group("run"), self.reader, self.overview, omissions);
        if let Some(model) = &self.overview.model {
            self.model(&mut rest.group("model"), model);
        }
        run::levels(&mut rest.group("levels"), self.overview);
        let backbone = backbone.flatten();
        let further = omissions.take("Further backbones are", further(self.reader)).unwrap_or_default();
        let all: Vec<&BackboneMessage> = backbone.iter().chain(&further).collect();
        let monitors = self.overview.model.as_ref().map(monitors).unwrap_or_default();
        let lists = listed::all(self.reader, self.overview, &all, &monitors, omissions);
        if let Some(backbone) = backbone {
            self.backbone(&mut rest.group("backbone"), backbone, BACKBONE, omissions);
        }
        for backbone in further {
            let (name, owner) = (format!("backbone_{}", backbone.mode + 1), further_owner(backbone.mode));
            self.backbone(&mut rest.group(&name), backbone, &owner, omissions);
        }
        run::windows(&mut rest.group("windows"), self.overview);
        if let Some(modes) = omissions.read("Which modes were followed is", self.reader.modes()).flatten() {
            run::modes(&mut rest.group("modes"), &modes);
        }
        run::branches(&mut rest.group("branches"), self.overview);
        for list in lists {
            list.add(&mut rest.group(list.name));
        }
        // Now everything that is missing is known.
        record.group("run").add("missing", omissions.sentences().cloned().collect::<Vec<String>>());
        record.0.append(&mut rest.0);
        record
    }

    fn model(&self, group: &mut Group<'_>, model: &ModelMessage) {
        run::model(group, model);
        if let Some(names) = &self.names {
            names.add(group);
        }
    }

    /// A backbone, whose arrays are stored with `owner`.
    fn backbone(&self, group: &mut Group<'_>, backbone: BackboneMessage, owner: &str, omissions: &mut Omissions) {
        group.add("mode", backbone.mode);
        group.add("status", backbone.outcome.to_string());
        group.add("rejections", backbone.rejections);
        if let Some(reach) = omissions.read("The reach of branches is", self.reader.reach()).flatten() {
            group.add("omega_low", reach.frequency.0);
            group.add("omega_high", reach.frequency.1);
            group.add("amplitude_bound", reach.amplitude);
        }
        let what = match owner {
            BACKBONE => "The displacements of the backbone are".to_string(),
            _ => format!("The displacements of the backbone of mode {} are", backbone.mode + 1),
        };
        self.points(group, backbone.points, (&what, owner), omissions);
        add_columns(group, &backbone.columns, columns::of_backbone_in_files());
    }

    /// The file of branch `name`: everything that is known of it.
    pub fn branch(&self, name: &str, result: StoredResult, omissions: &mut Omissions) -> Option<Record> {
        let mut record = Record::default();
        let mut group = record.group("");
        let (id, branch) = (result.name?, result.branch?);
        if let Err(error) = check(&branch.points) {
            omissions.left_out(format_args!("Branch {name} is"), error);
            return None;
        }
        group.add("level", typed(&result.amplitude.text));
        group.add("level_value", result.amplitude.value);
        group.add("kind", id.kind.name());
        group.add("number", id.number + 1);
        group.add("status", branch.outcome.to_string());
        group.add("closed", branch.outcome == Outcome::Closed);
        group.add("rejections", branch.rejections);
        special(&mut group, &branch);
        group.add("task", result.task.as_str());
        group.add("attempt", result.attempt.0 as usize);
        group.add("worker", result.worker.as_str());
        group.add("program", result.program);
        group.add("seconds", result.seconds);
        group.add("peak_standing", run::standing(branch.peak_standing));
        let certificate = branch.certificate.unwrap_or_default();
        for (name, of) in run::CERTIFICATE {
            group.add(name, of(&certificate).unwrap_or(f64::NAN));
        }
        let verified = self.reader.verification(result.task.as_str());
        let verified = omissions.read(format_args!("The stability of {name} is"), verified).flatten();
        run::stability(&mut group, branch.points.len(), verified.as_ref());
        let what = format!("The displacements of branch {name} are");
        self.points(&mut group, branch.points, (&what, result.task.as_str()), omissions);
        if let Some(names) = &self.names {
            names.add(&mut group);
        }
        Some(record)
    }

    /// Points of a curve, whose arrays fit together; `(what, owner)`: its displacements in a sentence and in the store.
    fn points(&self, group: &mut Group<'_>, points: Points, (what, owner): (&str, &str), omissions: &mut Omissions) {
        let displacement = self.displacement(owner, &points.motions);
        group.add("harmonics", points.motions.harmonics);
        group.add("omega", points.motions.omega);
        group.add("decay", points.motions.decay);
        group.add("forcing", points.motions.forcing);
        group.add("argument", Value::Complex(points.motions.argument));
        group.add("modal", Value::Complex(points.motions.modal));
        match displacement {
            Ok(displacement) => group.add("displacement", Value::Complex(displacement)),
            Err(why) => omissions.left_out(what, why),
        }
        add_columns(group, &points.columns, columns::of_points());
    }

    /// The displacements that are stored with `owner`, if they are those of the motions. They have no checksum.
    fn displacement(&self, owner: &str, motions: &Motions) -> Result<Array, String> {
        // Of backbones only those of the first order have arrays of their own.
        if self.reader.order().is_some() && owner.starts_with(BACKBONE) {
            let names = self.names.as_ref().ok_or("there is no model that they follow from")?;
            return names.displacements.array(motions).map_err(|error| error.to_string());
        }
        let stored = self.reader.array(owner, "displacement").map_err(|error| detail(&error))?;
        let stored = stored.ok_or("they are gone")?;
        let names = self.names.as_ref().ok_or("there is no model to compare them with")?;
        let expected = names.displacements.array(motions).map_err(|error| error.to_string())?;
        if agree(&stored, &expected) { Ok(stored) } else { Err("they are not those of the modal amplitudes".into()) }
    }
}

/// Names of the monitored dofs.
pub(super) fn monitors(model: &ModelMessage) -> Vec<String> {
    model.monitors.iter().filter_map(|&dof| model.dofs.get(dof)).cloned().collect()
}

/// The backbone, if there is one.
///
/// # Errors
/// If it cannot be read or its arrays do not fit together.
pub(super) fn backbone(reader: &Reader) -> Result<Option<BackboneMessage>, String> {
    let stored = reader.backbone().map_err(|error| detail(&error))?;
    stored.map(fitting).transpose()
}

/// The backbones of further modes.
///
/// # Errors
/// If they cannot be read or the arrays of one do not fit together.
pub(super) fn further(reader: &Reader) -> Result<Vec<BackboneMessage>, String> {
    reader.further_backbones().map_err(|error| detail(&error))?.into_iter().map(fitting).collect()
}

/// A backbone, if its arrays fit together.
fn fitting(backbone: BackboneMessage) -> Result<BackboneMessage, String> {
    let fit = || {
        check(&backbone.points)?;
        check_columns(&backbone.columns, columns::of_backbone(), backbone.points.len())
    };
    fit().map_err(|error: ArrayError| error.to_string())?;
    Ok(backbone)
}

/// Whether arrays of points fit together, for whatever number of channels, modes, monitored dofs and contacts.
fn check(points: &Points) -> Result<(), ArrayError> {
    let (count, motions) = (points.len(), &points.motions);
    for (name, array) in [("omega", &motions.omega), ("decay", &motions.decay), ("forcing", &motions.forcing)] {
        array.values(name, &[count])?;
    }
    check_columns(&points.columns, columns::of_points(), count)?;
    for (name, array) in [("argument", &motions.argument), ("modal", &motions.modal)] {
        array.series(name, &[count, width(array)], motions.harmonics)?;
    }
    Ok(())
}

/// Whether columns are of `count` points.
fn check_columns(
    columns: &Columns,
    list: impl Iterator<Item = &'static Column>,
    count: usize,
) -> Result<(), ArrayError> {
    for (column, array) in columns.among(list) {
        let shape = if column.axis == Axis::Point { vec![count] } else { vec![count, width(array)] };
        array.values(column.name, &shape)?;
    }
    Ok(())
}

/// Adds the columns that are there.
fn add_columns(group: &mut Group<'_>, columns: &Columns, list: impl Iterator<Item = &'static Column>) {
    columns.among(list).for_each(|(column, array)| group.add(column.name, array.clone()));
}

/// Length of the second axis.
fn width(array: &Array) -> usize {
    array.shape.get(1).copied().unwrap_or(0)
}

/// Whether two arrays are the same but for rounding: another processor adds up in another order.
fn agree(a: &Array, b: &Array) -> bool {
    const TOLERANCE: f64 = 1e-9;
    let (Ok(a), Ok(b)) = (a.values("displacement", &b.shape), b.values("displacement", &b.shape)) else { return false };
    let scale = b.iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
    a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= TOLERANCE * scale || a.to_bits() == b.to_bits())
}

fn special(group: &mut Group<'_>, branch: &BranchMessage) {
    let kind = |kind| match kind {
        SpecialKind::Start => "start",
        SpecialKind::Peak => "peak",
        SpecialKind::Fold => "fold",
        SpecialKind::BranchPoint => "branch_point",
    };
    group.add("special_kind", branch.special.iter().map(|point| kind(point.kind).to_string()).collect::<Vec<String>>());
    group.add("special_index", branch.special.iter().map(|point| point.index).collect::<Vec<usize>>());
}
