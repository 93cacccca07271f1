//! What was looked for, what was not, and what the structure does of itself.

use super::evidence::{Evidence, Structure};
use crate::curves::BackboneCurve;
use crate::overview::{modes, not_followed};
use crate::words::{self, count, digits};

impl Evidence<'_> {
    /// What vibrates without being forced, or without being damped.
    pub(super) fn self_excitation(&self) -> Option<String> {
        let Structure { excited, undamped, .. } = &self.structure;
        if !excited.is_empty() {
            let has = if excited.len() == 1 { "has" } else { "have" };
            // What the laws take of the smallest motions counts as well, as far as a backbone tells.
            let balance =
                |mode: &usize| self.backbones().find(|backbone| backbone.mode + 1 == *mode)?.balance_from_rest();
            let balances: Vec<Option<f64>> = excited.iter().map(balance).collect();
            let is_driven = balances.iter().any(|balance| balance.is_some_and(|balance| balance < 0.0));
            let is_held = balances.iter().all(|balance| balance.is_some_and(|balance| balance > 0.0));
            let so = match (is_driven, is_held) {
                (true, _) => ": the structure can vibrate by itself, from rest and without forcing",
                (_, true) => ", of which the laws take more at small amplitudes",
                _ => ": unless the laws take more, the structure can vibrate by itself, from rest and without forcing",
            };
            return Some(format!("{} {has} negative linear damping{so}.", capitalised(excited)));
        }
        if let Some(backbone) = self.backbones().find(|backbone| backbone.feeds_itself_from_rest()) {
            return Some(format!(
                "At small amplitudes the nonlinear forces feed more energy into mode {} than its damping takes: the \
                 structure can vibrate by itself, from rest and without forcing.",
                backbone.mode + 1
            ));
        }
        let has = if undamped.len() == 1 { "has" } else { "have" };
        (!undamped.is_empty()).then(|| {
            format!("{} {has} no linear damping: nothing but the laws limits the resonance.", capitalised(undamped))
        })
    }

    /// `mode 1`, or `modes 1 and 2`.
    pub(super) fn mode(&self) -> String {
        let followed: Vec<usize> = self.backbones().map(|backbone| backbone.mode).collect();
        if followed.is_empty() { "a mode".into() } else { words::modes(&followed) }
    }

    /// Where isolas were looked for: `the windows of mode 1 at 7 levels (12 seeds tried, 2 without a branch near them)`.
    pub(super) fn searched(&self) -> String {
        let complete = || self.levels.iter().filter(|level| level.is_complete());
        let levels = complete().count();
        let tried: usize = complete().map(|level| level.seeds.tried).sum();
        let failed: usize = complete().map(|level| level.seeds.failed).sum();
        let harmonic = match self.structure.harmonic {
            0 | 1 => String::new(),
            m => format!(", the forcing acting on harmonic {m}"),
        };
        let nowhere = if failed > 0 { format!(", {failed} without a branch near them") } else { String::new() };
        let complete = if levels == self.levels.len() { "level" } else { "complete level" };
        let (mode, levels) = (self.mode(), count(levels, complete));
        let folds = match self.curves.len() {
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
        let starts = match self.search.starts {
            0 => String::new(),
            number => format!("{} from {}", if folds.is_empty() { " and" } else { "," }, count(number, "random start")),
        };
        let homotopies = match self.search.homotopies {
            0 => String::new(),
            _ => format!("; {}, where nothing else had led to a branch", self.by_homotopies()),
        };
        format!(
            "the windows of {mode} at {levels} ({} tried{nowhere}{harmonic}){starts}{folds}{carried}{homotopies}",
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
    pub(super) fn not_searched(&self) -> String {
        let modes = match self.modes.map(modes::left_out) {
            Some(list) => list.into_iter().map(|modes| format!("of {modes}, ")).collect(),
            None if self.structure.modes > 1 => "of other modes, ".to_string(),
            None => String::new(),
        };
        let harmonics = match self.structure.harmonic > 1 || self.asked.len() > 1 {
            true => "other sub- and super-harmonics",
            false => "sub- and super-harmonics",
        };
        // The orders that are looked for are not among the others.
        let beside = match &self.asked[..] {
            [_, _, ..] => {
                let list: Vec<String> = self.asked.iter().map(ToString::to_string).collect();
                format!(" (than {} of the force)", list.join(", "))
            }
            _ => String::new(),
        };
        let mode = self.mode();
        let led = if self.curves.is_empty() {
            format!("those that no energy balance of {mode} leads to")
        } else {
            format!("those that neither an energy balance of {mode} nor a fold curve leads to")
        };
        let folds = match &self.why_no_folds {
            Some(why) => format!("; folds were not followed ({why})"),
            None => not_followed(self.search.hanging)
                .map_or_else(String::new, |folds| format!("; {folds} were not followed over the forcing")),
        };
        let folds = folds + &self.beyond_backbones();
        match self.search.starts {
            0 => format!("isolas {modes}of {harmonics}{beside} and {led} were not looked for{folds}"),
            starts => {
                let at_least = match self.search.fewest {
                    0 => "at some levels none".to_string(),
                    fewest => format!(
                        "{fewest} a level at least: what one finds with probability p is missed with \
                        probability (1 − p)^{fewest}"
                    ),
                };
                let starts = count(starts, "random start");
                let scouts = match self.search.scouts {
                    0 => String::new(),
                    scouts => format!(", beside others at {}", count(scouts, "larger forcing amplitude")),
                };
                format!(
                    "isolas of other periods{beside} were not looked for, and {led} by {starts} only ({at_least}){scouts}{folds}"
                )
            }
        }
    }

    /// Which backbones end, at bounds of theirs, before their threshold is beyond the levels: there are no windows beyond.
    fn beyond_backbones(&self) -> String {
        let highest = self.levels.iter().map(|level| level.value).fold(0.0, f64::max);
        let end = |backbone: &BackboneCurve| {
            let last = backbone.threshold.values.last().copied().filter(|last| *last < highest)?;
            let (mode, threshold) = (words::modes(&[backbone.mode]), digits(last, 3));
            Some(format!("; the backbone of {mode} ends at A* = {threshold}, and no window beyond was looked for"))
        };
        self.backbones().filter_map(end).collect()
    }

    /// Says so if there are stops and no branch of any level touches one.
    pub(super) fn untouched(&self) -> Option<&'static str> {
        let is_untouched = crate::overview::is_untouched(self.levels);
        (self.structure.stops > 0 && is_untouched).then_some(crate::overview::UNTOUCHED)
    }
}

fn capitalised(list: &[usize]) -> String {
    let numbers: Vec<String> = list.iter().map(ToString::to_string).collect();
    format!("{} {}", if list.len() == 1 { "Mode" } else { "Modes" }, numbers.join(", "))
}
