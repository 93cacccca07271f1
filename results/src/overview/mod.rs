//! What a run has found so far, level by level, as the store has it: branches, windows and what became of them; and what
//! is missing.

mod amplitude_bound;
mod around_largest;
mod at_rest;
mod beginnings;
mod bounds;
mod confirmed;
mod counted;
mod cut_mains;
mod doubts;
mod elsewhere;
mod event_words;
mod events;
mod excitation;
mod family;
mod folds;
mod forcing_digits;
mod largest_stable;
mod lesser;
mod level;
mod lives;
mod looked_for;
mod merges;
pub mod modes;
mod near_largest;
mod of_kind;
mod omissions;
mod overlooked;
mod parties;
mod penetration;
mod place;
mod predicted;
mod reasons;
mod sampled;
mod shift;
mod sliding;
mod stability_words;
mod stories;
mod truncation;
mod unfinished;
mod unknown;
mod verified;
pub mod windows;

pub use amplitude_bound::amplitude_bound;
pub use around_largest::around_largest;
pub use at_rest::{acting_at_rest, pressed_at_rest};
pub use beginnings::{beginning, is_begun};
pub use bounds::{BESIDE, beyond, bounds, is_at_bound, is_within, reach_sentence};
pub use confirmed::{Doubts, is_unconfirmed, is_unmatched};
pub use cut_mains::cut_mains;
pub use doubts::{doubts, ends_far_beyond, ends_near, stopped};
pub use event_words::{BIRTH, DEATH, EVENTS, EventWords, MERGE, MERGES};
pub use events::{Events, events};
pub use excitation::{Excitation, Unforced};
pub use folds::{
    CurveEvent, born_above, born_below, born_between, curve_events, events_of, later_birth, level_between,
    levels_after, most_folds, not_followed, not_followed_sentence, why_no_folds,
};
pub use forcing_digits::{forcing_label, truncation_doubt};
pub use largest_stable::{
    StableResponse, largest_stable, largest_stable_sentence, passed_over_sentence, unstable_peak_sentence,
};
pub use lesser::Lesser;
pub use level::{Level, Seeds, UNTOUCHED, highest, is_untouched, named, undecided};
pub use lives::parted_between;
pub use looked_for::{LookedFor, has_joints};
pub use merges::merge_verb;
pub use near_largest::near_largest;
pub use of_kind::{of_kind, undecided_kinds};
pub use omissions::{Omissions, damage_sentence};
pub use overlooked::{Bounds, overlooked};
pub use place::undetermined;
pub use predicted::{Predicted, between_levels, told_threshold};
pub use reasons::briefly;
pub use sampled::sampled;
pub use shift::{shift, shift_sentence};
pub use sliding::turned_sliding;
pub use stability_words::{NOT_KNOWN, StabilityOf, VERDICTS, VerdictWords, stability_of, verdict_words};
pub use truncation::{asks_for_harmonics, is_peak_lost, least_added, truncation, truncation_of};
pub use unfinished::unfinished;
pub use unknown::{unknown_events, unknown_sentence};
pub use windows::{elsewhere, overlaps, within};

pub use crate::store::{BranchRow, Origin, WindowOutcome, WindowRow};

pub(crate) use omissions::detail;
pub(crate) use verified::verified_result;

use crate::store::{Reader, Result, RunHeader};
use protocol::model::ModelMessage;
use protocol::to_everyone::StoredResult;
use solver::response::task::BranchId;

/// A run without its points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Overview {
    /// What does not change; `None` if it cannot be read.
    pub header: Option<RunHeader>,
    /// Model; `None` if it cannot be read.
    pub model: Option<ModelMessage>,
    /// Levels by amplitude.
    pub levels: Vec<Level>,
}

impl Overview {
    /// Reads what can be read, at any stage (of one moment if the caller holds a snapshot).
    ///
    /// # Errors
    /// If neither header nor model nor levels can be read.
    pub fn read(reader: &Reader, omissions: &mut Omissions) -> Result<Self> {
        let (header, model, levels) = match (reader.header(), reader.verified_model(), reader.levels()) {
            (Err(error), Err(_), Err(_)) => return Err(error),
            all => all,
        };
        let header = omissions.read("Names and settings of the run are", header);
        let model = omissions.read("The model is", model);
        let levels = omissions.read("Levels and branches are", levels).unwrap_or_default();
        let mut levels: Vec<Level> = levels.into_iter().map(|row| Level::read(reader, row, omissions)).collect();
        let curves = omissions.read("What fold curves join is", reader.curves()).unwrap_or_default();
        family::join(&mut levels, &curves, &mut family::Motions::of(reader));
        Ok(Self { header, model, levels })
    }

    /// Branches with their levels: level by level, main branches first.
    pub fn branches(&self) -> impl Iterator<Item = (&Level, &BranchRow)> {
        self.levels.iter().flat_map(|level| level.branches.iter().map(move |branch| (level, branch)))
    }

    /// Hands every branch that is what was stored to `sink`, one after the other, with its [`Level::file_name`]; notes the
    /// others.
    ///
    /// # Errors
    /// Those of `sink`.
    pub fn each_branch<E>(
        &self,
        reader: &Reader,
        omissions: &mut Omissions,
        mut sink: impl FnMut(&mut Omissions, &str, StoredResult) -> std::result::Result<(), E>,
    ) -> std::result::Result<(), E> {
        for (level, branch) in self.branches() {
            let name = level.file_name(branch);
            if let Some(result) = omissions.take(format_args!("Branch {name} is"), verified_result(reader, branch)) {
                sink(omissions, &name, result)?;
            }
        }
        Ok(())
    }
}

/// What a branch is called in a sentence.
pub(crate) fn in_words(branch: &BranchRow) -> String {
    let name = branch.name();
    if name == BranchId::MAIN.to_string() || branch.joints() > 0 { "the main branch".into() } else { name }
}
