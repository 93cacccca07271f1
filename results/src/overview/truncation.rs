//! Whether enough harmonics were kept: peaks of all branches against those with twice the harmonics.

use super::level::Level;
use crate::store::BranchRow;
use crate::words::digits;
use solver::response::certificate::Standing;

/// A peak that changes by no more than this with twice the harmonics is converged.
const CONVERGED: f64 = 0.01;

/// One sentence on the truncation to H harmonics: to what the peaks are converged, or which one is not and what to set. `None`
/// as long as nothing is known of it.
pub fn truncation(levels: &[Level], harmonics: usize) -> Option<String> {
    let rows = || levels.iter().flat_map(|level| level.branches.iter().map(move |row| (level, row)));
    let changes = rows().filter_map(|(level, row)| Some((level, row, change(row)?)));
    let largest = changes.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
    // Not computed where the peak is no maximum; otherwise nothing like it was found with more harmonics.
    let lost = rows().find(|(_, row)| has_maximum(row) && row.certificate.doubled.is_none());
    let lost = lost.filter(|_| rows().any(|(_, row)| row.certificate.doubled.is_some()));
    let remedy = format!("set harmonics.count = {}", 2 * harmonics);
    if let Some((level, row)) = lost {
        return Some(format!(
            "Not converged in H: with twice the harmonics no peak was found near that of {} at A = {}; {remedy}.",
            row.name(),
            level.amplitude
        ));
    }
    let (level, row, change) = largest?;
    if change.abs() <= CONVERGED {
        let to = digits((100.0 * change.abs()).max(0.01), 1);
        return Some(format!("Peaks are converged in H = {harmonics} to {to} %."));
    }
    let depth = row.certificate.penetration.filter(|depth| *depth > 0.0);
    let depth = depth.map(|depth| format!(", and its contact penetrates by {} % of the gap", digits(100.0 * depth, 2)));
    Some(format!(
        "Not converged in H: with twice the harmonics the peak of {} at A = {} changes by {} %{}; {remedy}.",
        row.name(),
        level.amplitude,
        digits(100.0 * change, 2),
        depth.unwrap_or_default()
    ))
}

/// Whether the largest amplitude of a branch is that of a maximum.
fn has_maximum(row: &BranchRow) -> bool {
    row.is_isola() || row.peak_standing == Some(Standing::At)
}

/// Relative change of a peak with twice the harmonics.
fn change(row: &BranchRow) -> Option<f64> {
    let change = row.certificate.doubled?.amplitude / row.amplitude_max - 1.0;
    change.is_finite().then_some(change)
}

#[cfg(test)]
mod tests {
    use super::*;
    use solver::response::certificate::{Certificate, Doubled};

    fn row(kind: &str, amplitude_2h: Option<f64>) -> BranchRow {
        let doubled = amplitude_2h.map(|amplitude| Doubled { amplitude, shift: 0.0 });
        let certificate = Certificate { penetration: Some(0.13), pressure_beyond: None, doubled };
        BranchRow {
            kind: kind.into(),
            number: 1,
            closed: kind == "isola",
            certificate,
            amplitude_max: 1.0,
            ..BranchRow::default()
        }
    }

    fn levels(branches: Vec<BranchRow>) -> [Level; 1] {
        [Level { amplitude: "60".into(), value: 60.0, branches, ..Level::default() }]
    }

    #[test]
    fn a_main_peak_that_is_not_there_with_more_harmonics() {
        let main = |standing| BranchRow { peak_standing: Some(standing), ..row("main", None) };
        let said = |standing| truncation(&levels(vec![main(standing), row("isola", Some(1.0))]), 10).unwrap();
        assert!(said(Standing::At).contains("no peak was found near that of main at A = 60"), "{}", said(Standing::At));
        assert_eq!(said(Standing::AtLeast), "Peaks are converged in H = 10 to 0.01 %.");
    }

    #[test]
    fn what_more_harmonics_would_change() {
        assert_eq!(truncation(&levels(vec![row("main", None), row("isola", None)]), 10), None);
        let converged = levels(vec![row("main", Some(1.004)), row("isola", Some(0.9999))]);
        assert_eq!(truncation(&converged, 10).unwrap(), "Peaks are converged in H = 10 to 0.4 %.");
        let moved = levels(vec![row("main", Some(1.004)), row("isola", Some(0.8))]);
        assert_eq!(
            truncation(&moved, 10).unwrap(),
            "Not converged in H: with twice the harmonics the peak of isola 1 at A = 60 changes by -20 %, and its contact \
             penetrates by 13 % of the gap; set harmonics.count = 20."
        );
        let lost = levels(vec![row("main", Some(1.0)), row("isola", None)]);
        assert!(truncation(&lost, 10).unwrap().contains("no peak was found near that of isola 1"));
    }
}
