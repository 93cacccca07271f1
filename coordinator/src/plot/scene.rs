//! What every figure is drawn from: the report, the levels chosen, and how quantities are named.

use super::Along;
use super::axis::Axis;
use crate::cli::PlotArgs;
use crate::error::Error;
use crate::report::words::length_unit;
use crate::report::{BackboneCurve, Level, Report};
use crate::survey;

/// The data of a figure.
pub struct Scene<'r> {
    /// The run.
    pub report: &'r Report,
    /// Levels by forcing amplitude.
    pub levels: &'r [survey::Level],
    /// The monitored dof, by index.
    pub monitor: usize,
    /// What figures of the backbone are drawn over.
    pub along: Along,
    /// The forcing amplitude typed, if it is one of the run, by index into its levels.
    amplitude: Option<usize>,
}

impl<'r> Scene<'r> {
    /// What the options name in a run.
    ///
    /// # Errors
    /// If there is no such dof or level, with those there are.
    pub fn new(report: &'r Report, args: &PlotArgs) -> Result<Self, Error> {
        Ok(Self {
            report,
            levels: &report.survey.levels,
            monitor: args.monitor.as_deref().map_or(Ok(0), |name| monitor(report, name))?,
            along: args.along.unwrap_or_default(),
            amplitude: args.amplitude.as_deref().map(|text| level(report, "--amplitude", text)).transpose()?,
        })
    }

    /// The backbone.
    ///
    /// # Errors
    /// If there is none yet, or if it cannot be read.
    pub fn backbone(&self) -> Result<&'r BackboneCurve, Error> {
        self.report.backbone.as_ref().ok_or_else(|| self.nothing("the backbone", "the run has no backbone yet"))
    }

    /// Why there is nothing to draw: what would be drawn is damaged, or is not there for another reason.
    pub fn nothing(&self, what: &str, otherwise: &str) -> Error {
        let left_out = |sentence: &&String| sentence.to_lowercase().starts_with(what) && sentence.contains("left out");
        let damage = self.report.run.missing.iter().find(left_out);
        Error::Other(format!("nothing to draw: {}", damage.map_or(otherwise, String::as_str)))
    }

    /// The level of figures of one level: the one typed, else the lowest with an isola, else the middle one.
    ///
    /// # Errors
    /// If the run has no level that can be read.
    pub fn level(&self) -> Result<&'r Level, Error> {
        let levels = &self.report.levels;
        let with_isola = self.levels.iter().find(|level| level.isolas().next().is_some());
        let lowest = with_isola.and_then(|found| levels.iter().position(|level| level.value == found.value));
        let index = self.amplitude.or(lowest).unwrap_or(levels.len() / 2);
        levels.get(index).ok_or_else(|| self.nothing("levels", "the run has no level"))
    }

    /// How many units make a metre, and the title of an axis of amplitudes of the monitored dof.
    pub fn amplitude_title(&self, largest: f64) -> (f64, String) {
        let (factor, unit) = length_unit(largest);
        (factor, format!("amplitude of {} ({unit})", self.report.monitors[self.monitor].name))
    }

    /// The axis and the values of what the backbone is drawn over.
    pub fn over(&self, backbone: &BackboneCurve) -> (Axis, Vec<f64>) {
        let amplitude = &backbone.amplitude[self.monitor].values;
        match self.along {
            Along::Arc => {
                let arc = backbone.arc.values.clone();
                (Axis::around("arc length along the backbone (scaled)", arc.iter().copied()), arc)
            }
            Along::Omega => {
                let omega = backbone.omega.values.clone();
                (Axis::around(FREQUENCY, omega.iter().copied()), omega)
            }
            Along::Amplitude => {
                let (factor, title) = self.amplitude_title(amplitude.iter().copied().fold(0.0, f64::max));
                let values: Vec<f64> = amplitude.iter().map(|x| x * factor).collect();
                (Axis::around(title, values.iter().copied()), values)
            }
        }
    }
}

/// Title of an axis of frequencies.
pub const FREQUENCY: &str = "frequency ω (rad/s)";

fn monitor(report: &Report, name: &str) -> Result<usize, Error> {
    let names: Vec<&str> = report.monitors.iter().map(|monitor| monitor.name.as_str()).collect();
    let known = || Error::Other(format!("--monitor {name}: the run monitors no such dof, but {}", names.join(", ")));
    names.iter().position(|known| *known == name).ok_or_else(known)
}

/// The level of a forcing amplitude, as typed or any other way of writing the number.
///
/// # Errors
/// If there is none, with those there are.
pub fn level(report: &Report, option: &str, text: &str) -> Result<usize, Error> {
    let is_it = |level: &Level| level.amplitude == text || text.parse() == Ok(level.value);
    let known: Vec<&str> = report.levels.iter().map(|level| level.amplitude.as_str()).collect();
    let unknown = || Error::Other(format!("{option} {text}: the run has no such level, but {}", known.join(", ")));
    report.levels.iter().position(is_it).ok_or_else(unknown)
}
