//! Picks what a request names out of a run's figures.

use super::motion;
use super::named::{level, monitor};
use super::request::{Along, FigureName, Request};
use super::sheet::Sheet;
use crate::error::Error;
use crate::figure::Frame;
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
    let level = request.amplitude.as_deref().map(|text| level(&report.overview.levels, "--amplitude", text));
    let level = level.transpose()?;
    let sheet = if request.figure == FigureName::Motion {
        motion::sheet(&report, reader, monitor, request.at.as_deref())?
    } else {
        let name = request.figure.name();
        let why = report.figures.nothing.get(name);
        if let Some(why) = why {
            return Err(Error::Other(format!("nothing to draw: {why}")));
        }
        let frame = frame(&report, request.figure, level)?;
        let Some(mut figure) = report.figures.drawn.remove(name) else {
            return Err(Error::Other(format!("nothing to draw: the run has no figure {name}")));
        };
        figure.title = frame.as_ref().map(|frame| format!("windows at {}", frame.name));
        let choice = choice(request, monitor);
        Sheet { figure, columns: std::mem::take(&mut report.figures.columns), choice, frame }
    };
    Ok((sheet, report.omissions))
}

/// The windows of figures of one level: of the level typed, else of the one to look at first.
fn frame(report: &Report, figure: FigureName, level: Option<usize>) -> Result<Option<Frame>, Error> {
    if !matches!(figure, FigureName::Balance | FigureName::Backbone) {
        return Ok(None);
    }
    let subject = report.subject();
    let nothing = |why| Error::Other(format!("nothing to draw: {why}"));
    let backbone = subject.backbone().map_err(nothing)?;
    let level = level.or_else(|| subject.first_level());
    let frame = level.and_then(|level| Frame::of_level(&subject, backbone, level));
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
