//! Single figures ready for a paper, from the store alone: `isola plot`.

mod axis;
mod backbone;
mod balance;
mod labels;
mod map;
mod modes;
mod motion;
mod output;
mod panel;
mod resonance;
mod response;
mod scene;
mod sheet;
mod style;

#[cfg(test)]
mod tests;

pub use output::Format;
pub use sheet::Sheet;

use crate::cli::PlotArgs;
use crate::error::Error;
use crate::report::{Report, Selection};
use crate::store::Reader;
use crate::survey::Lacks;
use clap::ValueEnum;
use scene::Scene;

/// A figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FigureName {
    /// Amplitude over frequency: main branches and isolas of every level
    Response,
    /// Dissipated energy and work of the forcing along the backbone, for one forcing amplitude
    Balance,
    /// Amplitude over frequency along the backbone, with the windows of one forcing amplitude
    Backbone,
    /// Isola map: threshold over frequency with births and merges, and what every level has
    Map,
    /// Frequency and size of the largest response over the forcing amplitude, three ways
    Resonance,
    /// Contributions of the modes along the backbone
    Modes,
    /// One period at a point of a branch: displacements, pressures, spectrum, shape of the tip
    Motion,
}

/// What a figure of the backbone is drawn over.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Along {
    /// Arc length
    #[default]
    Arc,
    /// Frequency
    Omega,
    /// Amplitude
    Amplitude,
}

impl FigureName {
    /// Refuses options that mean nothing for this figure.
    ///
    /// # Errors
    /// With the figures that take the option.
    pub fn accepts(self, args: &PlotArgs) -> Result<(), Error> {
        use FigureName::{Backbone, Balance, Map, Modes, Motion, Resonance, Response};
        let options: [(&str, bool, &[Self]); 5] = [
            ("--levels", args.levels.is_some(), &[Response, Map, Resonance]),
            ("--monitor", args.monitor.is_some(), &[Response, Backbone, Motion, Balance, Modes]),
            ("--amplitude", args.amplitude.is_some(), &[Balance, Backbone]),
            ("--at", args.at.is_some(), &[Motion]),
            ("--along", args.along.is_some(), &[Balance, Modes]),
        ];
        match options.into_iter().find(|(_, is_given, figures)| *is_given && !figures.contains(&self)) {
            None => Ok(()),
            Some((option, _, figures)) => {
                let names: Vec<String> = figures.iter().map(|figure| figure.to_string()).collect();
                Err(Error::Other(format!("{option}: not for the figure {self}, but for {}", names.join(", "))))
            }
        }
    }

    fn shows_branches(self) -> bool {
        self == Self::Response
    }
}

impl std::fmt::Display for FigureName {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let value = self.to_possible_value();
        formatter.write_str(value.as_ref().map_or("", |value| value.get_name()))
    }
}

/// Reads what a figure shows and composes it; with it comes what is missing.
///
/// # Errors
/// If the run cannot be read, has nothing for this figure yet, or lacks what the options name.
pub fn compose(reader: &Reader, args: &PlotArgs, selection: &Selection) -> Result<(Sheet, Lacks), Error> {
    args.figure.accepts(args)?;
    let _snapshot = reader.snapshot()?;
    let is_needless = *selection == Selection::All && !args.figure.shows_branches();
    let report = Report::read(reader, if is_needless { &Selection::NoBranches } else { selection })?;
    let scene = Scene::new(&report, args)?;
    let sheet = match args.figure {
        FigureName::Response => response::sheet(&scene),
        FigureName::Balance => balance::sheet(&scene),
        FigureName::Backbone => backbone::sheet(&scene),
        FigureName::Map => map::sheet(&scene),
        FigureName::Resonance => resonance::sheet(&scene),
        FigureName::Modes => modes::sheet(&scene),
        FigureName::Motion => motion::sheet(&scene, reader, args.at.as_deref()),
    }?;
    Ok((sheet, report.lacks))
}
