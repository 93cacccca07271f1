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

/// A forcing amplitude, which may be a level of the run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forcing {
    /// A.
    pub amplitude: f64,
    /// The level, by index.
    pub level: Option<usize>,
}

impl Forcing {
    /// Any forcing amplitude, as typed.
    ///
    /// # Errors
    /// If it is no number above zero.
    pub fn read(levels: &[Level], option: &str, text: &str) -> Result<Self, Error> {
        if let Ok(level) = level(levels, option, text) {
            return Ok(Self { amplitude: levels[level].value, level: Some(level) });
        }
        let number = text.parse().ok().filter(|amplitude: &f64| *amplitude > 0.0 && amplitude.is_finite());
        number
            .map(|amplitude| Self { amplitude, level: None })
            .ok_or_else(|| Error::Usage(format!("{option} {text}: a number above zero is needed")))
    }
}
