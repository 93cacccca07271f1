//! An answer with what stands before, behind and below it.

use crate::summary_table::wrapped;
use serde::Serialize;

/// One of the answers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Sentence {
    /// The question it answers.
    pub title: &'static str,
    /// What is said before the answer: that what was found may be far from all there is, or far from what more harmonics give.
    pub lead: Option<String>,
    /// The answer.
    pub text: String,
    /// That not all is known, and what is not.
    pub lost: Option<String>,
    /// What else is known, sentence by sentence.
    pub details: Vec<String>,
    /// How far it reaches: what was looked for, and what was not.
    pub reach: Option<String>,
}

impl Sentence {
    /// All of the answer.
    pub fn whole(&self) -> String {
        let answer = self.answer();
        let all = std::iter::once(answer.as_str()).chain(self.besides());
        all.collect::<Vec<_>>().join(" ")
    }

    /// Question and answer on lines of so many columns, what else is known in points below.
    pub fn lines(&self, width: u16) -> String {
        let points = self.besides().map(|point| wrapped(&format!("- {point}"), width, "  "));
        let all = [self.title.into(), wrapped(&self.answer(), width, "")].into_iter().chain(points);
        all.collect::<Vec<String>>().join("\n")
    }

    fn answer(&self) -> String {
        let all = self.lead.iter().chain([&self.text]).chain(&self.lost);
        all.map(String::as_str).collect::<Vec<_>>().join(" ")
    }

    fn besides(&self) -> impl Iterator<Item = &str> {
        self.details.iter().chain(&self.reach).map(String::as_str)
    }
}
