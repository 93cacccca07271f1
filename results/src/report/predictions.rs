//! What the energy balance predicts, as an estimate, and was not found.

use super::evidence::Evidence;
use super::losses::named;
use crate::overview::{Level, later_birth};
use crate::words::{count, digits};

impl Evidence<'_> {
    /// Windows that led to no branch: those where fold curves have an isola born at a larger forcing, birth by birth, and the
    /// others together.
    pub(super) fn not_found(&self) -> Vec<String> {
        let mut births: Vec<(f64, Vec<&Level>)> = Vec::new();
        let mut others: Vec<&Level> = Vec::new();
        for level in self.levels {
            for (window, _) in level.not_found() {
                let levels = match later_birth(self.curves, level.value, window) {
                    None => &mut others,
                    Some(birth) => match births.iter().position(|(forcing, _)| *forcing == birth.forcing) {
                        Some(place) => &mut births[place].1,
                        None => {
                            births.push((birth.forcing, Vec::new()));
                            &mut births.last_mut().expect("one was pushed").1
                        }
                    },
                };
                levels.push(level);
            }
        }
        let early = births.into_iter().map(|(forcing, mut levels)| {
            levels.dedup_by(|a, b| a.amplitude == b.amplitude);
            let forcing = digits(forcing, 5);
            format!(
                "At {} the energy balance predicts a response in a range of frequencies in which, along fold curves, an isola \
                 is born at A = {forcing} only: none was found there.",
                named(&levels)
            )
        });
        let mut sentences: Vec<String> = early.collect();
        if !others.is_empty() {
            let windows = count(others.len(), "response");
            others.dedup_by(|a, b| a.amplitude == b.amplitude);
            let starts = match self.search.fewest {
                0 => String::new(),
                fewest => format!(", nor did {} a level", count(fewest, "random start")),
            };
            sentences.push(format!(
                "{windows} that the energy balance predicts, which is an estimate, not found at {}: none of their seeds led to a \
                 response near{starts}.",
                named(&others)
            ));
        }
        sentences
    }
}
