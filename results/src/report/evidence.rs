//! What the answers of a report are drawn from.

use super::folded::Folded;
use super::ordinary::Ordinary;
use crate::curves::{BackboneCurve, Monitor, Touch};
use crate::overview::{Excitation, Lesser, Level, LookedFor, has_joints, undetermined};
use crate::store::{CurveRow, MotionRow, PushRow, SearchCounts};
use crate::summary_table::{LengthUnit, Units};
use crate::told::{frequency_first_in, in_both_units_from};
use crate::words::count;
use protocol::to_everyone::Stage;
use solver::response::branch::Outcome;
use solver::response::modes::ModesFollowed;
use solver::settings::FrequencySettings;
use solver::structure::Model;

/// What the answers are about.
pub struct Evidence<'r> {
    /// Number of things that are stored and cannot be read, or are not what was stored.
    pub damaged: usize,
    /// Levels by forcing amplitude.
    pub levels: &'r [Level],
    /// The backbone of the primary mode, if it is known.
    pub backbone: Option<&'r BackboneCurve>,
    /// The backbones of further modes.
    pub further: &'r [BackboneCurve],
    /// Which modes were followed and which not, if that is known.
    pub modes: Option<&'r ModesFollowed>,
    /// How main branches end, with their forcing amplitudes as typed.
    pub mains: &'r [(String, Outcome)],
    /// Levels whose main branches turn back.
    pub folded: Vec<Folded>,
    /// Fold curves.
    pub curves: &'r [CurveRow],
    /// What became of the tasks that follow from folds.
    pub search: SearchCounts,
    /// What unstable motions turn into.
    pub motions: &'r [MotionRow],
    /// Pushes that were marched.
    pub pushes: &'r [PushRow],
    /// Why folds cannot be followed, if so.
    pub why_no_folds: Option<String>,
    /// How far the run has come, if that can be read.
    pub stage: Option<Stage>,
    /// The model.
    pub structure: Structure,
    /// Number of harmonics H.
    pub harmonics: usize,
    /// The lowest harmonic beyond that of the force that motions can have: [`crate::overview::least_added`].
    pub least_added: usize,
    /// Bounds at which branches apart from the main ones end.
    pub bounds: FrequencySettings,
    /// Bounds of the frequency that were given.
    pub given: FrequencySettings,
    /// The largest amplitude of branches, m, if it was given.
    pub max_amplitude: Option<f64>,
    /// Those that were looked at, once the backbones are known.
    pub reached: Option<(f64, f64)>,
    /// Orders of motions that the run looks for.
    pub asked: Vec<usize>,
    /// What was found of further orders of motions, where the run looks for several and these are the first.
    pub orders: Vec<OrderFound>,
    /// Whether these are motions of a further order, of which no main branches are followed.
    pub is_further: bool,
    /// The ordinary response at a level, by its forcing amplitude, and a frequency of the response, rad/s.
    pub ordinary: Box<dyn Fn(f64, f64) -> Option<Ordinary> + 'r>,
    /// Units of the run.
    pub units: Units,
    /// The unit of lengths, if one was chosen.
    pub length_unit: Option<LengthUnit>,
}

/// What was found of a further order of motions, in short.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OrderFound {
    /// Order m.
    pub order: usize,
    /// Levels at which isolas were found, as typed.
    pub levels: Vec<String>,
    /// Whether all of it is known.
    pub is_complete: bool,
}

impl OrderFound {
    /// Of the levels of an order.
    pub fn new(order: usize, levels: &[Level]) -> Self {
        let found = levels.iter().filter(|level| level.highest_isola().is_some());
        let is_complete = levels.iter().all(Level::is_complete);
        Self { order, levels: found.map(|level| level.amplitude.clone()).collect(), is_complete }
    }

    /// The same as a sentence.
    pub fn sentence(&self) -> String {
        let Self { order, levels, is_complete } = self;
        let motions = format!("motions that last {order} periods of the force");
        let so_far = if *is_complete { "" } else { " so far" };
        match &levels[..] {
            [] => format!("Of {motions} no isola was found{so_far} (see their own report)."),
            [only] => format!("Of {motions} an isola was found{so_far} at A = {only} (see their own report)."),
            [first, .., last] => format!(
                "Of {motions} isolas were found{so_far} at {}, from A = {first} to {last} (see their own report).",
                count(levels.len(), "level")
            ),
        }
    }
}

impl<'r> Evidence<'r> {
    /// All backbones that are known, that of the primary mode first.
    pub fn backbones(&self) -> impl Iterator<Item = &'r BackboneCurve> + use<'r> {
        self.backbone.into_iter().chain(self.further)
    }

    /// A frequency in both units, that of the run first.
    pub fn frequency(&self, omega: f64) -> String {
        frequency_first_in(omega, self.units.frequency)
    }

    /// The same within parentheses.
    pub fn in_both_units(&self, omega: f64) -> String {
        in_both_units_from(omega, self.units.frequency)
    }

    /// What was looked for and what was not.
    pub fn looked_for(&self) -> LookedFor<'_> {
        LookedFor {
            levels: self.levels,
            backbones: self.backbones().map(|backbone| (backbone.mode, backbone.end)).collect(),
            short: self.backbones().filter(|backbone| backbone.falls_short).map(|backbone| backbone.mode).collect(),
            crowded: self.backbones().filter(|backbone| backbone.is_crowded).map(|backbone| backbone.mode).collect(),
            modes: self.modes,
            all_modes: self.structure.modes,
            harmonic: self.structure.harmonic,
            asked: &self.asked,
            curves: self.curves.len(),
            search: self.search,
            why_no_folds: self.why_no_folds.as_deref(),
            has_joints: self.structure.has_joints,
        }
    }
}

/// What the sentences need of the model.
#[derive(Debug, Clone, Default)]
pub struct Structure {
    /// The dof whose amplitudes are given.
    pub monitor: String,
    /// All monitored dofs, that one first.
    pub monitors: Vec<String>,
    /// Where it touches the casing.
    pub touch: Option<Touch>,
    /// Number of modes.
    pub modes: usize,
    /// Whether there are joints, which may stick.
    pub has_joints: bool,
    /// Harmonic m of the response that the forcing acts on.
    pub harmonic: usize,
    /// What motions that branch off others have lost.
    pub lesser: Lesser,
    /// Number of stops (rigid contacts).
    pub stops: usize,
    /// What it does of itself.
    pub excitation: Excitation,
    /// That its place is not determined, if so.
    pub undetermined: Option<String>,
}

impl Structure {
    /// The dof whose amplitudes are given, if others are monitored besides.
    pub fn of_several(&self) -> Option<&str> {
        self.monitors.first().filter(|_| self.monitors.len() > 1).map(String::as_str)
    }

    /// Of a model, amplitudes being those of this dof.
    pub fn new(model: &Model, monitor: &Monitor) -> Self {
        Self {
            monitor: monitor.name.clone(),
            monitors: model.monitors().iter().map(|&dof| model.dofs()[dof].clone()).collect(),
            touch: monitor.touch,
            modes: model.size(),
            has_joints: has_joints(model),
            harmonic: model.forcing().harmonic,
            lesser: Lesser::of(model),
            stops: model.contacts().count(),
            excitation: Excitation::of(model),
            undetermined: undetermined(model),
        }
    }
}
