//! Picks what a request names out of a run's figures.

use super::motion;
use super::named::{Forcing, monitor};
use super::part::cut;
use super::request::{Along, FigureName, Request};
use super::sheet::Sheet;
use crate::compare::Comparison;
use crate::error::Error;
use crate::figure::{Frame, convert, write_frequencies};
use crate::overview::Omissions;
use crate::report::{Report, Selection};
use crate::store::Reader;

/// Reads what a figure shows; with it comes what is missing.
///
/// # Errors
/// If the run cannot be read, has nothing for this figure yet, or lacks what the options name.
pub fn compose(reader: &Reader, request: &Request) -> Result<(Sheet, Omissions), Error> {
    request.figure.accepts(request)?;
    let _snapshot = reader.snapshot()?;
    let selection = match &request.levels {
        Some(levels) => Selection::Amplitudes(levels.clone()),
        None if request.figure.shows_branches() => Selection::All,
        None => Selection::NoBranches,
    };
    let mut report = Report::read(reader, &selection)?;
    let monitor = request.monitor.as_deref().map_or(Ok(0), |name| monitor(&report.monitors, name))?;
    let forcing = request.amplitude.as_deref().map(|text| Forcing::read(&report.overview.levels, "--amplitude", text));
    let forcing = forcing.transpose()?;
    let level = forcing.and_then(|forcing| forcing.level);
    if matches!(request.figure, FigureName::Balance | FigureName::Backbone | FigureName::Modes) {
        match request.mode {
            Some(number) => report.turn_to(number).map_err(Error::Usage)?,
            None if level.is_some() => report.turn_to_isola(level),
            None => {}
        }
    }
    let mut sheet = if request.figure == FigureName::Motion {
        let unit = request.units.frequency.unwrap_or_default();
        motion::sheet(&report, reader, monitor, request.at.as_deref(), unit)?
    } else {
        let name = request.figure.name();
        let why = report.figures.nothing.get(name);
        if let Some(why) = why {
            return Err(Error::Other(format!("nothing to draw: {why}")));
        }
        let frame = frame(&report, request.figure, forcing)?;
        let Some(mut figure) = report.figures.drawn.remove(name) else {
            return Err(Error::Other(format!("nothing to draw: the run has no figure {name}")));
        };
        figure.legend.retain(|entry| frame.is_some() || !entry.by_amplitude);
        let mode = report.backbone.as_ref().filter(|_| !report.further.is_empty()).map(|backbone| backbone.mode + 1);
        let of_mode = mode.map_or_else(String::new, |mode| format!(" of mode {mode}"));
        figure.title = match &frame {
            Some(frame) => Some(format!("windows{of_mode} at {}{}", frame.name, frame.beside())),
            None => mode.filter(|_| request.figure == FigureName::Modes).map(|mode| format!("backbone of mode {mode}")),
        };
        let choice = choice(request, monitor);
        Sheet { figure, columns: std::mem::take(&mut report.figures.columns), choice, frame }
    };
    write_frequencies(&mut sheet.figure, request.units.frequency.unwrap_or_default());
    convert(&mut sheet.figure, request.units);
    cut(&mut sheet.figure, &sheet.columns, &request.ranges())?;
    Ok((sheet, report.omissions))
}

/// Reads what a figure shows of several runs, each with the name of its folder; with it comes what is missing.
///
/// # Errors
/// Those of [`compose`], and a figure that several runs have not together.
pub fn compose_several(runs: &[(String, Reader)], request: &Request) -> Result<(Sheet, Vec<Omissions>), Error> {
    let figures = [FigureName::Response, FigureName::Resonance];
    if !figures.contains(&request.figure) || request.monitor.is_some() {
        return Err(Error::Usage(
            "of several runs there are the figures response and resonance, of the first monitored dof".into(),
        ));
    }
    request.figure.accepts(request)?;
    let selection = request.levels.clone().map_or(Selection::All, Selection::Amplitudes);
    let read = |(folder, reader): &(String, Reader)| -> Result<(String, Report), Error> {
        let _snapshot = reader.snapshot()?;
        Ok((folder.clone(), Report::read(reader, &selection)?))
    };
    let mut comparison = Comparison::new(runs.iter().map(read).collect::<Result<_, _>>()?);
    let name = request.figure.name();
    let Some(mut figure) = comparison.figures.drawn.remove(name) else {
        let why = comparison.figures.nothing.remove(name).unwrap_or_default();
        return Err(Error::Other(format!("nothing to draw: {why}")));
    };
    convert(&mut figure, request.units);
    cut(&mut figure, &comparison.figures.columns, &request.ranges())?;
    let sheet = Sheet { figure, columns: std::mem::take(&mut comparison.figures.columns), choice: 0, frame: None };
    Ok((sheet, comparison.reports.into_iter().map(|report| report.omissions).collect()))
}

/// The windows of figures of one forcing amplitude: of that typed, else of the level to look at first.
fn frame(report: &Report, figure: FigureName, forcing: Option<Forcing>) -> Result<Option<Frame>, Error> {
    if !matches!(figure, FigureName::Balance | FigureName::Backbone) {
        return Ok(None);
    }
    let subject = report.subject();
    let nothing = |why| Error::Other(format!("nothing to draw: {why}"));
    let backbone = subject.backbone().map_err(nothing)?;
    let frame = match forcing {
        Some(forcing) => Some(Frame::at(&subject, backbone, forcing.amplitude)),
        None => subject.first_level().and_then(|level| Frame::of_level(&subject, backbone, level)),
    };
    frame.map(Some).ok_or_else(|| nothing(subject.nothing("levels", "the run has no level")))
}

/// The option of the figure's choice.
fn choice(request: &Request, monitor: usize) -> usize {
    match (request.figure, request.along.unwrap_or_default()) {
        (FigureName::Balance | FigureName::Modes, Along::Arc) => 0,
        (FigureName::Balance | FigureName::Modes, Along::Omega) => 1,
        (FigureName::Balance | FigureName::Modes, Along::Amplitude) => 2 + monitor,
        _ => monitor,
    }
}
