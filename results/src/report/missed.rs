//! What ordinary continuation would have missed.

use super::evidence::Evidence;
use super::ordinary::highest_of_all;
use super::predictions::{NOTHING, WINDOWS_ALONE};
use crate::overview::{BranchRow, Level, around_largest, highest, is_unmatched, undecided};
use crate::words::{self, digits};
use solver::response::branch::BranchKind;

/// A level with its highest isola and its main branch.
struct Gain<'r> {
    level: &'r Level,
    isola: &'r BranchRow,
    main: &'r BranchRow,
    /// Whether twice the harmonics, or time marching, confirm the isola.
    is_confirmed: bool,
    /// Whether the main branch is known to its ends.
    is_whole: bool,
}

impl Gain<'_> {
    fn ratio(&self) -> f64 {
        self.isola.amplitude_max / self.main.amplitude_max
    }

    /// How the answer begins, and what is said to follow main branches.
    fn begins(&self) -> [&'static str; 2] {
        let has_moved = |row: &BranchRow| !around_largest(row)[1].is_empty();
        match self.is_confirmed {
            false => ["Unless the isola is an artefact of too few harmonics, yes", "ordinary continuation"],
            true if has_moved(self.isola) || has_moved(self.main) => {
                ["As far as these harmonics tell, yes", "ordinary continuation"]
            }
            true => ["Yes", "it"],
        }
    }
}

impl<'r> Evidence<'r> {
    /// Whether it would have missed an isola, and by how much that goes up farther.
    pub(super) fn missed(&self) -> String {
        if self.has_nothing() {
            return format!("{NOTHING} (see the first answer).");
        }
        if self.is_empty() {
            return if self.is_over() {
                "Not known: no branch was found.".into()
            } else {
                "Nothing is known yet.".into()
            };
        }
        if self.with_isolas().next().is_none() {
            // An isola that fold curves have, and what may be one.
            let but = match (self.overlooked(), undecided(self.levels)) {
                (Some(_), _) => ", though along fold curves one is there",
                (None, undecided) => undecided,
            };
            let place = if self.is_of_windows_alone() { WINDOWS_ALONE } else { "where it was looked for" };
            return format!("{} {place}{but} (see the first answer).", self.none());
        }
        if self.is_further {
            return format!("All of it: ordinary continuation follows motions of a shorter period.{}", self.ordinary());
        }
        match self.largest_gain() {
            None => "Ordinary continuation has no main branch to compare the isolas with: see the account.".into(),
            Some(gain) => self.compared(&gain) + &self.farther(&gain) + &self.there(&gain),
        }
    }

    /// The highest isola of a further order beside the main branch under the same force.
    fn ordinary(&self) -> String {
        let Some((level, isola)) = highest_of_all(self.levels) else { return String::new() };
        let Some(ordinary) = (self.ordinary)(level.value, isola.omega_at_max) else { return String::new() };
        let ratio = isola.amplitude_max / ordinary.amplitude;
        let what = if ordinary.is_of_main { "main branch" } else { "linear response" };
        let compared = match ratio {
            ratio if ratio >= 2.0 => format!("{} times the", digits(ratio, 2)),
            ratio if ratio >= 1.0 => format!("{:.0} % more than the", (ratio - 1.0) * 100.0),
            ratio => format!("{:.0} % less than the", (1.0 - ratio) * 100.0),
        };
        format!(
            " At A = {} an isola goes up to {} at {}, {compared} {} or so of the {what} where the force has the same frequency, {}.",
            level.amplitude,
            self.size(isola),
            self.frequency(isola.omega_at_max),
            self.length(ordinary.amplitude),
            self.frequency(ordinary.omega)
        )
    }

    /// Where an isola goes up farthest beyond the main branch: of isolas that are confirmed and of main branches known to their ends, if there
    /// are such.
    fn largest_gain(&self) -> Option<Gain<'r>> {
        let gain = |level: &'r Level, isola: &'r BranchRow| {
            let main = level.main().filter(|main| main.amplitude_max > 0.0)?;
            let (is_confirmed, is_whole) = (!is_unmatched(isola), self.has_whole_main(level));
            Some(Gain { level, isola, main, is_confirmed, is_whole })
        };
        let all = self.with_isolas().flat_map(|level| level.isolas().map(move |isola| (level, isola)));
        let gains = all.filter_map(|(level, isola)| gain(level, isola)).filter(|gain| gain.ratio().is_finite());
        let order = |a: &Gain<'_>, b: &Gain<'_>| {
            let of = |gain: &Gain<'_>| (gain.is_confirmed, gain.is_whole);
            of(a).cmp(&of(b)).then(a.ratio().total_cmp(&b.ratio()))
        };
        gains.max_by(order)
    }

    fn compared(&self, gain: &Gain<'_>) -> String {
        let (Gain { level, isola, main, is_whole, .. }, [yes, who], ratio) = (gain, gain.begins(), gain.ratio());
        let amplitude = &level.amplitude;
        let is_farther = |other: &&BranchRow| other.amplitude_max > main.amplitude_max;
        let is_doubtful = |other: &BranchRow| is_unmatched(other) || !around_largest(other)[1].is_empty();
        // What is not converged, or not confirmed, leaves open which response is the largest.
        let largest = match level.others().filter(is_farther).map(is_doubtful).reduce(|a, b| a && b) {
            _ if !around_largest(main)[1].is_empty() => "; whether the largest response as well is not known",
            Some(true) => "; whether the largest response as well is not known",
            Some(false) => "",
            None => ", but not the largest response",
        };
        let isolas = if self.is_one_isola() { "isola" } else { "isolas" };
        let goes = format!("{} at {}{}", self.size(isola), self.frequency(isola.omega_at_max), self.stable_part(isola));
        if !is_whole {
            let stops = format!("{}{}", self.length(main.amplitude_max), around_largest(main)[1]);
            let all = match (ratio >= 1.0, yes) {
                (false, _) => format!("{yes}, the {isolas}{largest}"),
                (true, "Yes") => format!("The {isolas}, yes; by how much is not known"),
                (true, _) => format!("{yes}; by how much is not known"),
            };
            return format!(
                "{all}: at A = {amplitude} the main branch goes up to at least {stops}, an isola up to {goes}."
            );
        }
        let stops = format!("{} at {}", self.size(main), self.frequency(main.omega_at_max));
        match ratio {
            ratio if ratio >= 2.0 => format!(
                "{yes}. At A = {amplitude} {who} goes up to {stops}, an isola up to {goes}, {} times as much.",
                digits(ratio, 2)
            ),
            ratio if ratio >= 1.0 => format!(
                "{yes}. At A = {amplitude} {who} goes up to {stops}, an isola up to {goes}, {:.0} % more.",
                (ratio - 1.0) * 100.0
            ),
            ratio => format!(
                "{yes}, the {isolas}{largest}: at A = {amplitude} the main branch goes up to {stops}, an isola \
                 up to {goes}, {:.0} % less.",
                (1.0 - ratio) * 100.0
            ),
        }
    }

    /// What the main branch has where the isola is largest.
    fn there(&self, Gain { level, isola, is_whole, .. }: &Gain<'_>) -> String {
        let omega = isola.omega_at_max;
        if let Some(ordinary) = (self.ordinary)(level.value, omega) {
            return format!(
                " At {} the main branch reaches about {}.",
                self.frequency(omega),
                self.length(ordinary.amplitude)
            );
        }
        let ends = level.mains().map(|main| main.omega);
        let (low, high) = ends.fold((f64::INFINITY, 0.0_f64), |(low, high), ends| (low.min(ends.0), high.max(ends.1)));
        let (bound, how) = match omega {
            omega if omega < low => (low, "begins; a lower frequency.min follows it farther"),
            omega if omega > high => (high, "ends; a higher frequency.max follows it farther"),
            _ => return String::new(),
        };
        // Of one that broke off that is said elsewhere.
        let told = || {
            let bound = self.frequency(bound);
            format!(" The main branch was not followed to that frequency (at {bound} it {how}).")
        };
        if *is_whole { told() } else { String::new() }
    }

    /// What goes up farther than isola and main branch at their level.
    fn farther(&self, gain: &Gain<'_>) -> String {
        let higher = gain.isola.amplitude_max.max(gain.main.amplitude_max);
        let is_farther = |row: &&BranchRow| row.amplitude_max > higher;
        let place = |row: &BranchRow| format!("{} at {}", self.size(row), self.frequency(row.omega_at_max));
        let isola = highest(gain.level.isolas().filter(|isola| gain.is_confirmed && is_unmatched(isola)));
        let unconfirmed = isola.filter(is_farther).map(|row| {
            format!(
                " Farther than these two, up to {}, goes an isola there that twice the harmonics do not confirm.",
                place(row)
            )
        });
        let branched = gain.level.others().filter(|row| row.kind == BranchKind::Branched.name());
        let branched = highest(branched).filter(is_farther).map(|row| {
            format!(
                " Farther than these two goes {} there, up to {}, which branches off another response: continuation that does not switch \
                 branches misses it.",
                row.name(),
                place(row)
            )
        });
        let elsewhere = self.farther_elsewhere(gain, higher);
        unconfirmed.into_iter().chain(branched).chain(self.stable_beside(gain)).chain(elsewhere).collect()
    }

    /// Where nothing of the isola is stable, the largest other one there that is.
    fn stable_beside(&self, gain: &Gain<'r>) -> Option<String> {
        let stable = |isola: &'r BranchRow| Some((isola, isola.stability.as_ref()?.largest?));
        if gain.isola.stability.as_ref().is_none_or(|known| known.largest.is_some()) {
            return None;
        }
        let others = gain.level.isolas().filter_map(stable);
        let (isola, (omega, size)) = others.max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1))?;
        let (name, size) = (words::capitalised(&isola.name()), self.length(size));
        Some(format!(" {name} there is found stable up to {size} at {}.", self.frequency(omega)))
    }

    /// What branches off another response at another level, and goes farther than all that is compared.
    fn farther_elsewhere(&self, gain: &Gain<'_>, higher: f64) -> Option<String> {
        let others = self.levels.iter().filter(|level| level.value != gain.level.value);
        let branched = |level: &'r Level| level.others().filter(|row| row.kind == BranchKind::Branched.name());
        let rows = others.flat_map(|level| branched(level).map(move |row| (level, row)));
        let (level, row) = rows.max_by(|(_, a), (_, b)| a.amplitude_max.total_cmp(&b.amplitude_max))?;
        let main = level.main().map_or(0.0, |main| main.amplitude_max);
        (row.amplitude_max > higher.max(main)).then(|| {
            format!(
                " At A = {} goes {}, up to {} at {}, which branches off another response: continuation that does not switch branches misses it.",
                level.amplitude,
                row.name(),
                self.size(row),
                self.frequency(row.omega_at_max)
            )
        })
    }
}
