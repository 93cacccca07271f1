//! What the table and the sentences below it are made of, as the store has it.

use super::LEVELS;
use super::monitors::{self, Largest};
use crate::overview::{Level, Omissions, Overview, bounds, doubts};
use crate::store::{BranchRow, CurveRow, MotionRow, PushRow, Reader, Result, SearchCounts};
use protocol::backbone::BackboneMessage;
use protocol::curve::Size;
use solver::response::backbone::Backbone;
use solver::response::branch::Outcome;
use solver::response::modes::ModesFollowed;
use solver::settings::{FrequencySettings, Settings};
use solver::structure::Model;

/// What is known of one order of motions. What cannot be read is as if it were not there yet.
pub(super) struct Known {
    /// Levels and what they have.
    pub overview: Overview,
    /// The model, its force on the harmonic of this order.
    pub model: Option<Model>,
    /// Names of the monitored dofs; the table is of the first.
    pub monitors: Vec<String>,
    /// How far the others move at most.
    pub others: Vec<Largest>,
    /// Frequency (rad/s) and amplitude (m) of the peaks of main branches that stand out beside the one that the table begins with, of the
    /// levels shown: with the branch's key.
    pub further_peaks: Vec<PeaksOf>,
    /// Settings of the study.
    pub settings: Option<Settings>,
    /// Bounds of the frequency that were given.
    pub given: FrequencySettings,
    /// Those that were looked at, once the backbones are known.
    pub reached: Option<(f64, f64)>,
    /// How main branches end, with their amplitudes as typed.
    pub mains: Vec<(String, Outcome)>,
    /// Fold curves.
    pub curves: Vec<CurveRow>,
    /// What became of random starts and folds.
    pub search: SearchCounts,
    /// Modes with backbones, from 0, the primary one first.
    pub backbones: Vec<(usize, Option<Backbone>)>,
    /// Whether the backbones are still to come.
    pub awaits_backbones: bool,
    /// How much of the run cannot be read.
    pub damaged: usize,
    /// What is not known to its end of what was followed, in a sentence.
    pub doubts: Option<String>,
    /// Which modes were followed and which not.
    pub modes: Option<ModesFollowed>,
    /// What unstable motions turn into.
    pub motions: Vec<MotionRow>,
    /// What throws the structure from one branch onto another.
    pub pushes: Vec<PushRow>,
    /// Whether these are motions of a further order, of which no main branches are followed.
    pub is_further: bool,
    /// Whether the run looks for no other order.
    pub is_only_order: bool,
}

impl Known {
    /// Of the order that the reader tells of.
    pub fn read(reader: &Reader) -> Result<Self> {
        let mut omissions = Omissions::default();
        let overview = Overview::read(reader, &mut omissions)?;
        let backbone = omissions.read("The backbone is", reader.backbone());
        let awaits_backbones = backbone.as_ref().is_some_and(Option::is_none);
        let further = omissions.read("Further backbones are", reader.further_backbones()).unwrap_or_default();
        let model = overview.model.as_ref().and_then(|message| message.model().ok());
        let names = |model: &Model| model.monitors().iter().map(|&dof| model.dofs()[dof].clone()).collect();
        let monitors: Vec<String> = model.as_ref().map(names).unwrap_or_default();
        let others = monitors::others(reader, &overview.levels, &monitors);
        let peaks: Result<Vec<_>> =
            overview.levels.iter().take(LEVELS).map(|level| further_peaks(reader, level)).collect();
        let peaks = peaks.map(|peaks| peaks.concat());
        let decoded = |message: BackboneMessage| {
            (message.mode, model.as_ref().and_then(|model| message.backbone(&Size::of(model)).ok()))
        };
        let backbones = backbone.flatten().into_iter().chain(further).map(decoded).collect();
        let settings = overview.header.as_ref().map(|header| header.settings);
        let reach = omissions.read("The frequency range of the sweep is", reader.reach()).flatten();
        let is_further = reader.order().is_some();
        // Of what it is made of each part that cannot be read counts for itself.
        let doubts = doubts(reader).unwrap_or_default();
        let mut known = Self {
            damaged: 0,
            others: omissions.read("How far monitored dofs move is", others).unwrap_or_default(),
            further_peaks: omissions.read("Peaks of main branches are", peaks).unwrap_or_default(),
            monitors,
            settings,
            given: settings.map(|settings| settings.frequency).unwrap_or_default(),
            reached: reach.map(|reach| reach.frequency),
            mains: omissions.read("How main branches end is", reader.main_outcomes()).unwrap_or_default(),
            curves: omissions.read("The list of fold curves is", reader.curves()).unwrap_or_default(),
            search: omissions.read("What became of folds is", reader.search_counts()).unwrap_or_default(),
            backbones,
            awaits_backbones,
            doubts,
            modes: omissions.read("Which modes were followed is", reader.modes()).flatten(),
            motions: omissions.read("The list of motions is", reader.motions()).unwrap_or_default(),
            pushes: omissions.read("The list of pushes is", reader.pushes()).unwrap_or_default(),
            is_further,
            is_only_order: !is_further && reader.further_orders()?.is_empty(),
            model,
            overview,
        };
        known.damaged = omissions.damaged.len();
        Ok(known)
    }

    /// Levels, by forcing amplitude.
    pub fn levels(&self) -> &[Level] {
        &self.overview.levels
    }

    /// Those that the table shows.
    pub fn shown(&self) -> impl Iterator<Item = &Level> {
        self.levels().iter().take(LEVELS)
    }

    /// Bounds of the frequency within which something is looked for.
    pub fn bounds(&self) -> FrequencySettings {
        bounds(self.given, self.reached, self.is_further)
    }
}

/// The key of a branch, and frequency (rad/s) and amplitude (m) of its peaks.
pub type PeaksOf = (i64, Vec<(f64, f64)>);

/// The peaks of the main branches of a level beside those that the table begins with, each with the branch's key: of a curve that was found
/// in pieces those of the others stand for themselves.
fn further_peaks(reader: &Reader, level: &Level) -> Result<Vec<PeaksOf>> {
    let first = level.main().map(|row| row.id).filter(|_| level.main_curves() == 1);
    let of = |row: &BranchRow| Ok((row.id, reader.standing_peaks(row, first.is_some_and(|first| first != row.id))?));
    level.mains().map(of).collect()
}
