//! What was not found: isolas, and what the energy balance predicts, as an estimate.

use super::evidence::Evidence;
use crate::curves::BackboneCurve;
use crate::overview::windows::is_on_main;
use crate::overview::{
    Bounds, Level, Origin, beyond, born_above, born_below, born_between, forcing_label, is_within, later_birth, named,
    overlaps, overlooked, parted_between, told_threshold, truncation_doubt, undecided,
};
use crate::store::{CurvePoint, WindowOutcome, WindowRow};
use crate::words::{self, count};
use solver::response::task::SeedOutcome;
use solver::response::windows::{Event, EventKind};

/// Where isolas were looked for, if in windows alone.
pub(super) const WINDOWS_ALONE: &str = "in windows of the energy balance, where alone they were looked for";

/// What is said of an order of motions of which nothing was found.
pub(super) const NOTHING: &str = "No such motion was found where it was looked for";

/// Predicted events of a kind that a sentence names.
const NAMED: usize = 6;

/// The birth at the smallest forcing.
fn earliest_of<'e>(births: &[(&'e BackboneCurve, &'e Event)]) -> Option<(&'e BackboneCurve, &'e Event)> {
    births.iter().copied().min_by(|(_, a), (_, b)| a.threshold.total_cmp(&b.threshold))
}

/// Thresholds from where the piece of a birth begins up to it.
fn before<'b>((backbone, birth): &(&'b BackboneCurve, &Event)) -> &'b [f64] {
    let piece = backbone.pieces.iter().find(|piece| piece.points.contains(&birth.index));
    &backbone.threshold.values[piece.map_or(0, |piece| piece.points.start)..birth.index]
}

/// The forcing from which on a window is one with what its piece of the backbone begins with.
fn barrier(birth: &(&BackboneCurve, &Event)) -> f64 {
    before(birth).iter().copied().fold(0.0, f64::max)
}

/// Where it becomes one with that, if not with where the backbone itself begins.
fn merge_after(birth: &(&BackboneCurve, &Event)) -> Option<f64> {
    let merge = barrier(birth);
    before(birth).first().is_some_and(|first| *first < merge).then_some(merge)
}

impl Evidence<'_> {
    /// That there is no isola at the levels, and what fold curves have of isolas nevertheless: at the levels, else between, below or above
    /// them.
    pub(super) fn no_isola(&self) -> String {
        let (levels, curves, bounds) = (self.levels, self.curves, self.bounds);
        let place = if self.is_of_windows_alone() { WINDOWS_ALONE } else { "where it was looked for" };
        let none = match self.has_nothing() {
            true => NOTHING.to_string(),
            false => format!("{} {place}{}", self.none(), undecided(levels)),
        };
        if let Some(there) = self.overlooked() {
            return format!("{none}, though along fold curves {there}.");
        }
        let at = |birth: &CurvePoint| {
            let forcing = forcing_label(birth, 5);
            format!("at A = {forcing} ({}{})", self.in_both_units(birth.omega), truncation_doubt(&[birth]))
        };
        let may = if undecided(levels).is_empty() { "" } else { ": what is cut or unfinished above may be it" };
        let but = |what: String| format!("{none}, but along fold curves {what}{may}.");
        match &born_between(levels, curves, bounds)[..] {
            [only] => return but(format!("one is born between two of the levels, {}", at(only))),
            [first, .., last] => {
                return but(format!("isolas are born between levels, the first {}, the last {}", at(first), at(last)));
            }
            [] => {}
        }
        let below = match &born_below(levels, curves, bounds)[..] {
            [] => None,
            [only] => Some(format!("one is born below the lowest level, {}", at(only))),
            [first, .., last] => {
                Some(format!("isolas are born below the lowest level, the first {}, the last {}", at(first), at(last)))
            }
        };
        let above = born_above(levels, curves, bounds)
            .map(|birth| format!("one is born above the highest level, {}", at(birth)));
        let beyond: Vec<String> = below.into_iter().chain(above).collect();
        if !beyond.is_empty() {
            return but(beyond.join(", and "));
        }
        match parted_between(curves, levels).first() {
            Some(life) => {
                let (from, to) = (forcing_label(life.from, 5), forcing_label(life.to, 5));
                let doubt = truncation_doubt(&[life.from, life.to]);
                but(format!("one is there from A = {from} to {to}, where the run has no level{doubt}"))
            }
            None => format!("{none}."),
        }
    }

    /// An isola that fold curves have at levels at which none was found.
    pub(super) fn overlooked(&self) -> Option<String> {
        let bounds = Bounds { frequency: self.bounds, amplitude: self.max_amplitude };
        overlooked(self.curves, self.levels, bounds, |omega| self.frequency(omega), |size| self.length(size))
    }

    /// Births of the energy balance that are met within the bounds.
    fn births(&self) -> impl Iterator<Item = (&BackboneCurve, &Event)> {
        let births = self.backbones().flat_map(|backbone| backbone.events.iter().map(move |event| (backbone, event)));
        // What is predicted beyond the frequencies of the study counts where its windows reach into them.
        let is_met = |(backbone, birth): &(&BackboneCurve, &Event)| {
            let windows = self.levels.iter().flat_map(|level| &level.windows);
            let mut own = windows.filter(|window| window.mode == backbone.mode + 1);
            is_within(self.bounds, birth.omega)
                || own.any(|window| (window.points[0]..=window.points[1]).contains(&birth.index))
        };
        births.filter(|(_, event)| event.kind == EventKind::Birth).filter(is_met)
    }

    /// How many separate responses the energy balance has beyond all levels, and where the first: `one from A = 2 to 5, near 3 rad/s`.
    pub(super) fn predicted_above(&self) -> Option<String> {
        let values = || self.levels.iter().map(|level| level.value);
        let highest = values().fold(0.0, f64::max);
        let above: Vec<_> =
            self.births().filter(|birth| (highest..barrier(birth)).contains(&birth.1.threshold)).collect();
        let earliest = earliest_of(&above)?;
        let birth = earliest.1;
        let told = |forcing: f64| format!("to {}", told_threshold(forcing, values()));
        let to = merge_after(&earliest).map_or_else(|| "on".into(), told);
        let (from, near) = (told_threshold(birth.threshold, values()), self.frequency(birth.omega));
        let which =
            if above.len() == 1 { "one".into() } else { format!("{} at larger forcing, the first", above.len()) };
        Some(format!("{which} from A = {from} {to}, near {near}{}", beyond(self.bounds, birth.omega)))
    }

    /// From where on the energy balance alone says that there is more than the main response. A window that is born and
    /// merges between two levels is no news.
    pub(super) fn prediction(&self) -> String {
        if self.backbone.is_none() {
            return String::new();
        }
        let mode = self.looked_for().mode();
        let births = self.births();
        let is_separate = |birth: &(&BackboneCurve, &Event)| {
            let apart = birth.1.threshold..barrier(birth);
            self.levels.iter().any(|level| apart.contains(&level.value))
        };
        let (separate, others): (Vec<_>, Vec<_>) = births.partition(is_separate);
        // What turned out to be the main branch is not told while there is more.
        let (on_main, apart): (Vec<_>, Vec<_>) = separate.into_iter().partition(|birth| self.has_led_to_main(birth));
        let (separate, so) =
            if apart.is_empty() { (on_main, ", though seeds there led to main branches") } else { (apart, "") };
        let told = |threshold: f64| told_threshold(threshold, self.levels.iter().map(|level| level.value));
        let Some((_, birth)) = earliest_of(&separate) else {
            let highest = self.levels.iter().map(|level| level.value).fold(0.0, f64::max);
            let earliest = others.iter().filter(|other| (other.1.threshold..highest).contains(&barrier(other)));
            let earliest = earliest.min_by(|(_, a), (_, b)| a.threshold.total_cmp(&b.threshold));
            return if let Some(missed) = earliest.filter(|_| self.with_isolas().next().is_some()) {
                let (from, to) = (told(missed.1.threshold), told(barrier(missed)));
                let mode = words::modes(&[missed.0.mode]);
                format!(
                    "; the energy balance of {mode} predicts separate responses from A = {from} to {to} alone, where the run has no level"
                )
            } else if self.backbones().filter_map(|backbone| backbone.unforced).any(|motion| motion.is_fed_at_rest) {
                // They are there at any forcing.
                String::new()
            } else if self.with_isolas().next().is_some() {
                let whose = if self.is_one_isola() { "of it" } else { "of theirs" };
                format!("; the energy balance of {mode} has no birth {whose}{}", self.found_otherwise())
            } else if self.levels.iter().any(|level| level.not_found().chain(level.passed()).next().is_some()) {
                // What it predicts and was not found is among the details.
                String::new()
            } else {
                let above = self.predicted_above().map_or_else(String::new, |above| format!(", but {above}"));
                let highest = self.levels.iter().map(|level| level.value).fold(0.0, f64::max);
                let is_short = |backbone: &BackboneCurve| backbone.end.is_some_and(|end| end.threshold < highest);
                let far = if self.backbones().any(is_short) { ", as far as it is known," } else { "" };
                format!(
                    "; the energy balance of {mode}{far} predicts no separate response at the levels and frequencies of the run{above}"
                )
            };
        };
        let highest = self.levels.iter().map(|level| level.value).fold(0.0, f64::max);
        // Each mode has its own.
        let of_mode = |backbone: &BackboneCurve| {
            let own: Vec<_> = separate.iter().copied().filter(|(other, _)| other.mode == backbone.mode).collect();
            let (_, birth) = earliest_of(&own)?;
            let omega = backbone.omega.values[birth.index];
            let near = format!("{}{}", self.frequency(omega), beyond(self.bounds, omega));
            let to = own.iter().map(barrier).fold(0.0, f64::max);
            let to = if to < highest { format!("to {}", told(to)) } else { "on".into() };
            let range = match backbone.feeds_itself(birth.index) {
                true => format!(
                    "at any forcing, near {near}, where the nonlinear forces feed in as much energy as the damping takes"
                ),
                false => format!("from A = {} {to}, near {near}", told(birth.threshold)),
            };
            Some((birth.threshold, words::modes(&[backbone.mode]), range))
        };
        let mut by_mode: Vec<(f64, String, String)> = self.backbones().filter_map(of_mode).collect();
        by_mode.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all = by_mode.iter().enumerate().map(|(i, (_, mode, range))| match i {
            0 => format!("; the energy balance of {mode} predicts separate responses {range}"),
            _ => format!("; that of {mode} {range}"),
        });
        let all: String = all.collect();
        // Windows that are born and merge between levels, or below them, are seen at none.
        let earlier = others.into_iter().filter(|other| other.1.threshold < birth.threshold.min(barrier(other)));
        let earliest = earlier.min_by(|(_, a), (_, b)| a.threshold.total_cmp(&b.threshold));
        let earlier = earliest.map_or_else(String::new, |earliest| {
            let (from, to) = (told(earliest.1.threshold), told(barrier(&earliest)));
            let mode = words::modes(&[earliest.0.mode]);
            let whose = match &by_mode[..] {
                [(_, only, _)] if *only == mode => " and".to_string(),
                _ => format!("; that of {mode}"),
            };
            format!("{whose} already from A = {from} to {to}, where the run has no level")
        });
        // Of what lies where there is no level no seed has told.
        let so = if earlier.is_empty() { so } else { "" };
        format!("{all}{earlier}{so}")
    }

    /// Whether the windows that begin with a birth led to main branches alone, at every level that has them.
    fn has_led_to_main(&self, birth: &(&BackboneCurve, &Event)) -> bool {
        let (backbone, event) = birth;
        let has_birth = |window: &&WindowRow| {
            window.mode == backbone.mode + 1 && (window.points[0]..=window.points[1]).contains(&event.index)
        };
        let apart = event.threshold..barrier(birth);
        let mut levels = self.levels.iter().filter(|level| apart.contains(&level.value)).peekable();
        levels.peek().is_some()
            && levels.all(|level| {
                let window = level.windows.iter().find(has_birth);
                window.is_some_and(|window| {
                    let is_found = matches!(window.outcome, WindowOutcome::Found(_));
                    is_found && is_on_main(window, &level.branches) == Some(true)
                })
            })
    }

    /// Births and merges of the energy balance among the levels, which is an estimate of what fold curves compute.
    pub(super) fn predicted_events(&self) -> Option<String> {
        let values = || self.levels.iter().map(|level| level.value);
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        let all = self.backbones().flat_map(|backbone| backbone.events.iter());
        let mut among: Vec<&Event> = all
            .filter(|event| (low..=high).contains(&event.threshold) && is_within(self.bounds, event.omega))
            .collect();
        among.sort_by(|a, b| a.threshold.total_cmp(&b.threshold));
        let of = |kind: EventKind, one: &str, many: &str| {
            let list: Vec<&&Event> = among.iter().filter(|event| event.kind == kind).collect();
            let place = |event: &&&Event| {
                format!("{} (near {})", told_threshold(event.threshold, values()), self.in_both_units(event.omega))
            };
            let named: Vec<String> = list.iter().take(NAMED).map(place).collect();
            let more = if list.len() > NAMED { format!(" and {} more", list.len() - NAMED) } else { String::new() };
            let what = if list.len() == 1 { one } else { many };
            (!list.is_empty()).then(|| format!("{what} at A = {}{more}", named.join(", ")))
        };
        let births = of(EventKind::Birth, "a birth", "births");
        let merges = of(EventKind::Merge, "a merge", "merges");
        let parts: Vec<String> = births.into_iter().chain(merges).collect();
        (!parts.is_empty())
            .then(|| format!("Among the levels the energy balance predicts, as an estimate, {}.", parts.join(" and ")))
    }

    /// What led to isolas beside the energy balance.
    fn found_otherwise(&self) -> String {
        let isolas = self.levels.iter().flat_map(Level::isolas);
        let mut origins: Vec<Origin> = isolas.filter_map(|isola| isola.found_by).collect();
        origins.sort_unstable();
        origins.dedup();
        let way = |origin: &Origin| match origin {
            Origin::Curve => "along curves over the forcing",
            Origin::Start => "from random starts",
            Origin::Continuation => "where a growing forcing leads from rest",
            Origin::Balance => "from seeds of its windows",
        };
        let ways: Vec<&str> = origins.iter().map(way).collect();
        let they_were = if self.is_one_isola() { "it was" } else { "they were" };
        if ways.is_empty() { String::new() } else { format!(": {they_were} found {}", ways.join(" and ")) }
    }

    /// Windows that led to no branch: those where fold curves have an isola born at a larger forcing, birth by birth, those in whose
    /// range something was found otherwise, and the others.
    pub(super) fn not_found(&self) -> Vec<String> {
        let mut births: Vec<(&CurvePoint, Vec<&Level>)> = Vec::new();
        let [mut met, mut others, mut outside] = [const { Vec::<&Level>::new() }; 3];
        let out = SeedOutcome::OutOfBounds.to_string();
        for level in self.levels {
            for (window, why) in level.not_found() {
                if why == out {
                    outside.push(level);
                    continue;
                }
                match later_birth(self.curves, level, window) {
                    Some(birth) => match births.iter_mut().find(|(other, _)| std::ptr::eq(*other, birth)) {
                        Some((_, levels)) => levels.push(level),
                        None => births.push((birth, vec![level])),
                    },
                    None if level.others().any(|row| overlaps(row, window)) => met.push(level),
                    None => others.push(level),
                }
            }
        }
        let early = births.into_iter().map(|(birth, levels)| {
            let (forcing, doubt) = (forcing_label(birth, 5), truncation_doubt(&[birth]));
            format!(
                "At {} the energy balance predicts a response in a range of frequencies in which, along fold curves, an isola \
                 is born at A = {forcing} only{doubt}: none was found there.",
                named(&once(levels))
            )
        });
        let mut sentences: Vec<String> = early.collect();
        for (levels, more) in [(met, ", though branches found otherwise lie in its range of frequencies"), (others, "")]
        {
            if levels.is_empty() {
                continue;
            }
            let responses = count(levels.len(), "response");
            let (whose, more) = if levels.len() == 1 {
                ("its", more.to_string())
            } else {
                ("their", more.replace("its range", "their ranges"))
            };
            sentences.push(format!(
                "{responses} that the energy balance predicts, which is an estimate, not found at {}: none of {whose} seeds led to a \
                 branch near{more}.",
                named(&once(levels))
            ));
        }
        if !outside.is_empty() {
            let (responses, levels) = (count(outside.len(), "response"), named(&once(outside)));
            let [lie, were] = if responses.starts_with("1 ") { ["leads", "was"] } else { ["lead", "were"] };
            sentences.push(format!(
                "{responses} that the energy balance predicts, which is an estimate, {lie} out of the bounds of frequency or amplitude, at \
                 {levels}, and {were} not followed."
            ));
        }
        sentences.extend(self.passed());
        sentences
    }

    /// Windows near which no seed landed, but by which known branches pass.
    fn passed(&self) -> Option<String> {
        let levels: Vec<&Level> = self.levels.iter().flat_map(|level| level.passed().map(move |_| level)).collect();
        let (responses, them) = (count(levels.len(), "response"), if levels.len() == 1 { "it" } else { "them" });
        (!levels.is_empty()).then(|| {
            format!(
                "No seed landed near {responses} that the energy balance predicts, which is an estimate, at {}, but known branches pass \
                 by: what is predicted may be on these, and isolas near {them} are not excluded.",
                named(&once(levels.clone()))
            )
        })
    }
}

/// Levels by forcing, each once.
fn once(mut levels: Vec<&Level>) -> Vec<&Level> {
    levels.dedup_by(|a, b| a.amplitude == b.amplitude);
    levels
}
