//! Counts of what was found, by resonance and by kind of structure.

use crate::comparison::Compared;
use crate::record::{Kind, Record, Resonance, Standing};
use comfy_table::{CellAlignment, Table, presets};
use std::collections::BTreeMap;

/// Isolas of a class: how many there are, and how many of them are listed.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    there: usize,
    listed: usize,
}

/// Counts over all structures.
#[derive(Debug, Default)]
pub struct Tally {
    by_resonance: BTreeMap<Resonance, Count>,
    by_kind: BTreeMap<Kind, Count>,
    apart: BTreeMap<Standing, Count>,
    /// Isolas that only the product has found, and branches that the truth keeps apart.
    confirmed: (usize, usize),
    all: Count,
    structures: usize,
    crowded: usize,
    with_isolas: usize,
    extra: usize,
    mains: usize,
    wrong_mains: usize,
    codes: BTreeMap<String, usize>,
}

impl Tally {
    /// Adds a structure: its levels compared, and the exit code of the product.
    pub fn add(&mut self, record: &Record, levels: &[Compared], code: Option<i32>) {
        self.structures += 1;
        self.crowded += record.levels.len() - levels.len();
        let code = code.map_or_else(|| "unknown".into(), |code| code.to_string());
        *self.codes.entry(code).or_default() += 1;
        let before = self.all.there;
        for compared in levels {
            self.extra += compared.extra.len();
            let isolas = compared.confirmed.iter().filter(|(isola, _)| isola.counts()).count();
            self.confirmed.0 += isolas;
            self.confirmed.1 += compared.confirmed.len() - isolas;
            self.mains += usize::from(compared.level.main.is_some());
            self.wrong_mains += usize::from(compared.wrong_main.is_some());
            for (isola, row) in &compared.found {
                let counts = if isola.counts() {
                    vec![
                        &mut self.all,
                        self.by_resonance.entry(isola.resonance).or_default(),
                        self.by_kind.entry(record.kind).or_default(),
                    ]
                } else {
                    vec![self.apart.entry(isola.standing).or_default()]
                };
                for count in counts {
                    count.there += 1;
                    count.listed += usize::from(row.is_some());
                }
            }
        }
        self.with_isolas += usize::from(self.all.there > before);
    }

    /// Whether at least 99 % of the isolas are listed, no other, and no main peak is wrong.
    pub fn is_good(&self) -> bool {
        100 * self.all.listed >= 99 * self.all.there && self.extra == 0 && self.wrong_mains == 0
    }

    /// The table and the sentences below it.
    pub fn report(&self) -> String {
        let mut table = Table::new();
        table.load_preset(presets::ASCII_MARKDOWN).set_header(["isolas", "there", "found", "recall"]);
        let mut row = |name: String, count: &Count| {
            let share = 100.0 * count.listed as f64 / count.there.max(1) as f64;
            table.add_row([name, count.there.to_string(), count.listed.to_string(), format!("{share:.1} %")]);
        };
        self.by_resonance.iter().for_each(|(resonance, count)| row(words(resonance), count));
        self.by_kind.iter().for_each(|(kind, count)| row(words(kind), count));
        row("all".into(), &self.all);
        self.apart.iter().for_each(|(standing, count)| row(format!("apart: {}", words(standing)), count));
        table.column_iter_mut().skip(1).for_each(|column| column.set_cell_alignment(CellAlignment::Right));
        let (isolas, unresolved) = self.confirmed;
        let stored = self.all.listed + self.apart.values().map(|count| count.listed).sum::<usize>();
        let listed = stored + isolas + unresolved;
        let precision = 100.0 * listed as f64 / (listed + self.extra).max(1) as f64;
        let codes: Vec<String> = self.codes.iter().map(|(code, count)| format!("{code} ({count})")).collect();
        format!(
            "{table}\n{} structures, {} with isolas; {} levels are crowded and left out.\nPrecision {precision:.1} %: of {} closed \
             branches listed {} are none. {stored} are stored, {} are not, of which the equations of the truth make {isolas} isolas and \
             {unresolved} unresolved ones.\nMain peaks wrong: {} of {}. Exit codes: {}.",
            self.structures,
            self.with_isolas,
            self.crowded,
            listed + self.extra,
            self.extra,
            isolas + unresolved,
            self.wrong_mains,
            self.mains,
            codes.join(", ")
        )
    }
}

/// The name of a class as it stands in the files, in words.
fn words(class: &impl serde::Serialize) -> String {
    let name = serde_json::to_value(class).ok().and_then(|value| value.as_str().map(str::to_owned));
    name.unwrap_or_default().replace('_', " ")
}
