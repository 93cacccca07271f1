//! What was looked for and what was not, with the probability of having missed what only random starts can meet: how far the list of
//! branches of a run is complete.

use super::folds::not_followed;
use super::level::Level;
use super::modes;
use crate::store::SearchCounts;
use crate::words::{self, count, digits};
use solver::response::modes::ModesFollowed;

/// What a run, or one order of motions of it, has been searched by.
#[derive(Debug, Clone)]
pub struct LookedFor<'r> {
    /// Levels by forcing amplitude.
    pub levels: &'r [Level],
    /// Modes whose backbones are known, from 0, that of the primary mode first, each with the threshold A* where its backbone ends.
    pub backbones: Vec<(usize, Option<f64>)>,
    /// Which modes were followed and which not, if that is known.
    pub modes: Option<&'r ModesFollowed>,
    /// Number of modes of the model.
    pub all_modes: usize,
    /// Harmonic m of the response that the forcing acts on.
    pub harmonic: usize,
    /// Orders of motions that the run looks for.
    pub asked: &'r [usize],
    /// Number of fold curves.
    pub curves: usize,
    /// What became of random starts and folds.
    pub search: SearchCounts,
    /// Why folds cannot be followed, if so.
    pub why_no_folds: Option<&'r str>,
}

impl LookedFor<'_> {
    /// How far the list of branches reaches.
    pub fn sentence(&self) -> String {
        format!("Looked for: {}; {}.", self.searched(), self.not_searched())
    }

    /// The modes whose backbones are known: `mode 1`, or `modes 1 and 2`.
    pub fn mode(&self) -> String {
        let followed: Vec<usize> = self.backbones.iter().map(|(mode, _)| *mode).collect();
        if followed.is_empty() { "a mode".into() } else { words::modes(&followed) }
    }

    /// Where isolas were looked for: `the windows of mode 1 at 7 levels (12 seeds tried, 2 without a branch near them)`.
    fn searched(&self) -> String {
        let complete = || self.levels.iter().filter(|level| level.is_complete());
        let levels = complete().count();
        let tried: usize = complete().map(|level| level.seeds.tried).sum();
        let failed: usize = complete().map(|level| level.seeds.failed).sum();
        let harmonic = match self.harmonic {
            0 | 1 => String::new(),
            m => format!(", the forcing acting on harmonic {m}"),
        };
        let nowhere = if failed > 0 { format!(", {failed} without a branch near them") } else { String::new() };
        let complete = if levels == self.levels.len() { "level" } else { "complete level" };
        let (mode, levels) = (self.mode(), count(levels, complete));
        let folds = match self.curves {
            0 => String::new(),
            number => format!(" and along {}", count(number, "fold curve")),
        };
        let carried = match self.search.carried {
            0 => String::new(),
            number => {
                format!(
                    "; responses of branches that leave through bounds were followed along {} at one frequency",
                    count(number, "curve")
                )
            }
        };
        let crossings = match self.search.switched {
            0 => String::new(),
            number => format!("; what crosses the branches found, at {}", count(number, "branch point")),
        };
        let scouts = match self.search.scouts {
            0 => String::new(),
            scouts => format!(" (and others at {})", count(scouts, "larger forcing amplitude")),
        };
        let starts = match self.search.starts {
            0 => String::new(),
            number => {
                let and = if folds.is_empty() { " and" } else { "," };
                format!("{and} from {}{scouts}", count(number, "random start"))
            }
        };
        let homotopies = match self.search.homotopies {
            0 => String::new(),
            _ => format!("; {}, where nothing else had led to a branch", self.by_homotopies()),
        };
        format!(
            "the windows of {mode} at {levels} ({} tried{nowhere}{harmonic}){starts}{folds}{crossings}{carried}{homotopies}",
            count(tried, "seed")
        )
    }

    fn by_homotopies(&self) -> String {
        let count = match self.search.homotopies {
            1 => "1 homotopy".to_string(),
            number => format!("{number} homotopies"),
        };
        format!("{count} from motions that a force on their fundamental drives")
    }

    /// What was not looked for.
    fn not_searched(&self) -> String {
        let modes = match self.modes.map(modes::left_out) {
            Some(list) => list.into_iter().map(|modes| format!("of {modes}, ")).collect(),
            None if self.all_modes > 1 => "of other modes, ".to_string(),
            None => String::new(),
        };
        let harmonics = match self.harmonic > 1 || self.asked.len() > 1 {
            true => "other sub- and super-harmonics",
            false => "sub- and super-harmonics",
        };
        // The orders that are looked for are not among the others.
        let beside = match self.asked {
            [_, _, ..] => {
                let list: Vec<String> = self.asked.iter().map(ToString::to_string).collect();
                format!(" (than {} of the force)", list.join(", "))
            }
            _ => String::new(),
        };
        let mode = self.mode();
        let leads = if self.curves == 0 {
            format!("no energy balance of {mode} leads")
        } else {
            format!("neither an energy balance of {mode} nor a fold curve leads")
        };
        let folds = match self.why_no_folds {
            Some(why) => format!("; folds were not followed ({why})"),
            None => not_followed(self.search.hanging)
                .map_or_else(String::new, |folds| format!("; {folds} were not followed over the forcing")),
        };
        let folds = folds + &self.beyond_backbones();
        match self.search.starts {
            0 => format!("isolas {modes}of {harmonics}{beside} and those to which {leads} were not looked for{folds}"),
            _ => {
                let at_least = match self.search.fewest {
                    0 => ", of which some levels have none".to_string(),
                    fewest => {
                        format!(
                            ": {fewest} a level at least, which miss with probability (1 − p)^{fewest} what one finds with probability p"
                        )
                    }
                };
                let by = match self.search.homotopies {
                    0 => "by random starts alone",
                    _ => "by homotopies and random starts alone",
                };
                format!(
                    "isolas of other periods{beside} were not looked for{folds}. Isolas to which {leads} are met {by}{at_least}"
                )
            }
        }
    }

    /// Which backbones end, at bounds of theirs, before their threshold is beyond the levels: there are no windows beyond.
    fn beyond_backbones(&self) -> String {
        let highest = self.levels.iter().map(|level| level.value).fold(0.0, f64::max);
        let end = |&(mode, last): &(usize, Option<f64>)| {
            let last = last.filter(|last| *last < highest)?;
            let (mode, threshold) = (words::modes(&[mode]), digits(last, 3));
            Some(format!("; the backbone of {mode} ends at A* = {threshold}, and no window beyond was looked for"))
        };
        self.backbones.iter().filter_map(end).collect()
    }
}
