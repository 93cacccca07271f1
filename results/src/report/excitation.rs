//! What the structure does of itself, and that nothing of it touches.

use super::evidence::{Evidence, Structure};
use crate::words::{capitalised, modes};

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
            return Some(format!("{} {has} negative linear damping{so}.", of(excited)));
        }
        if let Some(backbone) = self.backbones().find(|backbone| backbone.feeds_itself_from_rest()) {
            return Some(format!(
                "At small amplitudes the nonlinear forces feed more energy into mode {} than its damping takes: the \
                 structure can vibrate by itself, from rest and without forcing.",
                backbone.mode + 1
            ));
        }
        let has = if undamped.len() == 1 { "has" } else { "have" };
        (!undamped.is_empty())
            .then(|| format!("{} {has} no linear damping: nothing but the laws limits the resonance.", of(undamped)))
    }

    /// Says so if there are stops and no branch of any level touches one.
    pub(super) fn untouched(&self) -> Option<&'static str> {
        let is_untouched = crate::overview::is_untouched(self.levels);
        (self.structure.stops > 0 && is_untouched).then_some(crate::overview::UNTOUCHED)
    }
}

/// Modes that are counted from 1, at the beginning of a sentence.
fn of(numbers: &[usize]) -> String {
    let list: Vec<usize> = numbers.iter().map(|number| number - 1).collect();
    capitalised(&modes(&list))
}
