//! What was looked for and what was not, with the probability of having missed what only random starts can meet: how far the list of
//! branches of a run is complete.

use super::folds::not_followed;
use super::level::Level;
use super::modes;
use crate::store::SearchCounts;
use crate::words::{self, count, digits};
use solver::response::backbone::{BackboneEnd, MOST_CROSSING};
use solver::response::modes::ModesFollowed;
use solver::structure::Model;
use solver::structure::laws::LawKind;

/// What a run, or one order of motions of it, has been searched by.
#[derive(Debug, Clone)]
pub struct LookedFor<'r> {
    /// Levels by forcing amplitude.
    pub levels: &'r [Level],
    /// Modes whose backbones are known, from 0, that of the primary mode first, each with where its backbone ends.
    pub backbones: Vec<(usize, Option<BackboneEnd>)>,
    /// Modes, from 0, whose backbones end where they do since the run began with smaller levels.
    pub short: Vec<usize>,
    /// Modes, from 0, whose backbones are crossed by as many curves as are followed, or more.
    pub crowded: Vec<usize>,
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
    /// Whether there are joints (Jenkins elements), which may stick.
    pub has_joints: bool,
}

/// What helps where levels were added beyond those that a backbone was followed for.
const FARTHER: &str = " (this run began with smaller levels: a sweep of its own with all of them looks farther)";

/// A joint that never slips keeps what force it has, anything up to its limit: a continuum of motions, of which one is followed.
const STUCK: &str = " Where a joint sticks throughout only the motion that keeps no force in it was looked for: with a force kept, \
                     motions about other places last too, and may reach farther.";

/// So many times as many starts as lead to something once, as a rule, miss it with probability exp(−3), 5 %.
const FOR_FIVE_PERCENT: usize = 3;

/// Whether a model has joints (Jenkins elements), which may stick.
pub fn has_joints(model: &Model) -> bool {
    model.elements().iter().any(|element| matches!(element.law, LawKind::Jenkins(_)))
}

impl LookedFor<'_> {
    /// How far the list of branches reaches.
    pub fn sentence(&self) -> String {
        format!("Looked for: {}; {}.{}", self.searched(), self.not_searched(), self.stuck())
    }

    /// The modes whose backbones are known: `mode 1`, or `modes 1 and 2`.
    pub fn mode(&self) -> String {
        let followed: Vec<usize> = self.backbones.iter().map(|(mode, _)| *mode).collect();
        if followed.is_empty() { "a mode".into() } else { words::modes(&followed) }
    }

    /// The same in short: what was done, and that nothing else was; `next` says how to look for motions of other periods.
    pub fn brief(&self, next: Option<String>) -> String {
        let (with, none) = self.windows();
        let windows = none.map_or_else(|| with.clone(), |none| format!("{with} ({none})"));
        let so_far = match self.complete() < self.levels.len() {
            true => format!(", at {}", self.at_levels()),
            false => String::new(),
        };
        let starts = match (self.search.starts, self.search.fewest) {
            (0, _) => None,
            (number, 0) => Some(format!("{} (none at some levels)", count(number, "random start"))),
            (number, _) => Some(count(number, "random start")),
        };
        let homotopies = (self.search.homotopies > 0).then(|| "homotopies".to_string());
        let folds = (self.curves > 0).then(|| count(self.curves, "fold curve"));
        let ways: Vec<String> = std::iter::once(windows).chain(starts).chain(homotopies).chain(folds).collect();
        let alone = if ways.len() == 1 { " alone" } else { "" };
        let folds = self.folds_not_followed();
        let modes: String = self
            .modes
            .into_iter()
            .flat_map(modes::brought_back_by_a_list)
            .map(|modes| format!("; no windows of {modes}"))
            .collect();
        format!(
            "Looked for{so_far}: {}{alone}{modes}{folds}{}; an isola to which none of these leads is not found, nor one of {}{}.{}",
            ways.join(", "),
            self.beyond_backbones(),
            self.other_periods(),
            next.map_or_else(String::new, |next| format!(" ({next})")),
            self.stuck()
        )
    }

    /// Number of levels of which all is known.
    fn complete(&self) -> usize {
        self.levels.iter().filter(|level| level.is_complete()).count()
    }

    /// The levels: `7 levels, 4 of them completely`.
    fn at_levels(&self) -> String {
        match (self.levels.len(), self.complete()) {
            (all, complete) if all == complete => count(all, "level"),
            (1, 0) => "1 level, not completely".into(),
            (all, 0) => format!("{}, none of them completely", count(all, "level")),
            (all, complete) => format!("{}, {complete} of them completely", count(all, "level")),
        }
    }

    /// Which folds were not followed over the forcing.
    fn folds_not_followed(&self) -> String {
        match self.why_no_folds {
            Some(why) => format!("; folds were not followed ({why})"),
            None => not_followed(self.search.hanging)
                .map_or_else(String::new, |folds| format!("; {folds} were not followed over the forcing")),
        }
    }

    fn stuck(&self) -> &'static str {
        if self.has_joints { STUCK } else { "" }
    }

    /// Motions of which orders were not looked for.
    fn other_periods(&self) -> String {
        match self.asked {
            [_, _, ..] => format!("other periods{}", self.beside()),
            _ => "another period".into(),
        }
    }

    /// Whether there was anything to try.
    fn has_seeds(&self) -> bool {
        self.levels.iter().any(|level| level.seeds.tried > 0)
    }

    /// The windows of which modes there are, and which modes with backbones have none at the levels and frequencies.
    fn windows(&self) -> (String, Option<String>) {
        let has_window = |mode: usize| {
            let mut windows = self.levels.iter().flat_map(|level| &level.windows);
            windows.any(|window| window.mode == mode + 1)
        };
        let followed = self.backbones.iter().map(|(mode, _)| *mode);
        let (with, without): (Vec<usize>, Vec<usize>) = followed.partition(|&mode| has_window(mode));
        let windows = |modes: &[usize]| format!("windows of {}", words::modes(modes));
        let there = "at these levels and frequencies";
        match (&with[..], &without[..]) {
            ([], []) => ("windows of a mode".into(), None),
            // Where seeds were tried there are windows, known or not.
            ([], all) => (windows(all), (!self.has_seeds()).then(|| format!("there are none {there}"))),
            (with, []) => (windows(with), None),
            (with, without) => (windows(with), Some(format!("none of {} {there}", words::modes(without)))),
        }
    }

    /// Where isolas were looked for: `the windows of mode 1 at 7 levels (12 seeds tried, 2 without a branch near them)`.
    fn searched(&self) -> String {
        let tried: usize = self.levels.iter().map(|level| level.seeds.tried).sum();
        let failed: usize = self.levels.iter().map(|level| level.seeds.failed).sum();
        let harmonic = match self.harmonic {
            0 | 1 => String::new(),
            m => format!(", the forcing acting on harmonic {m}"),
        };
        let nowhere = if failed > 0 { format!(", {failed} without a branch near them") } else { String::new() };
        let levels = self.at_levels();
        let (windows, none) = self.windows();
        let none = none.map_or_else(String::new, |none| format!("; {none}"));
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
            "the {windows} at {levels} ({} tried{nowhere}{harmonic}{none}){starts}{folds}{crossings}{carried}{homotopies}",
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
        let beside = self.beside();
        let mode = self.mode();
        let leads = if self.curves == 0 {
            format!("no energy balance of {mode} leads")
        } else {
            format!("neither an energy balance of {mode} nor a fold curve leads")
        };
        let folds = self.folds_not_followed() + &self.beyond_backbones();
        match self.search.starts {
            0 => format!("isolas {modes}of {harmonics}{beside} and those to which {leads} were not looked for{folds}"),
            _ => {
                let at_least = match self.search.fewest {
                    0 => ", of which some levels have none".to_string(),
                    fewest => {
                        format!(
                            ": {fewest} a level at least; what one of {} such starts meets is missed with a probability of 5 % at most",
                            (fewest / FOR_FIVE_PERCENT).max(1)
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

    /// The orders that are looked for, which are not among the others.
    fn beside(&self) -> String {
        let list: Vec<String> = self.asked.iter().map(ToString::to_string).collect();
        if list.len() > 1 { format!(" (than {} of the force)", list.join(", ")) } else { String::new() }
    }

    /// Which backbones end, at bounds of theirs or at branch points, before their threshold is beyond the levels: there are no windows
    /// beyond.
    fn beyond_backbones(&self) -> String {
        let highest = self.levels.iter().map(|level| level.value).fold(0.0, f64::max);
        let end = |&(mode, end): &(usize, Option<BackboneEnd>)| {
            let end = end.filter(|end| end.threshold < highest)?;
            let (name, threshold) = (words::modes(&[mode]), digits(end.threshold, 3));
            let place = match end.branch_point {
                Some(omega) => format!("at a branch point near {}, beyond A* = {threshold}", words::frequency(omega)),
                None => format!("at A* = {threshold}"),
            };
            Some((mode, format!("; the backbone of {name} ends {place}, and no window beyond was looked for")))
        };
        let mut ends: Vec<(usize, String)> = self.backbones.iter().filter_map(end).collect();
        // Said once, of the last of which it is so.
        if let Some((_, last)) = ends.iter_mut().rfind(|(mode, _)| self.short.contains(mode)) {
            last.push_str(FARTHER);
        }
        ends.into_iter().map(|(_, told)| told).chain(self.across()).collect()
    }

    /// Whose backbones may be crossed by more curves than were followed.
    fn across(&self) -> Option<String> {
        let (backbones, each) = match self.crowded.len() {
            0 => return None,
            1 => ("backbone", ""),
            _ => ("backbones", " each"),
        };
        let modes = words::modes(&self.crowded);
        Some(format!(
            "; of the curves that cross the {backbones} of {modes}, {MOST_CROSSING}{each} were followed, and there may be more"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{WindowOutcome, WindowRow};
    use solver::response::modes::LeftOut;

    fn level(modes: &[usize]) -> Level {
        let window = |&mode: &usize| WindowRow { mode, ..WindowRow::of(WindowOutcome::Found("main".into())) };
        Level { windows: modes.iter().map(window).collect(), is_without_mains: true, value: 3.0, ..Level::default() }
    }

    fn looked_for<'r>(levels: &'r [Level], asked: &'r [usize]) -> LookedFor<'r> {
        LookedFor {
            levels,
            backbones: vec![(0, None), (1, None)],
            short: Vec::new(),
            crowded: Vec::new(),
            modes: None,
            all_modes: 2,
            harmonic: 1,
            asked,
            curves: 0,
            search: SearchCounts::default(),
            why_no_folds: None,
            has_joints: false,
        }
    }

    /// What a joint that sticks may keep is no motion that was followed.
    #[test]
    fn joints_that_stick() {
        let levels = [level(&[1])];
        let told = |has_joints| {
            let told = LookedFor { has_joints, ..looked_for(&levels, &[1]) };
            [told.brief(None), told.sentence()]
        };
        assert!(told(true).iter().all(|said| said.ends_with("and may reach farther.")));
        assert!(told(false).iter().all(|said| !said.contains("joint")));
    }

    #[test]
    fn modes_without_windows_are_not_said_to_have_some() {
        for (modes, brief, whole) in [
            (
                &[1, 2][..],
                "windows of modes 1 and 2 alone; an",
                "the windows of modes 1 and 2 at 1 level (0 seeds tried);",
            ),
            (
                &[1],
                "windows of mode 1 (none of mode 2 at these levels and frequencies) alone; an",
                "the windows of mode 1 at 1 level (0 seeds tried; none of mode 2 at these levels and frequencies);",
            ),
            (
                &[],
                "windows of modes 1 and 2 (there are none at these levels and frequencies) alone; an",
                "the windows of modes 1 and 2 at 1 level (0 seeds tried; there are none at these levels and frequencies);",
            ),
        ] {
            let levels = [level(modes)];
            let told = looked_for(&levels, &[1]);
            assert!(told.brief(None).starts_with(&format!("Looked for: {brief}")), "{}", told.brief(None));
            assert!(told.sentence().starts_with(&format!("Looked for: {whole}")), "{}", told.sentence());
        }
    }

    #[test]
    fn in_short_what_was_done_and_what_was_not() {
        let levels = [level(&[1, 2])];
        let mut told = looked_for(&levels, &[1]);
        (told.curves, told.search.starts, told.search.fewest, told.search.homotopies) = (3, 64, 16, 8);
        assert_eq!(
            told.brief(Some("search.harmonics does".into())),
            "Looked for: windows of modes 1 and 2, 64 random starts, homotopies, 3 fold curves; an isola to which none of these leads is not \
             found, nor one of another period (search.harmonics does)."
        );
        told.search.fewest = 0;
        told.why_no_folds = Some("a law has a corner");
        let at_bound = BackboneEnd { threshold: 2.5, branch_point: None };
        told.backbones = [(0, at_bound), (1, BackboneEnd { branch_point: Some(60.0), ..at_bound })]
            .map(|(mode, end)| (mode, Some(end)))
            .to_vec();
        (told.crowded, told.short) = (vec![1], vec![0]);
        let choice =
            ModesFollowed { followed: vec![0, 1], left_out: vec![(2, LeftOut::TooMany), (3, LeftOut::OutOfRange)] };
        told.modes = Some(&choice);
        let said = told.brief(None);
        for part in [
            "64 random starts (none at some levels)",
            "; no windows of mode 4 (far above the primary mode or beyond the reach of given bounds, and followed only if backbone.modes lists it)",
            "; no windows of mode 3 (more than are followed",
            "; folds were not followed (a law has a corner)",
            "; the backbone of mode 1 ends at A* = 2.5, and no window beyond was looked for (this run began with smaller levels: a sweep of its own with all \
             of them looks farther); the backbone of mode 2 ends at a branch point near 60 rad/s (9.549 Hz), beyond A* = 2.5, and no window \
             beyond was looked for; of the curves that cross the backbone of mode 2, 8 were followed, and there may be more;",
        ] {
            assert!(said.contains(part), "{said}");
        }
        // Folds that are never followed, and levels that are still to come.
        let mut levels = levels.clone();
        levels[0].pending = 1;
        let mut told = looked_for(&levels, &[1]);
        told.search.hanging = 2;
        let said = told.brief(None);
        assert!(said.starts_with("Looked for, at 1 level, not completely: windows of "), "{said}");
        assert!(
            said.contains("; folds of 2 branches that branch off others were not followed over the forcing;"),
            "{said}"
        );
        let several = looked_for(&levels, &[1, 3]).brief(None);
        assert!(several.ends_with("nor one of other periods (than 1, 3 of the force)."), "{several}");
    }
}
