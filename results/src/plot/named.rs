//! What options name in a run.

use crate::curves::Monitor;
use crate::error::Error;
use crate::overview::Level;
use crate::words::instead;

/// The monitored dof of this name.
///
/// # Errors
/// If there is none, with those there are.
pub fn monitor(monitors: &[Monitor], name: &str) -> Result<usize, Error> {
    let names: Vec<&str> = monitors.iter().map(|monitor| monitor.name.as_str()).collect();
    let known = || Error::Usage(format!("--monitor {name}: the run monitors no such dof, but {}", names.join(", ")));
    names.iter().position(|known| *known == name).ok_or_else(known)
}

/// The level of a forcing amplitude, as typed or any other way of writing the number.
///
/// # Errors
/// If there is none, with those there are, or near ones.
pub fn level(levels: &[Level], option: &str, text: &str) -> Result<usize, Error> {
    let is_it = |level: &Level| level.amplitude == text || text.parse() == Ok(level.value);
    let known: Vec<(f64, &str)> = levels.iter().map(|level| (level.value, level.amplitude.as_str())).collect();
    let others: Vec<f64> = text.parse::<f64>().into_iter().collect();
    let unknown = || Error::Usage(format!("{option} {text}: the run has no such level, {}", instead(&others, &known)));
    levels.iter().position(is_it).ok_or_else(unknown)
}
