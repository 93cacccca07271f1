//! The closing table of a run: the answer, what was found at every forcing level, and what of it asks for something; no line longer than
//! its reader's terminal.

mod answer;
mod footnotes;
mod known;
mod listed;
mod monitors;
pub(crate) mod motions;
pub(crate) mod pushes;
mod rows;
mod search;
mod sentences;
pub(crate) mod stability;
mod units;

pub use units::{FrequencyUnit, LengthUnit, UnitChoice, Units};

use crate::export::order_folder;
use crate::store::{Reader, Result};
use crate::words::{number, times};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
pub use footnotes::wrapped;
use known::Known;
use rows::Rows;
use solver::structure::Model;

/// Levels shown at most; all of them are in summary.csv.
const LEVELS: usize = 60;

/// What stands for the folder of the run in commands that sentences name.
const RUN: &str = "RUN";

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout<'r> {
    /// Largest number of characters of a line.
    pub width: u16,
    /// Units of amplitudes and frequencies.
    pub units: Units,
    /// The folder of the run, as commands are given it.
    pub run: &'r str,
}

impl Default for Layout<'_> {
    /// That of files, as wide as terminals once were, in m and rad/s, of a run in a folder that nobody has named.
    fn default() -> Self {
        Self { width: 80, units: Units::default(), run: RUN }
    }
}

/// The closing table of a run, also one in progress; of further orders of motions one each, below it.
///
/// # Errors
/// If the store cannot be read.
pub fn table(reader: &Reader, layout: Layout<'_>) -> Result<String> {
    let further = reader.further_orders()?;
    if further.is_empty() || reader.order().is_some() {
        return of_order(reader, layout);
    }
    let heading = |order: usize, files: &str| {
        let motions = match order {
            1 => "Motions of the period of the force".to_string(),
            _ => format!(
                "Motions that last {order} periods of the force (frequencies are theirs: the force has {} as much{files})",
                times(order)
            ),
        };
        wrapped(&motions, layout.width, "")
    };
    let first = reader.model()?.forcing_harmonic;
    let mut text = format!("{}\n{}", heading(first, ""), of_order(reader, layout)?);
    for order in further {
        let files = format!("; files in {}/", order_folder(order));
        let own = of_order(&reader.of_order(order)?, layout)?;
        text += &format!("\n\n{}\n{own}", heading(order, &files));
    }
    Ok(text)
}

/// The table of the order that the reader tells of.
fn of_order(reader: &Reader, layout: Layout<'_>) -> Result<String> {
    let _snapshot = reader.snapshot()?;
    let known = Known::read(reader)?;
    let mut rows = Rows::new(&known, layout.units);
    let table = grid(&known, &mut rows, layout.width);
    let said = |sentence: String| wrapped(&sentence.replace(RUN, layout.run), layout.width, "");
    let below = sentences::all(&known, layout.units).into_iter().map(said);
    let answer = answer::answer(&known, layout.units).into_iter().map(said);
    let parts = [String::new(), wrapped(&caption(&known, layout.units), layout.width, ""), table];
    Ok(answer.chain(parts).chain(rows.notes.lines(layout.width)).chain(below).collect::<Vec<_>>().join("\n"))
}

/// What the numbers of the table are.
fn caption(known: &Known, Units { length, frequency }: Units) -> String {
    // Of several orders each has a heading that says it.
    let force = match known.model.as_ref().map_or(1, |model| model.forcing().harmonic) {
        m if m > 1 && known.is_only_order => format!(" (of the response: the force has {} as much)", times(m)),
        _ => String::new(),
    };
    let unit = known.model.as_ref().and_then(unit_of_forcing).map_or_else(String::new, |unit| format!(", A in {unit}"));
    let of = match (&known.monitors[..], &known.model) {
        ([only], Some(model)) if model.dofs().len() > 1 => format!(" of {only}"),
        (monitors, _) => monitors::of_first(monitors),
    };
    format!("Largest amplitudes{of} in {length}, frequencies in {frequency}{force}{unit}:")
}

/// What A = 1 is, of a force on one dof: `N at tip`.
pub fn unit_of_forcing(model: &Model) -> Option<String> {
    let shape = model.forcing().shape.iter().zip(model.dofs());
    let mut acting = shape.filter(|(force, _)| **force != 0.0);
    let ((force, dof), None) = (acting.next()?, acting.next()) else { return None };
    Some(if *force == 1.0 { format!("N at {dof}") } else { format!("units of {} N at {dof}", number(*force)) })
}

/// The table itself.
fn grid(known: &Known, rows: &mut Rows<'_>, width: u16) -> String {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(width);
    // Main branches are followed of the first order's motions.
    let cells = |[level, main, others, windows]: [String; 4]| {
        [Some(level), Some(main).filter(|_| !known.is_further), Some(others), Some(windows)].into_iter().flatten()
    };
    table.set_header(cells(["A", "main peak", "isolas and others: range, peak", "windows\nfound"].map(String::from)));
    for level in known.shown() {
        table.add_row(cells(rows.of(level)));
    }
    if let Some(column) = table.column_mut(0) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.to_string()
}
