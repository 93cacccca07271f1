//! What is made of a stored run, at any stage: page, figures, files. What is missing in them is said on stderr.

use crate::cli::{ExportArgs, PlotArgs, ReportArgs};
use crate::commands::INCOMPLETE;
use crate::error::Error;
use crate::report::{Report, Selection};
use crate::store::Reader;
use crate::study::{StudyError, typed};
use crate::survey::Lacks;
use crate::{export, page, plot};
use std::ops::RangeInclusive;
use std::process::ExitCode;

/// Widths and heights of figures, mm.
const SIZES: RangeInclusive<f64> = 30.0..=1000.0;

/// The levels that `--levels` names.
fn selection(reader: &Reader, list: Option<&str>, otherwise: Selection) -> Result<Selection, Error> {
    let Some(list) = list else { return Ok(otherwise) };
    let wanted = typed("--levels", list).map_err(StudyError::from)?;
    let wanted: Vec<f64> = wanted.into_iter().map(|amplitude| amplitude.value).collect();
    let stored = reader.header()?.amplitudes;
    let text: Vec<&str> = stored.iter().map(|amplitude| amplitude.text.as_str()).collect();
    match wanted.iter().find(|value| !stored.iter().any(|amplitude| amplitude.value == **value)) {
        Some(value) => {
            Err(Error::Other(format!("--levels {value}: the run has no such level, but {}", text.join(", "))))
        }
        None => Ok(Selection::Amplitudes(wanted)),
    }
}

/// Says what is missing; the code tells whether something had to be left out because it is damaged.
fn code(lacks: &Lacks) -> ExitCode {
    for sentence in lacks.sentences() {
        eprintln!("note: {sentence}");
    }
    if lacks.damaged.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("The rest is what was stored. Restore a copy of the run, or start the study again in another folder.");
    ExitCode::from(INCOMPLETE)
}

/// Writes the page of a run.
pub fn report(args: &ReportArgs) -> Result<ExitCode, Error> {
    let reader = Reader::open(&args.run)?;
    let _snapshot = reader.snapshot()?;
    let selection = selection(&reader, args.levels.as_deref(), Selection::Fitting)?;
    let report = Report::read(&reader, &selection)?;
    let file = args.out.clone().unwrap_or_else(|| args.run.join("report.html"));
    export::write_whole(&file, page::report(&report).as_bytes())?;
    for sentence in &report.verdict {
        println!("{} {}", sentence.title, sentence.text);
    }
    println!("{}", file.display());
    Ok(code(&report.lacks))
}

/// Draws a figure of a run.
pub fn plot(args: &PlotArgs) -> Result<ExitCode, Error> {
    let format = plot::Format::of(&args.out)?;
    for (option, value) in [("--width", args.width), ("--height", args.height)] {
        if !SIZES.contains(&value) {
            return Err(Error::Other(format!("{option} {value}: use {} to {} mm", SIZES.start(), SIZES.end())));
        }
    }
    let reader = Reader::open(&args.run)?;
    let selection = selection(&reader, args.levels.as_deref(), Selection::All)?;
    let (sheet, lacks) = plot::compose(&reader, args, &selection)?;
    let bytes = format.bytes(&sheet.prepare(args.width, args.height)?)?;
    export::write_whole(&args.out, &bytes)?;
    println!("{}", args.out.display());
    Ok(code(&lacks))
}

/// Writes the files of a run.
pub fn export(args: &ExportArgs) -> Result<ExitCode, Error> {
    let reader = Reader::open(&args.run)?;
    let to = args.to.as_ref().unwrap_or(&args.run);
    let lacks = export::export(&reader, args.format, to)?;
    let files = match args.format {
        export::Format::Csv => "summary.csv, backbone.csv, windows.csv and branches/",
        export::Format::Mat => "run.mat and branches/",
        export::Format::Npz => "run.npz and branches/",
    };
    println!("{files} are in {}", to.display());
    Ok(code(&lacks))
}
