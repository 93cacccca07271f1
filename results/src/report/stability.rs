//! What time marching says of isolas and of the largest response.

use super::evidence::Evidence;
use crate::overview::{BranchRow, Level, near_largest};
use crate::store::Stability;
use crate::words::{count, digits, frequency};

impl Evidence<'_> {
    /// Whether isolas can be settled on, of one of them and all of them.
    pub(super) fn stability_of_isolas(&self) -> String {
        let isolas: Vec<&BranchRow> = self.levels.iter().flat_map(Level::isolas).collect();
        let verified: Vec<&Stability> = isolas.iter().filter_map(|isola| isola.stability.as_ref()).collect();
        if verified.is_empty() {
            return "Whether isolas are stable and what leads there was not verified.".into();
        }
        let is_stable = |stability: &&&Stability| stability.stable > 0.0;
        let is_unknown = |stability: &&&Stability| stability.stable == 0.0 && stability.unstable == 0.0;
        let (stable, unknown) = (verified.iter().filter(is_stable).count(), verified.iter().filter(is_unknown).count());
        let unstable = verified.len() - stable - unknown;
        let found = match [stable, unstable, unknown] {
            [1, 0, 0] if isolas.len() == 1 => {
                format!("Time marching found parts of the isola stable: there the structure can settle{}", self.up_to(&verified))
            }
            [0, 1, 0] if isolas.len() == 1 => {
                "Time marching found the isola unstable where it could tell: it separates, but nothing was seen to settle there".into()
            }
            [0, 0, 1] if isolas.len() == 1 => "Time marching could not tell whether any of the isola is stable".into(),
            _ => self.several(isolas.len(), [stable, unstable, unknown], &self.up_to(&verified)),
        };
        format!("{found}; {}.", self.what_leads_there())
    }

    /// The largest response that was found stable, as an addition to what is said of where the structure can settle.
    fn up_to(&self, verified: &[&Stability]) -> String {
        let largest = verified.iter().filter_map(|stability| stability.largest).max_by(|a, b| a.1.total_cmp(&b.1));
        largest.map_or_else(String::new, |(omega, amplitude)| {
            format!(", up to {} at {}", self.length(amplitude), frequency(omega))
        })
    }

    /// The smallest push found that leads to an isola, if pushes were marched.
    fn what_leads_there(&self) -> String {
        let least =
            self.pushes.iter().filter_map(|push| Some((push, push.impulse?))).min_by(|a, b| a.1.total_cmp(&b.1));
        match least {
            None if self.pushes.is_empty() => "what leads there was not looked for (isola disturb does)".into(),
            None => "no push that leads there was found".into(),
            Some((push, impulse)) => format!(
                "the smallest push found that leads there from the main motion, all dofs at once, has {} N s in mode {} alone ({} at A = {}, {})",
                digits(impulse, 3),
                push.mode,
                push.branch,
                push.forcing,
                frequency(push.omega)
            ),
        }
    }

    /// The same of several isolas: how many are stable in parts, unstable wherever that is known, and how many nothing is known of.
    fn several(&self, all: usize, [stable, unstable, unknown]: [usize; 3], up_to: &str) -> String {
        let stable_in_parts = format!("stable in parts, where the structure can settle{up_to}");
        let parts = [
            (stable, stable_in_parts.as_str()),
            (unstable, "unstable wherever time marching could tell"),
            (unknown, "beyond what time marching could tell"),
            (all - stable - unstable - unknown, "not verified"),
        ];
        let said: Vec<String> = parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        format!("Of {} {}", count(all, "isola"), said.join(", "))
    }

    /// What is known of the stability of the largest response.
    pub(super) fn stability_of_peak(&self, largest: &BranchRow) -> String {
        let peak = largest.stability.as_ref().and_then(|stability| stability.peak.as_ref());
        let unknown = || "Whether the largest response is stable was not verified.".into();
        peak.map_or_else(unknown, |peak| near_largest(peak, largest.amplitude_max, |x| self.length(x), frequency))
    }
}
