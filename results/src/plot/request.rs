//! Which figure, and what of the run it shows.

use crate::error::Error;
use crate::figure::Measure;
use crate::summary_table::UnitChoice;

/// A figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureName {
    /// Amplitude over frequency: main branches and isolas of every level.
    Response,
    /// Dissipated energy and work of the forcing along the backbone, for one forcing amplitude.
    Balance,
    /// Amplitude over frequency along the backbone, with the windows of one forcing amplitude.
    Backbone,
    /// Isola map: threshold over frequency with births and merges, and what every level has.
    Map,
    /// Fold curves: the amplitude at which branches turn back, over the forcing amplitude.
    Folds,
    /// Frequency and size of the largest response over the forcing amplitude, three ways.
    Resonance,
    /// Contributions of the modes along the backbone.
    Modes,
    /// One period at a point of a branch: gaps, displacements, pressures, spectrum, shape of the tip.
    Motion,
}

/// What a figure of the backbone is drawn over.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Along {
    /// Arc length.
    #[default]
    Arc,
    /// Frequency.
    Omega,
    /// Amplitude.
    Amplitude,
}

/// Which figure, and what of the run it shows.
#[derive(Debug, Clone)]
pub struct Request {
    /// Which figure.
    pub figure: FigureName,
    /// Forcing amplitudes that are shown; not for every figure. All of them if `None`.
    pub levels: Option<Vec<f64>>,
    /// Monitored dof whose amplitude is shown.
    pub monitor: Option<String>,
    /// Forcing amplitude of balance and backbone.
    pub amplitude: Option<String>,
    /// Mode, from 1, of whose backbone balance, backbone and modes are. If `None` that of which a window at the amplitude led to an
    /// isola, else the primary one.
    pub mode: Option<usize>,
    /// Point of motion: `A/branch/index`.
    pub at: Option<String>,
    /// What balance and modes are drawn over.
    pub along: Option<Along>,
    /// Frequencies that are shown, lowest and highest, in the unit of the axis; not for every figure. Where something happens if `None`.
    pub frequency: Option<(f64, f64)>,
    /// Amplitudes of the response that are shown, the same way.
    pub response: Option<(f64, f64)>,
    /// Forcing amplitudes along the axis that are shown, the same way.
    pub forcing: Option<(f64, f64)>,
    /// Units of axes; where none is chosen rad/s, and what lengths are read best in.
    pub units: UnitChoice,
}

impl Request {
    /// All that a run has for a figure.
    pub fn whole(figure: FigureName) -> Self {
        Self {
            figure,
            levels: None,
            monitor: None,
            amplitude: None,
            mode: None,
            at: None,
            along: None,
            frequency: None,
            response: None,
            forcing: None,
            units: UnitChoice::default(),
        }
    }
}

impl Request {
    /// The ranges of axes that are asked for.
    pub(super) fn ranges(&self) -> Vec<(Measure, (f64, f64))> {
        let asked = [
            (Measure::Frequency, self.frequency),
            (Measure::Response, self.response),
            (Measure::Forcing, self.forcing),
        ];
        asked.into_iter().filter_map(|(measure, range)| Some((measure, range?))).collect()
    }
}

/// The option by which a range of it is asked for.
pub(super) fn option_of(measure: Measure) -> &'static str {
    match measure {
        Measure::Frequency => "--frequency",
        Measure::Response => "--response",
        Measure::Forcing => "--forcing",
    }
}

/// Refuses what is no range of an axis.
fn is_range(measure: Measure, (low, high): (f64, f64)) -> Result<(), Error> {
    let option = option_of(measure);
    let what = match measure {
        Measure::Frequency => "frequency",
        Measure::Response => "amplitude of the response",
        Measure::Forcing => "forcing amplitude",
    };
    if !(low.is_finite() && high.is_finite() && low < high) {
        return Err(Error::Usage(format!(
            "{option} {low} {high}: the lowest and the highest {what} shown, in the unit of the axis, the first below the second"
        )));
    }
    // Axes of it may be logarithmic.
    if measure == Measure::Forcing && low <= 0.0 {
        return Err(Error::Usage(format!("{option} {low} {high}: both ends have to be above zero")));
    }
    Ok(())
}

impl FigureName {
    /// All figures.
    pub const ALL: [Self; 8] = [
        Self::Response,
        Self::Balance,
        Self::Backbone,
        Self::Map,
        Self::Folds,
        Self::Resonance,
        Self::Modes,
        Self::Motion,
    ];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Response => "response",
            Self::Balance => "balance",
            Self::Backbone => "backbone",
            Self::Map => "map",
            Self::Folds => "folds",
            Self::Resonance => "resonance",
            Self::Modes => "modes",
            Self::Motion => "motion",
        }
    }

    /// What it shows, in a line.
    pub fn about(self) -> &'static str {
        match self {
            Self::Response => "Amplitude over frequency: main branches and isolas of every level",
            Self::Balance => "Dissipated energy and work of the forcing along the backbone, for one forcing amplitude",
            Self::Backbone => "Amplitude over frequency along the backbone, with the windows of one forcing amplitude",
            Self::Map => "Isola map: threshold over frequency with births and merges, and what every level has",
            Self::Folds => "Amplitude at which branches turn back, over the forcing amplitude, with births and merges",
            Self::Resonance => "Frequency and size of the largest response over the forcing amplitude, three ways",
            Self::Modes => "Contributions of the modes along the backbone",
            Self::Motion => {
                "One period at a point of a branch: gaps, displacements, pressures, spectrum, shape of the tip"
            }
        }
    }

    /// Refuses options that mean nothing for this figure, and ends of axes that are no range.
    ///
    /// # Errors
    /// With the figures that take the option, or what it has to be.
    pub(super) fn accepts(self, request: &Request) -> Result<(), Error> {
        use FigureName::{Backbone, Balance, Folds, Map, Modes, Motion, Resonance, Response};
        let options: [(&str, bool, &[Self]); 9] = [
            ("--levels", request.levels.is_some(), &[Response, Map, Resonance]),
            ("--monitor", request.monitor.is_some(), &[Response, Backbone, Motion, Balance, Modes]),
            ("--amplitude", request.amplitude.is_some(), &[Balance, Backbone]),
            ("--mode", request.mode.is_some(), &[Balance, Backbone, Modes]),
            ("--at", request.at.is_some(), &[Motion]),
            ("--along", request.along.is_some(), &[Balance, Modes]),
            ("--frequency", request.frequency.is_some(), &[Response, Map, Backbone, Resonance]),
            ("--response", request.response.is_some(), &[Response, Backbone, Folds, Resonance]),
            ("--forcing", request.forcing.is_some(), &[Map, Folds, Resonance]),
        ];
        match options.into_iter().find(|(_, is_given, figures)| *is_given && !figures.contains(&self)) {
            None => request.ranges().into_iter().try_for_each(|(measure, range)| is_range(measure, range)),
            Some((option, _, figures)) => {
                let names: Vec<String> = figures.iter().map(|figure| figure.to_string()).collect();
                Err(Error::Usage(format!("{option}: not for the figure {self}, but for {}", names.join(", "))))
            }
        }
    }

    /// Whether it needs the points of branches.
    pub(super) fn shows_branches(self) -> bool {
        self == Self::Response
    }
}

impl std::fmt::Display for FigureName {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}
