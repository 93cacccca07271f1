//! What ordinary continuation would have missed.

use super::evidence::Evidence;
use super::verdict::NOTHING;
use crate::overview::{BranchRow, Level, around_largest, highest, is_unmatched};
use crate::words::digits;
use solver::response::branch::BranchKind;

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

impl Evidence<'_> {
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
            return format!("{} where it was looked for (see the first answer).", self.none());
        }
        if self.is_further {
            return "All of it: ordinary continuation follows motions of a shorter period.".into();
        }
        let mut known = self.with_isolas().flat_map(Level::isolas).filter(|isola| !is_unmatched(isola));
        let is_any_confirmed = known.next().is_some();
        let counts = |isola: &&BranchRow| !is_any_confirmed || !is_unmatched(isola);
        let gains = self.with_isolas().filter_map(|level| {
            let main = level.main().filter(|main| main.amplitude_max > 0.0)?;
            Some(Gain { level, isola: highest(level.isolas().filter(counts))?, main })
        });
        let of_whole = gains.clone().filter(|gain| self.has_whole_main(gain.level));
        let largest = |a: &Gain<'_>, b: &Gain<'_>| a.ratio().total_cmp(&b.ratio());
        let Some(gain) = of_whole.max_by(largest) else {
            return match gains.max_by(largest) {
                None => "Ordinary continuation has no main branch to compare the isolas with: see the account.".into(),
                Some(Gain { level, isola, main }) => format!(
                    "The isolas, yes; by how much is not known: at A = {} the main branch goes up to at least {}{}, an isola \
                     up to {} at {}.",
                    level.amplitude,
                    self.length(main.amplitude_max),
                    around_largest(main)[1],
                    self.size(isola),
                    self.frequency(isola.omega_at_max)
                ),
            };
        };
        let Gain { level, isola, main } = &gain;
        let (stops, goes) = (
            format!("{} at {}", self.size(main), self.frequency(main.omega_at_max)),
            format!("{} at {}{}", self.size(isola), self.frequency(isola.omega_at_max), self.stable_part(isola)),
        );
        let amplitude = &level.amplitude;
        let yes = if is_any_confirmed { "Yes" } else { "Perhaps, if it is no artefact of too few harmonics" };
        let answer = match gain.ratio() {
            ratio if ratio >= 2.0 => format!(
                "{yes}. At A = {amplitude} it goes up to {stops}, an isola up to {goes}, {} times as much.",
                digits(ratio, 2)
            ),
            ratio if ratio >= 1.0 => format!(
                "{yes}. At A = {amplitude} it goes up to {stops}, an isola up to {goes}, {:.0} % more.",
                (ratio - 1.0) * 100.0
            ),
            ratio => format!(
                "{yes}, the isolas, but not the largest response: at A = {amplitude} the main branch goes up to {stops}, an isola \
                 up to {goes}, {:.0} % less.",
                (1.0 - ratio) * 100.0
            ),
        };
        let branched = level.others().filter(|row| row.kind == BranchKind::Branched.name());
        let higher = isola.amplitude_max.max(main.amplitude_max);
        let larger = highest(branched).filter(|row| row.amplitude_max > higher).map_or_else(String::new, |row| {
            format!(
                " Larger still is {} there, up to {} at {}, which branches off another response: continuation that does not switch \
                 branches misses it.",
                row.name(),
                self.size(row),
                self.frequency(row.omega_at_max)
            )
        });
        answer + &larger
    }
}
