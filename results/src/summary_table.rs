//! The closing table of a run: what was found at every forcing level.

use crate::overview::{Level, Omissions, Overview, Rise};
use crate::store::{BranchRow, Reader, Result};
use crate::words::fixed_digits;
use comfy_table::{CellAlignment, Table, presets::UTF8_FULL_CONDENSED};

/// Levels shown at most; all of them are in summary.csv.
const LEVELS: usize = 60;

/// The closing table of a run, also one in progress.
///
/// # Errors
/// If the store cannot be read.
pub fn table(reader: &Reader) -> Result<String> {
    let _snapshot = reader.snapshot()?;
    let mut omissions = Omissions::default();
    let overview = Overview::read(reader, &mut omissions)?;
    let levels = &overview.levels;
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header(["A", "main peak", "isolas and others (range, peak)", "windows", "not found"]);
    for level in levels.iter().take(LEVELS) {
        table.add_row([
            level.amplitude.clone(),
            main(level),
            lines(level.others().map(other)),
            level.windows.len().to_string(),
            not_found(level),
        ]);
    }
    for column in [0, 3] {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let mut text = table.to_string();
    if levels.len() > LEVELS {
        text += &format!("\n... and {} more levels: see summary.csv", levels.len() - LEVELS);
    }
    if let Some(Rise { amplitudes: (from, to), omega: (low, high) }) = overview.rise() {
        let change = high - low;
        text += &format!(
            "\nThe frequency of the largest response rises most, by {change} rad/s to {high} rad/s, between A = {from} and A = {to}.",
            change = fixed_digits(change, 6),
            high = fixed_digits(high, 6)
        );
    } else if levels.len() > 1 {
        text += "\nThe frequency of the largest response never rises from one level to the next.";
    }
    Ok(text)
}

fn lines(lines: impl Iterator<Item = String>) -> String {
    lines.collect::<Vec<_>>().join("\n")
}

fn peak(row: &BranchRow) -> String {
    format!("{}{:.4e} m at {} rad/s", row.at_least(), row.amplitude_max, fixed_digits(row.omega_at_max, 6))
}

fn main(level: &Level) -> String {
    match (level.main(), &level.main_failure) {
        (Some(_), _) => lines(level.mains().map(peak)),
        (None, Some(failure)) => failure.clone(),
        (None, None) => "to come".to_string(),
    }
}

fn other(row: &BranchRow) -> String {
    let (low, high) = row.omega;
    let kind = if row.closed { String::new() } else { format!("{}: ", row.kind) };
    let end = if row.closed { String::new() } else { format!(" ({})", row.status) };
    format!("{kind}{} to {} rad/s, {}{end}", fixed_digits(low, 6), fixed_digits(high, 6), peak(row))
}

fn not_found(level: &Level) -> String {
    let pending = (level.pending > 0).then(|| format!("{} tasks to come", level.pending));
    let dead = (level.dead > 0).then(|| format!("{} tasks given up", level.dead));
    let not_found = level
        .not_found()
        .map(|(window, reason)| format!("{:.2} to {:.2} rad/s: {reason}", window.omega.0, window.omega.1));
    lines(not_found.chain(pending).chain(dead))
}
