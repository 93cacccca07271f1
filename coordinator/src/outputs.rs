//! What is made of a stored run, at any stage: page, figures, files. What is missing in them is said on stderr.

use crate::cli::ExportArgs;
use crate::error::Error;
use crate::exit;
use results::export;
#[cfg(feature = "page")]
use results::export::order_folder;
use results::overview::Omissions;
use results::store::Reader;
#[cfg(any(feature = "figures", feature = "page"))]
use results::words::instead;
use results::words::listed;
use std::fmt::Display;
#[cfg(feature = "page")]
use std::path::Path;
#[cfg(any(feature = "figures", feature = "page"))]
use std::path::PathBuf;
use std::process::ExitCode;
use worker::terminal;

/// Notes that are told one by one.
const NOTES: usize = 12;

/// The file of a page.
#[cfg(feature = "page")]
const PAGE: &str = "report.html";

/// Says what was made and what is missing; the code tells whether something had to be left out because it is damaged.
fn told(made: impl Display, omissions: &Omissions) -> Result<ExitCode, Error> {
    told_of_all(made, &[omissions])
}

/// The same of several runs.
fn told_of_all(made: impl Display, omissions: &[&Omissions]) -> Result<ExitCode, Error> {
    terminal::print(made).map_err(Error::io("standard output"))?;
    let all = || omissions.iter().flat_map(|omissions| omissions.sentences());
    for sentence in all().take(NOTES) {
        terminal::note(format_args!("note: {sentence}"));
    }
    let more = all().count().saturating_sub(NOTES);
    if more > 0 {
        terminal::note(format_args!("note: and {more} more like these."));
    }
    if omissions.iter().all(|omissions| omissions.damaged.is_empty()) {
        return Ok(ExitCode::SUCCESS);
    }
    terminal::note(
        "The rest is what was stored. Restore a copy of the run, or start the study again in another folder.",
    );
    Ok(ExitCode::from(exit::INCOMPLETE))
}

/// Writes the files of a run.
pub fn export(args: &ExportArgs) -> Result<ExitCode, Error> {
    let reader = Reader::open(&args.run)?;
    let to = args.to.as_ref().unwrap_or(&args.run);
    let export::Exported { written, omissions } = export::export(&reader, args.format, to)?;
    told(written.iter().map(where_it_is).collect::<String>(), &omissions)
}

/// A line that says which files an export has written into a folder.
fn where_it_is(written: &export::Written) -> String {
    let of_order = written.order.map_or_else(String::new, |order| format!(" of motions of order {order}"));
    format!("{}{of_order} are in {}\n", listed(&written.files), written.folder.display())
}

/// Writes the page of a run.
#[cfg(feature = "page")]
pub fn report(args: &crate::cli::ReportArgs) -> Result<ExitCode, Error> {
    let [run] = &args.runs[..] else { return compare(args) };
    let first = Reader::open(run)?;
    let orders = Orders { first: first.model()?.forcing_harmonic, further: first.further_orders()? };
    let written = match args.order {
        Some(order) => vec![order],
        None => orders.all().collect(),
    };
    let (mut made, mut omissions) = (String::new(), Omissions::default());
    for (i, &order) in written.iter().enumerate() {
        let reader = of_order(Reader::open(run)?, &orders.further, order)?;
        let file = |other| orders.file(run, args, other);
        // Of an order that is asked for alone there may be others in their places already, but not beside a file that has a name.
        let is_there = |other: &usize| written.contains(other) || args.out.is_none() && file(*other).exists();
        let beside = orders.all().filter(is_there).collect::<Vec<usize>>();
        let (text, missing) = page(&reader, args, &file(order), &orders.pages(&beside, order, args.out.as_deref()))?;
        if i > 0 {
            made += &format!("\nMotions that last {order} periods of the force:\n");
        }
        made += &text;
        omissions.damaged.extend(missing.damaged);
        omissions.missing.extend(missing.missing);
    }
    told(made, &omissions)
}

/// Orders of the motions that a run looks for.
#[cfg(feature = "page")]
struct Orders {
    first: usize,
    further: Vec<usize>,
}

#[cfg(feature = "page")]
impl Orders {
    fn all(&self) -> impl Iterator<Item = usize> {
        std::iter::once(self.first).chain(self.further.iter().copied())
    }

    /// Where the files of an order are, in the folder of the run.
    fn folder(&self, run: &Path, order: usize) -> PathBuf {
        if order == self.first { run.into() } else { run.join(order_folder(order)) }
    }

    /// The file of the page of an order: in the folder of its files or, where a file was named, that one for the first order, and for
    /// others one beside it; the named one also for an order that is asked for alone.
    fn file(&self, run: &Path, args: &crate::cli::ReportArgs, order: usize) -> PathBuf {
        match &args.out {
            Some(file) if args.order.is_some() => file.clone(),
            Some(file) => self.named(file, order),
            None => self.folder(run, order).join(PAGE),
        }
    }

    /// A file that was named, as it is called for an order: `page.html`, `page-m3.html`.
    fn named(&self, file: &Path, order: usize) -> PathBuf {
        if order == self.first {
            return file.into();
        }
        let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
        let name = format!("{}-{}", part(file.file_stem()), order_folder(order));
        match file.extension() {
            Some(extension) => file.with_file_name(format!("{name}.{}", part(Some(extension)))),
            None => file.with_file_name(name),
        }
    }

    /// The pages of some of them as seen from that of one, in their folders or beside the file that was named; none where there is but
    /// one order.
    fn pages(&self, orders: &[usize], seen_from: usize, named: Option<&Path>) -> Vec<results::page::PageOfOrder> {
        let up = Path::new(if seen_from == self.first { "" } else { ".." });
        let file = |order| match named {
            Some(file) => link(&self.named(file, order)),
            None => self.folder(up, order).join(PAGE).display().to_string(),
        };
        let page = |&order: &usize| results::page::PageOfOrder {
            order,
            is_first: order == self.first,
            file: (order != seen_from).then(|| file(order)),
        };
        if self.further.is_empty() { Vec::new() } else { orders.iter().map(page).collect() }
    }
}

/// A file of the same folder as pages name it: what would be taken for a part of an address is written as such a one has it.
#[cfg(feature = "page")]
fn link(file: &Path) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    format!("./{}", name.replace('%', "%25").replace('#', "%23").replace('?', "%3F"))
}

/// Writes the page of one order of motions to a file, with these others beside it: its verdict and where the page is, and what is
/// missing.
#[cfg(feature = "page")]
fn page(
    reader: &Reader,
    args: &crate::cli::ReportArgs,
    file: &Path,
    beside: &[results::page::PageOfOrder],
) -> Result<(String, Omissions), Error> {
    use results::report::{Report, Selection};
    let _snapshot = reader.snapshot()?;
    let levels = chosen_levels(reader, args.levels.as_deref())?;
    let selection = levels.map_or(Selection::Fitting, Selection::Amplitudes);
    let report = Report::read_in(reader, &selection, args.units.unwrap_or_default())?;
    if let (None, Some(folder)) = (&args.out, file.parent()) {
        std::fs::create_dir_all(folder).map_err(Error::io(folder))?;
    }
    export::write_atomically(file, results::page::report(&report, beside).as_bytes())?;
    let width = crate::display::width();
    let answers = report.verdict.iter().map(|answer| answer.lines(width) + "\n\n");
    Ok((format!("{}{}\n", answers.collect::<String>(), file.display()), report.omissions))
}

/// The run as it is for one order of motions; `further`: those beside its first.
#[cfg(any(feature = "figures", feature = "page"))]
fn of_order(reader: Reader, further: &[usize], order: usize) -> Result<Reader, Error> {
    let first = reader.model()?.forcing_harmonic;
    if order == first {
        return Ok(reader);
    }
    if !further.contains(&order) {
        let orders: Vec<String> = std::iter::once(&first).chain(further).map(ToString::to_string).collect();
        return Err(Error::Usage(format!(
            "--order {order}: the run looks for motions of order {} (search.harmonics)",
            orders.join(", ")
        )));
    }
    Ok(reader.of_order(order)?)
}

/// Writes the page of several runs, and says what differs.
#[cfg(feature = "page")]
fn compare(args: &crate::cli::ReportArgs) -> Result<ExitCode, Error> {
    use results::compare::{Comparison, table};
    use results::report::{Report, Selection};
    let mut runs = Vec::new();
    for (name, reader) in of_this_order(opened(&args.runs)?, args.order)? {
        let _snapshot = reader.snapshot()?;
        let levels = chosen_levels(&reader, args.levels.as_deref())?;
        let selection = levels.map_or(Selection::Fitting, Selection::Amplitudes);
        runs.push((name, Report::read_in(&reader, &selection, args.units.unwrap_or_default())?));
    }
    let comparison = Comparison::new(runs);
    let file = args.out.clone().unwrap_or_else(|| args.runs[0].join("compare.html"));
    export::write_atomically(&file, results::page::compare(&comparison).as_bytes())?;
    let omissions: Vec<&Omissions> = comparison.reports.iter().map(|report| &report.omissions).collect();
    told_of_all(format_args!("{}{}\n", table(&comparison, crate::display::width()), file.display()), &omissions)
}

/// Runs with the names of their folders.
#[cfg(any(feature = "figures", feature = "page"))]
fn opened(folders: &[PathBuf]) -> Result<Vec<(String, Reader)>, Error> {
    let name = |folder: &PathBuf| folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned();
    folders.iter().map(|folder| Ok((name(folder), Reader::open(folder)?))).collect()
}

/// Runs as they are for one order of motions, by default their first, which has to be the same in all.
#[cfg(any(feature = "figures", feature = "page"))]
fn of_this_order(runs: Vec<(String, Reader)>, order: Option<usize>) -> Result<Vec<(String, Reader)>, Error> {
    let Some(order) = order else {
        let firsts = runs.iter().map(|(_, reader)| Ok(reader.model()?.forcing_harmonic));
        let firsts: Vec<usize> = firsts.collect::<Result<_, Error>>()?;
        return match firsts.iter().position(|first| *first != firsts[0]) {
            Some(other) => Err(Error::Usage(of_different_orders(&runs, &firsts, other)?)),
            None => Ok(runs),
        };
    };
    let of_order = |(name, reader): (String, Reader)| {
        let further = reader.further_orders()?;
        Ok((name, of_order(reader, &further, order)?))
    };
    runs.into_iter().map(of_order).collect()
}

/// What is said of runs whose first orders of motions differ: `firsts`, the first one's and that of the run at `other`.
#[cfg(any(feature = "figures", feature = "page"))]
fn of_different_orders(runs: &[(String, Reader)], firsts: &[usize], other: usize) -> Result<String, Error> {
    let of_run =
        |place: usize| format!("`{}` has motions of order {1} (forcing.harmonic = {1})", runs[place].0, firsts[place]);
    let orders = |place: usize| -> Result<Vec<usize>, Error> {
        Ok(std::iter::once(firsts[place]).chain(runs[place].1.further_orders()?).collect())
    };
    let all = (0..runs.len()).map(orders).collect::<Result<Vec<_>, _>>()?;
    let common = all[0].iter().copied().filter(|order| all.iter().all(|run| run.contains(order)));
    let common: Vec<String> = common.map(|order| order.to_string()).collect();
    let remedy = if common.is_empty() {
        "there is no order that all of them have, and they cannot be compared".into()
    } else {
        format!("with --order {} they can be compared", common.join(" or --order "))
    };
    let (first, second) = (of_run(0), of_run(other));
    Ok(format!("{first}, {second}: frequencies of the one are not those of the other; {remedy}"))
}

/// Draws a figure of a run, or of several.
#[cfg(feature = "figures")]
pub fn plot(args: &crate::cli::PlotArgs) -> Result<ExitCode, Error> {
    use results::plot::{FileFormat, Request, compose, compose_several};
    use results::summary_table::UnitChoice;
    let format = FileFormat::of(&args.out)?;
    let runs = of_this_order(opened(&args.runs)?, args.order)?;
    let own = UnitChoice::of_study(&runs[0].1.header()?.study);
    let units = args.units.unwrap_or_default().or(own);
    let request = Request {
        figure: args.figure,
        levels: chosen_levels(&runs[0].1, args.levels.as_deref())?,
        monitor: args.monitor.clone(),
        amplitude: args.amplitude.clone(),
        mode: args.mode,
        at: args.at.clone(),
        along: args.along,
        frequency: range(args.frequency.as_deref()),
        response: range(args.response.as_deref()),
        forcing: range(args.forcing.as_deref()),
        units,
    };
    let (sheet, omissions) = match &runs[..] {
        [(_, reader)] => compose(reader, &request).map(|(sheet, omissions)| (sheet, vec![omissions]))?,
        several => compose_several(several, &request)?,
    };
    let bytes = format.bytes(sheet.svg(args.width, args.height)?)?;
    export::write_atomically(&args.out, &bytes)?;
    told_of_all(format_args!("{}\n", args.out.display()), &omissions.iter().collect::<Vec<_>>())
}

/// Both ends of an axis, as typed.
#[cfg(feature = "figures")]
fn range(ends: Option<&[f64]>) -> Option<(f64, f64)> {
    ends.map(|ends| (ends[0], ends[1]))
}

/// The levels that `--levels` names, if it is given.
#[cfg(any(feature = "figures", feature = "page"))]
fn chosen_levels(reader: &Reader, list: Option<&str>) -> Result<Option<Vec<f64>>, Error> {
    let Some(list) = list else { return Ok(None) };
    let wanted = crate::study::typed("--levels", list).map_err(crate::study::StudyError::from)?;
    let wanted: Vec<f64> = wanted.into_iter().map(|amplitude| amplitude.value).collect();
    let mut stored = reader.header()?.amplitudes;
    stored.retain(|amplitude| amplitude.order().is_none());
    stored.sort_by(|a, b| a.value.total_cmp(&b.value));
    let known: Vec<(f64, &str)> = stored.iter().map(|amplitude| (amplitude.value, amplitude.text.as_str())).collect();
    let is_unknown = |value: &f64| !known.iter().any(|(level, _)| level == value);
    let unknown: Vec<f64> = wanted.iter().copied().filter(is_unknown).collect();
    if unknown.is_empty() {
        return Ok(Some(wanted));
    }
    let typed: Vec<String> = unknown.iter().map(f64::to_string).collect();
    let typed = typed.join(",");
    Err(Error::Usage(format!("--levels {typed}: the run has no such level, {}", instead(&unknown, &known))))
}
