//! Three sentences that the store supports: where it is dangerous, from which forcing on, and what ordinary continuation
//! would have missed.

use crate::curves::BackboneCurve;
use crate::overview::{BranchRow, Level, highest};
use crate::words::{count, digits, frequency, length, range};
use serde::Serialize;
use solver::response::branch::BranchKind;
use solver::response::windows::{Event, EventKind};

/// One of the sentences.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Sentence {
    /// The question it answers.
    pub title: &'static str,
    /// The answer.
    pub text: String,
}

/// What the sentences are about.
pub struct Evidence<'r> {
    /// Levels by forcing amplitude.
    pub levels: &'r [Level],
    /// The backbone, if it is known.
    pub backbone: Option<&'r BackboneCurve>,
    /// The dof whose amplitudes are given.
    pub monitor: &'r str,
    /// Its clearance to the casing, m.
    pub gap: Option<f64>,
}

/// The three sentences.
pub fn verdict(evidence: &Evidence<'_>) -> [Sentence; 3] {
    [
        Sentence { title: "Where is it dangerous?", text: evidence.danger() },
        Sentence { title: "From which forcing on?", text: evidence.onset() },
        Sentence { title: "Would ordinary continuation have missed it?", text: evidence.missed() },
    ]
}

/// A level with its highest isola and its main branch.
struct Gain<'r> {
    level: &'r Level,
    isola: &'r BranchRow,
    main: &'r BranchRow,
}

impl Gain<'_> {
    fn ratio(&self) -> f64 {
        self.isola.amplitude_max / self.main.amplitude_max
    }
}

impl<'r> Evidence<'r> {
    fn with_isolas(&self) -> impl DoubleEndedIterator<Item = &'r Level> + Clone {
        self.levels.iter().filter(|level| level.highest_isola().is_some())
    }

    fn is_empty(&self) -> bool {
        self.levels.iter().all(|level| level.peak().is_none())
    }

    /// The highest point over all branches of all levels.
    fn largest(&self) -> Option<(&'r Level, &'r BranchRow)> {
        let peaks = self.levels.iter().filter_map(|level| Some((level, level.peak()?)));
        peaks.max_by(|a, b| a.1.amplitude_max.total_cmp(&b.1.amplitude_max))
    }

    fn danger(&self) -> String {
        let Some((level, largest)) = self.largest() else { return "No branch has been computed yet.".into() };
        let casing = self.gap.map(|gap| format!(" ({} to the casing)", length(gap))).unwrap_or_default();
        let size = |row: &BranchRow| format!("{}{} at {}", row.at_least(), length(row.amplitude_max), self.monitor);
        let on = |row: &BranchRow| if row.is_main() { "the main branch".to_string() } else { row.name() };
        let place = format!("at {} and A = {}", frequency(largest.omega_at_max), level.amplitude);
        let overall = format!("the largest response of all, {}{casing}, is on {}, {place}", size(largest), on(largest));
        let Some(highest) = highest(self.with_isolas().flat_map(Level::isolas)) else {
            return format!("No isola was found{}; {overall}.", self.reservation());
        };
        let ranges = joined(self.with_isolas().flat_map(Level::isolas).map(|isola| isola.omega));
        let there = format!(
            "Between {}: there an impact or a gust can throw the structure onto an isolated branch (isola)",
            in_words(&ranges)
        );
        if !largest.is_detached() {
            format!("{there} with up to {}; {overall}.", size(highest))
        } else {
            format!("{there} with up to {}{casing}, the largest response of all, {place}.", size(largest))
        }
    }

    fn onset(&self) -> String {
        if self.is_empty() {
            return format!("Nothing is known yet: {} to come.", count(self.levels.len(), "forcing level"));
        }
        let all = match self.levels {
            [only] => format!("the one level, A = {}", only.amplitude),
            [first, .., last] => {
                format!("the {} levels, A = {} to {}", self.levels.len(), first.amplitude, last.amplitude)
            }
            [] => "no level".into(),
        };
        let found: Vec<String> = runs(self.levels)
            .iter()
            .map(|(first, last)| if first == last { first.clone() } else { format!("{first} to {last}") })
            .collect();
        let (reservation, prediction) = (self.reservation(), self.prediction());
        if found.is_empty() {
            return format!("There is no isola among {all}{reservation}{prediction}.");
        }
        let highest = self.with_isolas().next_back().map_or(f64::INFINITY, |level| level.value);
        let above = self.levels.iter().find(|level| level.value > highest);
        let end = above.filter(|level| level.is_settled()).and_then(|level| Some((level, level.main()?)));
        let end = end.map(|(level, main)| {
            format!(
                " At A = {} none is left: the main branch itself goes up to {}{} at {} there.",
                level.amplitude,
                main.at_least(),
                length(main.amplitude_max),
                frequency(main.omega_at_max)
            )
        });
        let list = found.join(", ");
        format!("Isolas were found at A = {list}, of {all}{reservation}{prediction}.{}", end.unwrap_or_default())
    }

    /// From where on the energy balance alone says that there is more than the main response. A window that is born and
    /// merges between two levels is no news.
    fn prediction(&self) -> String {
        let Some(backbone) = self.backbone else { return String::new() };
        let (threshold, omega) = (&backbone.threshold.values, &backbone.omega.values);
        let births = backbone.events.iter().filter(|event| event.kind == EventKind::Birth);
        let is_separate = |birth: &&Event| {
            let barrier = threshold[..birth.index].iter().copied().fold(0.0, f64::max);
            self.levels.iter().any(|level| (birth.threshold..barrier).contains(&level.value))
        };
        let Some(birth) = births.filter(is_separate).min_by(|a, b| a.threshold.total_cmp(&b.threshold)) else {
            return "; the energy balance predicts no separate response at any of them".into();
        };
        let near = frequency(omega[birth.index]);
        if backbone.feeds_itself(birth.index) {
            return format!(
                "; the energy balance predicts separate responses at any forcing, near {near}, where the nonlinear forces \
                 feed in as much energy as the damping takes"
            );
        }
        let threshold = digits(birth.threshold, 3);
        format!("; the energy balance predicts separate responses from A = {threshold} on, near {near}")
    }

    fn missed(&self) -> String {
        if self.is_empty() {
            return "Nothing is known yet.".into();
        }
        let gains = self.with_isolas().filter_map(|level| {
            let main = level.main().filter(|main| main.amplitude_max > 0.0)?;
            Some(Gain { level, isola: level.highest_isola()?, main })
        });
        let Some(gain) = gains.max_by(|a, b| a.ratio().total_cmp(&b.ratio())) else {
            if self.with_isolas().next().is_some() {
                return "Ordinary continuation has no main branch to compare the isolas with: see the account.".into();
            }
            let reservation = self.reservation();
            let no = if reservation.is_empty() { "No" } else { "Not so far" };
            return format!("{no}: nothing was found beside the main branch{reservation}.");
        };
        let Gain { level, isola, main } = &gain;
        let (stops, goes) = (
            format!("{}{} at {}", main.at_least(), length(main.amplitude_max), frequency(main.omega_at_max)),
            format!("{}{} at {}", isola.at_least(), length(isola.amplitude_max), frequency(isola.omega_at_max)),
        );
        let amplitude = &level.amplitude;
        match gain.ratio() {
            ratio if ratio >= 2.0 => format!(
                "Yes. At A = {amplitude} it stops at {stops}, but an isola goes up to {goes}, {} times as much.",
                digits(ratio, 2)
            ),
            ratio if ratio >= 1.0 => format!(
                "Yes. At A = {amplitude} it stops at {stops}, but an isola goes up to {goes}, {:.0} % more.",
                (ratio - 1.0) * 100.0
            ),
            ratio => format!(
                "Yes, though the main branch goes higher: at A = {amplitude} up to {stops}, an isola up to {goes}, {:.0} % \
                 less.",
                (1.0 - ratio) * 100.0
            ),
        }
    }

    /// What may be missing from a sentence.
    fn reservation(&self) -> String {
        let pending: usize = self.levels.iter().map(|level| level.pending).sum();
        let dead: usize = self.levels.iter().map(|level| level.dead).sum();
        let not_found: usize = self.levels.iter().map(|level| level.not_found().count()).sum();
        let of_kind =
            |kind: BranchKind| self.levels.iter().flat_map(Level::others).filter(move |b| b.kind == kind.name());
        let mut parts = Vec::new();
        for (kind, what) in [(BranchKind::Cut, "cut off by a bound"), (BranchKind::Unfinished, "unfinished")] {
            let branches = of_kind(kind).count();
            if branches > 0 {
                parts.push(format!(
                    "{} {what}, perhaps part of the main branch",
                    if branches == 1 { "1 branch".into() } else { format!("{branches} branches") }
                ));
            }
        }
        if pending > 0 {
            parts.push(format!("{} still to come", count(pending, "task")));
        }
        if dead > 0 {
            parts.push(format!("{} given up", count(dead, "task")));
        }
        if not_found > 0 {
            parts.push(format!("{} predicted but not found", count(not_found, "response")));
        }
        if parts.is_empty() { String::new() } else { format!(" ({})", parts.join(", ")) }
    }
}

/// Levels with isolas as runs of neighbours: first and last, as typed.
fn runs(levels: &[Level]) -> Vec<(String, String)> {
    let runs = levels.chunk_by(|a, b| a.highest_isola().is_some() == b.highest_isola().is_some());
    let with_isolas = runs.filter(|run| run[0].highest_isola().is_some());
    with_isolas.map(|run| (run[0].amplitude.clone(), run[run.len() - 1].amplitude.clone())).collect()
}

/// Ranges in order, those that overlap as one.
fn joined(ranges: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut sorted: Vec<(f64, f64)> = ranges.filter(|(low, high)| low.is_finite() && high.is_finite()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut list: Vec<(f64, f64)> = Vec::new();
    for (low, high) in sorted {
        match list.last_mut() {
            Some(last) if low <= last.1 => last.1 = last.1.max(high),
            _ => list.push((low, high)),
        }
    }
    list
}

/// Ranges that a sentence names; the others are only counted.
const NAMED: usize = 3;

fn in_words(ranges: &[(f64, f64)]) -> String {
    let mut list: Vec<String> = ranges.iter().take(NAMED).map(|&omega| range(omega)).collect();
    if ranges.len() > NAMED {
        list.push(format!("in {} more ranges", ranges.len() - NAMED));
    }
    list.join(", or between ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::response::branch::Standing;

    fn branch(kind: &str, number: usize, omega: (f64, f64), amplitude: f64) -> BranchRow {
        BranchRow {
            kind: kind.into(),
            number,
            closed: kind == "isola",
            points: 3,
            omega,
            amplitude_max: amplitude,
            omega_at_max: omega.1,
            ..BranchRow::default()
        }
    }

    fn level(value: f64, branches: Vec<BranchRow>) -> Level {
        let (windows, main_failure) = (Vec::new(), None);
        Level { amplitude: value.to_string(), value, branches, windows, main_failure, pending: 0, dead: 0 }
    }

    fn texts(levels: &[Level]) -> [String; 3] {
        let evidence = Evidence { levels, backbone: None, monitor: "tip", gap: Some(4e-4) };
        verdict(&evidence).map(|sentence| sentence.text)
    }

    fn main(amplitude: f64) -> BranchRow {
        branch("main", 1, (90.0, 100.0), amplitude)
    }

    #[test]
    fn isolas_apart() {
        let isolas = [branch("isola", 1, (120.0, 130.0), 2e-3), branch("isola", 2, (150.0, 160.0), 1.5e-3)];
        let levels = [
            level(1.0, vec![main(1e-3)]),
            level(2.0, vec![main(1e-3), isolas[0].clone(), isolas[1].clone()]),
            level(3.0, vec![main(1e-3), branch("isola", 1, (125.0, 140.0), 1e-3)]),
            level(4.0, vec![main(2.5e-3)]),
            level(5.0, vec![main(1e-3), branch("isola", 1, (155.0, 165.0), 1.2e-3)]),
        ];
        let [danger, onset, missed] = texts(&levels);
        assert_eq!(
            danger,
            "Between 120 and 140 rad/s (19.1 and 22.28 Hz), or between 150 and 165 rad/s (23.87 and 26.26 Hz): there an \
             impact or a gust can throw the structure onto an isolated branch (isola) with up to 2 mm at tip; the largest \
             response of all, 2.5 mm at tip (0.4 mm to the casing), is on the main branch, at 100 rad/s (15.92 Hz) and \
             A = 4."
        );
        assert_eq!(onset, "Isolas were found at A = 2 to 3, 5, of the 5 levels, A = 1 to 5.");
        assert!(missed.starts_with("Yes. At A = 2 it stops at 1 mm at 100 rad/s"), "{missed}");
        assert!(missed.ends_with("up to 2 mm at 130 rad/s (20.69 Hz), 2 times as much."), "{missed}");
    }

    #[test]
    fn what_merged_and_what_is_not_known_yet() {
        let isola = branch("isola", 1, (120.0, 130.0), 0.9e-3);
        let mut levels = [level(1.0, vec![main(1e-3), isola]), level(2.0, vec![main(3e-3)])];
        let [_, onset, missed] = texts(&levels);
        assert!(
            onset.ends_with(
                "At A = 2 none is left: the main branch itself goes up to 3 mm at 100 rad/s (15.92 Hz) there."
            )
        );
        assert!(missed.starts_with("Yes, though the main branch goes higher: at A = 1 up to 1 mm"), "{missed}");
        assert!(missed.ends_with("10 % less."), "{missed}");
        // As long as seeds of the level are left, nobody knows.
        levels[1].pending = 3;
        assert_eq!(
            texts(&levels)[1],
            "Isolas were found at A = 1, of the 2 levels, A = 1 to 2 (3 tasks still to come)."
        );
        levels[0].branches.truncate(1);
        assert!(texts(&levels)[2].starts_with("Not so far: nothing was found beside the main branch (3 tasks"));
        levels[1].pending = 0;
        assert_eq!(texts(&levels)[2], "No: nothing was found beside the main branch.");
    }

    #[test]
    fn what_is_only_known_in_part() {
        let at_least = |branch: BranchRow| BranchRow { peak_standing: Some(Standing::AtLeast), ..branch };
        let cut = branch("cut", 1, (120.0, 130.0), 2e-3);
        let [danger, onset, missed] = texts(&[level(1.0, vec![at_least(main(1e-3)), at_least(cut)])]);
        let reservation = "(1 branch cut off by a bound, perhaps part of the main branch)";
        assert!(
            danger.starts_with(&format!("No isola was found {reservation}; the largest response of all, ≥ 2 mm at")),
            "{danger}"
        );
        assert!(!danger.contains("on the main branch,"), "{danger}");
        assert!(onset.contains(reservation) && onset.starts_with("There is no isola"), "{onset}");
        assert_eq!(missed, format!("Not so far: nothing was found beside the main branch {reservation}."));
    }

    #[test]
    fn numbers_that_cannot_be_read() {
        let unreadable = branch("isola", 1, (120.0, 130.0), f64::NAN);
        let levels = [level(1.0, vec![main(1e-3), unreadable])];
        assert!(texts(&levels).iter().all(|text| !text.contains("NaN")), "{:?}", texts(&levels));
        let isola = branch("isola", 1, (120.0, 130.0), 1e-3);
        assert!(texts(&[level(1.0, vec![isola])])[2].starts_with("Ordinary continuation has no main branch"));
        assert_eq!(texts(&[level(1.0, Vec::new())])[1], "Nothing is known yet: 1 forcing level to come.");
    }
}
