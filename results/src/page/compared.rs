//! What the page of several runs is given, as JSON.

use super::data::{length_unit, lengths};
use crate::compare::{Comparison, NumberRow, SettingRow};
use crate::figure::{Color, ColumnStore, Figure, Font, PALETTE, Palette, Unit, convert, place_for_page};
use crate::report::{Report, RunFacts};
use crate::told::Told;
use serde::Serialize;
use std::collections::BTreeMap;

/// The JSON of the page.
#[derive(Serialize)]
pub struct ComparedData<'c> {
    names: &'c [String],
    runs: Vec<&'c RunFacts>,
    palette: Palette,
    frequency_unit: String,
    length_unit: Option<Unit>,
    columns: &'c ColumnStore,
    levels: &'c [crate::compare::ComparedLevel],
    level_colors: Vec<Color>,
    branches: Vec<Branch<'c>>,
    figures: BTreeMap<&'static str, Figure>,
    nothing: &'c BTreeMap<&'static str, String>,
    settings: &'c [SettingRow],
    answer: &'c [String],
    numbers: &'c [NumberRow],
    sentences: &'c [Told],
}

/// What the choice of levels says of a branch.
#[derive(Serialize)]
struct Branch<'c> {
    run: &'c str,
    level: usize,
    kind: &'static str,
}

impl<'c> ComparedData<'c> {
    /// Of a comparison: labels are placed for the page here.
    pub fn new(comparison: &'c Comparison) -> Self {
        let Comparison { names, reports, levels, settings, answer, numbers, sentences, figures } = comparison;
        let mut drawn = figures.drawn.clone();
        let font = Font::bundled();
        // Those of the first run, as in files.
        let units = reports.first().map(Report::units).unwrap_or_default();
        for figure in drawn.values_mut() {
            convert(figure, lengths(units));
            place_for_page(figure, &figures.columns, &[], &font);
        }
        let branches = reports.iter().zip(names).flat_map(|(report, run)| {
            report.branches.iter().filter_map(move |branch| {
                let value = report.overview.levels.get(branch.level)?.value;
                let level = levels.iter().position(|level| level.value == value)?;
                Some(Branch { run, level, kind: branch.kind })
            })
        });
        Self {
            names,
            runs: reports.iter().map(|report| &report.run).collect(),
            palette: PALETTE,
            frequency_unit: units.of_table().frequency.to_string(),
            length_unit: length_unit(units),
            columns: &figures.columns,
            levels,
            level_colors: vec![Color::Soft; levels.len()],
            branches: branches.collect(),
            figures: drawn,
            nothing: &figures.nothing,
            settings,
            answer,
            numbers,
            sentences,
        }
    }
}
