//! The monitored dofs beside the first, whose amplitudes the table does not show.

use super::units::Units;
use crate::overview::{Level, in_words};
use crate::store::{Reader, Result};

/// Monitored dofs that are named.
const NAMED: usize = 4;

/// How far one of them moves at most.
pub(super) struct Largest {
    name: String,
    /// Amplitude, m, and frequency, rad/s.
    peak: (f64, f64),
    /// The branch, and its level.
    at: String,
}

/// The largest motions of the monitored dofs but the first, over all branches of these levels.
///
/// # Errors
/// If the store cannot be read.
pub(super) fn others(reader: &Reader, levels: &[Level], names: &[String]) -> Result<Vec<Largest>> {
    let mut list: Vec<Largest> = Vec::new();
    if names.len() < 2 {
        return Ok(list);
    }
    for level in levels {
        for row in &level.branches {
            let peaks = reader.monitor_peaks(row)?;
            for (name, &peak) in names.iter().zip(&peaks).skip(1).filter(|(_, peak)| peak.0.is_finite()) {
                let at = || format!("{} at A = {}", in_words(row), level.amplitude);
                match list.iter_mut().find(|largest| largest.name == *name) {
                    None => list.push(Largest { name: name.clone(), peak, at: at() }),
                    Some(largest) if peak.0 > largest.peak.0 => (largest.peak, largest.at) = (peak, at()),
                    Some(_) => {}
                }
            }
        }
    }
    Ok(list)
}

/// All of them in a sentence.
pub(super) fn sentence(others: &[Largest], Units { length, frequency }: Units) -> Option<String> {
    let of = |Largest { name, peak, at }: &Largest| {
        format!("{name} {} {length} at {} {frequency}, on {at}", length.digits(peak.0), frequency.digits(peak.1))
    };
    let named: Vec<String> = others.iter().take(NAMED).map(of).collect();
    let more = others.len().saturating_sub(NAMED);
    let more =
        if more > 0 { format!("; and {more} more: the page and branches/*.csv have them") } else { String::new() };
    (!named.is_empty()).then(|| format!("Largest amplitudes of other monitored dofs: {}{more}.", named.join("; ")))
}
