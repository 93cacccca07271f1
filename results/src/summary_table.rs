//! The closing table of a run: what was found at every forcing level, no line longer than its reader's terminal.

mod footnotes;
pub(crate) mod motions;
pub(crate) mod pushes;
mod search;
mod stability;
mod units;

pub use units::{FrequencyUnit, LengthUnit, UnitChoice, Units};

use crate::export::order_folder;
use crate::overview::{
    Lesser, Level, Omissions, Overview, Shift, UNTOUCHED, WindowOutcome, beyond, bounds, events_sentence,
    forcing_label, is_unconfirmed, is_untouched, later_birth, least_added, not_followed_sentence, reach_sentence,
    truncation, undetermined, unfinished,
};
use crate::store::{BranchRow, CurveRow, Reader, Result};
use crate::words::{count, times};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use footnotes::{Footnotes, wrapped};
use protocol::backbone::BackboneMessage;
use protocol::model::ModelMessage;
use search::Made;
use solver::response::branch::{BranchKind, Outcome};
use solver::settings::FrequencySettings;

/// Relative distance from a bound up to which a peak counts as at it.
const BESIDE: f64 = 1e-6;

/// Levels shown at most; all of them are in summary.csv.
const LEVELS: usize = 60;

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Largest number of characters of a line.
    pub width: u16,
    /// Units of amplitudes and frequencies.
    pub units: Units,
}

impl Default for Layout {
    /// That of files, as wide as terminals once were, in m and rad/s.
    fn default() -> Self {
        Self { width: 80, units: Units::default() }
    }
}

/// The closing table of a run, also one in progress; of further orders of motions one each, below it.
///
/// # Errors
/// If the store cannot be read.
pub fn table(reader: &Reader, layout: Layout) -> Result<String> {
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
fn of_order(reader: &Reader, layout: Layout) -> Result<String> {
    let _snapshot = reader.snapshot()?;
    let mut omissions = Omissions::default();
    let overview = Overview::read(reader, &mut omissions)?;
    let mains = omissions.read("How main branches end is", reader.main_outcomes()).unwrap_or_default();
    let curves = omissions.read("The list of fold curves is", reader.curves()).unwrap_or_default();
    let given = overview.header.as_ref().map(|header| header.settings.frequency).unwrap_or_default();
    let model = overview.model.as_ref().and_then(|message| message.model().ok());
    let lesser = model.as_ref().map(Lesser::of).unwrap_or_default();
    let notes = Footnotes::default();
    let mut rows = Rows { units: layout.units, mains: &mains, curves: &curves, lesser, given, notes };
    let levels = &overview.levels;
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(layout.width);
    // Main branches are followed of the first order's motions.
    let is_further = reader.order().is_some();
    let cells = |[level, main, others, windows]: [String; 4]| {
        [Some(level), Some(main).filter(|_| !is_further), Some(others), Some(windows)].into_iter().flatten()
    };
    table.set_header(cells(["A", "main peak", "isolas and others: range, peak", "windows\nfound"].map(String::from)));
    for level in levels.iter().take(LEVELS) {
        table.add_row(cells(rows.of(level)));
    }
    if let Some(column) = table.column_mut(0) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    // Of several orders each has a heading that says it.
    let force = match model.as_ref().map_or(1, |model| model.forcing().harmonic) {
        m if m > 1 && !is_further && reader.further_orders()?.is_empty() => {
            format!(" (of the response: the force has {} as much)", times(m))
        }
        _ => String::new(),
    };
    let Units { length, frequency } = layout.units;
    let heading = format!("Largest amplitudes in {length}, frequencies in {frequency}{force}:");
    let mut text = wrapped(&heading, layout.width, "") + "\n";
    text += &table.to_string();
    text += &rows.notes.lines(layout.width).iter().map(|lines| format!("\n{lines}")).collect::<String>();
    let mut say = |sentence: &str| text += &format!("\n{}", wrapped(sentence, layout.width, ""));
    let backbone = omissions.read("The backbone is", reader.backbone());
    let further = omissions.read("Further backbones are", reader.further_backbones()).unwrap_or_default();
    let backbones: Vec<&BackboneMessage> = backbone.iter().flatten().chain(&further).collect();
    if let Some(model) = &model {
        search::excitation(&backbones, model).iter().for_each(|sentence| say(sentence));
    }
    if levels.iter().take(LEVELS).flat_map(|level| &level.branches).any(|row| !row.at_least().is_empty()) {
        say("At least (≥): no more of the branch is known, and it may go on to larger responses.");
    }
    if levels.len() > LEVELS {
        say(&format!("... and {} more levels: see summary.csv", levels.len() - LEVELS));
    }
    if let Some(place) = model.as_ref().and_then(undetermined) {
        say(&format!("Note: {place}."));
    }
    unfinished(levels, backbone.as_ref().is_none_or(Option::is_some)).iter().for_each(|sentence| say(sentence));
    if model.as_ref().is_some_and(|model| model.contacts().count() > 0) && is_untouched(levels) {
        say(UNTOUCHED);
    }
    let settings = overview.header.as_ref().map(|header| header.settings);
    let harmonics = settings.map(|settings| settings.harmonics.count);
    let reach = omissions.read("The frequency range of the sweep is", reader.reach()).flatten();
    let frequencies = reach.map(|reach| reach.frequency);
    let bounds = bounds(given, frequencies, is_further);
    let unit = layout.units.frequency;
    let in_units = |omega: f64| format!("{} {unit}", unit.digits(omega));
    if let (Some(model), Some(settings)) = (&model, &settings) {
        search::no_isola(levels, &curves, bounds, model, settings).iter().for_each(|sentence| say(sentence));
    }
    let least = model.as_ref().map_or(1, |model| least_added(model, is_further));
    if let Some(sentence) = harmonics.and_then(|count| truncation(levels, count, least)) {
        say(&sentence);
    }
    stability::sentences(levels, layout.units).iter().for_each(|sentence| say(sentence));
    let search = omissions.read("What became of folds is", reader.search_counts()).unwrap_or_default();
    let events = events_sentence(&curves, |omega| format!("{}{}", in_units(omega), beyond(bounds, omega)));
    let missing = not_followed_sentence(search.hanging).filter(|_| events.is_some());
    [events, missing, shift(&overview, layout.units)].iter().flatten().for_each(|sentence| say(sentence));
    let motions = omissions.read("The list of motions is", reader.motions()).unwrap_or_default();
    motions::sentences(&motions, layout.units, is_further).iter().for_each(|sentence| say(sentence));
    let pushes = omissions.read("The list of pushes is", reader.pushes()).unwrap_or_default();
    let names = |model: &ModelMessage| model.monitors.iter().filter_map(|&dof| model.dofs.get(dof)).cloned().collect();
    let monitors: Vec<String> = overview.model.as_ref().map(names).unwrap_or_default();
    pushes::sentences(&pushes, &monitors, layout.units).iter().for_each(|sentence| say(sentence));
    let mains = reach_sentence(given, frequencies, in_units).filter(|_| !is_further);
    mains.iter().for_each(|sentence| say(sentence));
    if let (Some(model), Some(settings)) = (&model, &settings) {
        let choice = omissions.read("Which modes were followed is", reader.modes()).flatten();
        let made = Made { levels, backbones: &backbones, modes: choice.as_ref(), curves: curves.len(), search };
        search::looked_for(&made, model, settings).iter().for_each(|sentence| say(sentence));
    }
    Ok(text)
}

/// A relative change of a frequency that is not worth numbers.
const NEGLIGIBLE: f64 = 1e-3;

/// How the frequency of the largest response goes, as far as levels of which all is known tell.
fn shift(overview: &Overview, units: Units) -> Option<String> {
    let (unit, shift) = (units.frequency, overview.shift()?);
    let Shift { amplitudes: (from, to), omega: (before, after), branches } = &shift;
    // Where a level is not known to its end the frequency there may be another one.
    let of = if overview.levels.iter().all(Level::is_known) { "" } else { ", of levels that are known to their ends," };
    if shift.size() < NEGLIGIBLE * after {
        let percent = 100.0 * NEGLIGIBLE;
        return Some(format!(
            "From one level to the next the frequency of the largest computed response{of} changes by less than {percent} %."
        ));
    }
    let goes = if after > before { "rises" } else { "falls" };
    let size = unit.digits(shift.size());
    let at = format!("to {} {unit}", unit.digits(*after));
    let how = match branches {
        None => format!("it {goes} by {size} {unit}, {at}"),
        Some((one, other)) => {
            format!(
                "from {one} to {other}{}, by {size} {unit}, {at}",
                if one == other { ", not known to be the same one" } else { "" }
            )
        }
    };
    Some(format!("The frequency of the largest computed response{of} changes most from A = {from} to {to}: {how}."))
}

/// Makes the rows.
struct Rows<'r> {
    units: Units,
    /// How main branches end, with their amplitudes as typed.
    mains: &'r [(String, Outcome)],
    /// Fold curves.
    curves: &'r [CurveRow],
    /// What motions that branch off others have lost.
    lesser: Lesser,
    /// Bounds of the frequency that were given.
    given: FrequencySettings,
    notes: Footnotes,
}

impl Rows<'_> {
    fn of(&mut self, level: &Level) -> [String; 4] {
        // From left to right: footnotes are numbered as they are met.
        let main = self.main(level);
        let others = level.others().map(|row| self.other(row)).collect::<Vec<_>>();
        [level.amplitude.clone(), main, others.join("\n"), self.windows(level)]
    }

    fn peak(&self, row: &BranchRow) -> String {
        let Units { length, frequency } = self.units;
        format!("{}{} at {}", row.at_least(), length.digits(row.amplitude_max), frequency.digits(row.omega_at_max))
    }

    fn main(&mut self, level: &Level) -> String {
        if level.main().is_none() {
            if level.is_without_mains {
                return String::new();
            }
            return match &level.main_failure {
                Some(failure) => format!("none{}", self.notes.mark(format!("no main branch: {failure}"))),
                None => "to come".into(),
            };
        }
        let ends: Vec<Outcome> =
            self.mains.iter().filter(|(amplitude, _)| *amplitude == level.amplitude).map(|(_, end)| *end).collect();
        let peaks = level.mains().enumerate().map(|(i, row)| {
            let end = ends.get(i).filter(|end| end.is_unfinished());
            let mark = end.map(|end| self.notes.mark(format!("known only in part: {end}"))).unwrap_or_default();
            format!("{}{mark}{}", self.peak(row), self.outside(row))
        });
        peaks.collect::<Vec<_>>().join("\n")
    }

    /// A mark at a peak outside of the bounds that were given.
    fn outside(&mut self, row: &BranchRow) -> String {
        let FrequencySettings { min, max, .. } = self.given;
        let below = min.filter(|min| row.omega_at_max < min * (1.0 - BESIDE)).map(|_| "below frequency.min");
        let above = max.filter(|max| row.omega_at_max > max * (1.0 + BESIDE)).map(|_| "above frequency.max");
        let comes_back = if row.at_least().is_empty() { ": the branch goes there and comes back" } else { "" };
        let note = |bound: &str| self.notes.mark(format!("{bound}{comes_back}"));
        below.or(above).map(note).unwrap_or_default()
    }

    fn other(&mut self, row: &BranchRow) -> String {
        let unit = self.units.frequency;
        let range = format!("{}–{}", unit.digits(row.omega.0), unit.digits(row.omega.1));
        let peak = self.peak(row);
        if row.is_isola() {
            let doubt = "perhaps of the truncation alone: no peak like its own was found with twice the harmonics, and no motion near \
                         it by time marching";
            let mark = if is_unconfirmed(row) { self.notes.mark(doubt.into()) } else { String::new() };
            return format!("{range}, {peak}{mark}");
        }
        let meaning = match row.kind.as_str() {
            kind if kind == BranchKind::Open.name() => "; detached, but not closed",
            kind if kind == BranchKind::Branched.name() => &format!("; {}", self.lesser.than("what it branches off")),
            _ => "; whether it is detached is not known",
        };
        // `open` is the name of a kind as well.
        let ends = row.status.strip_prefix("open: ").map_or_else(|| row.status.clone(), |ends| format!("from {ends}"));
        let mark = self.notes.mark(format!("{ends}{meaning}"));
        format!("{}: {range}, {peak}{mark}", row.kind)
    }

    /// In how many windows their seeds led to a branch, of how many, and what is missing of the level.
    fn windows(&mut self, level: &Level) -> String {
        let unit = self.units.frequency;
        let missed = level.not_found().map(|(window, reason)| {
            let (low, high) = (unit.digits(window.omega.0), unit.digits(window.omega.1));
            let why = match later_birth(self.curves, level, window) {
                Some(birth) => format!("an isola is born there at A = {} only", forcing_label(birth, 5)),
                None => reason,
            };
            self.notes.mark(format!("A = {}, window {low}–{high}: not found: {why}", level.amplitude))
        });
        let missed: Vec<String> = missed.collect();
        let found = level.windows.iter().filter(|window| matches!(window.outcome, WindowOutcome::Found(_))).count();
        let mut lines = vec![match level.windows.len() {
            0 => "no window".into(),
            all => format!("{found} of {all}{}", missed.join(" ")),
        }];
        lines.extend((level.pending > 0).then(|| format!("{} to come", count(level.pending, "task"))));
        let given_up = || format!("A = {}: tasks given up: isola retry-dead RUN tries them again", level.amplitude);
        lines.extend(
            (level.dead > 0).then(|| format!("{} given up{}", count(level.dead, "task"), self.notes.mark(given_up()))),
        );
        let contradicted = || format!("A = {}: other workers came to something else", level.amplitude);
        let results = level.refuted + level.disputed;
        lines.extend((results > 0).then(|| format!("{results} doubtful{}", self.notes.mark(contradicted()))));
        lines.join("\n")
    }
}
