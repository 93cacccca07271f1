//! The figure of a motion at any point of a branch.

use super::named::level;
use super::sheet::Sheet;
use crate::curves::{Curve, MarchedPeriod, largest, marched};
use crate::error::Error;
use crate::figure::{ColumnStore, motion_drawn, motion_marched, motion_template};
use crate::overview::{BranchRow, Omissions, Overview, verified_result};
use crate::report::Report;
use crate::store::Reader;
use crate::summary_table::FrequencyUnit;
use crate::words::digits;
use protocol::array::ArrayError;
use protocol::curve::Size;
use protocol::to_everyone::StoredResult;
use solver::formulation::state::State;
use solver::response::branch::BranchKind;
use solver::stability::multipliers::Verdict;

/// The figure, at `A/branch/index` or at the highest isola's peak; frequencies are written in `unit`.
pub fn sheet(
    report: &Report,
    reader: &Reader,
    monitor: usize,
    at: Option<&str>,
    unit: FrequencyUnit,
) -> Result<Sheet, Error> {
    let (row, amplitude, index) = match at {
        Some(text) => named(report, reader, text)?,
        None => highest(report)?,
    };
    let model = reader.verified_model()?.model().map_err(|error| reader.corrupt(error))?;
    let (result, curve) = stored(reader, row)?;
    let index = index.point(&curve, monitor)?;
    let motions = &report.motions;
    let motion = motions.at((0, index), &result, &Size::of(&model)).map_err(|error| reader.corrupt(error))?;
    let motion = motion.ok_or_else(|| Error::Usage(format!("--at: {} has no point {index}", curve.name)))?;
    let mut columns = ColumnStore::default();
    let mut figure = motion_drawn(motion_template(motions), motions, &motion.coefficients.values, &mut columns);
    let written = |omega: f64| digits(unit.factor() * omega, 6);
    let omega = written(curve.omega.values[index]);
    let states = states(&result, &Size::of(&model)).map_err(|error| reader.corrupt(error))?;
    let beside = match marched(motions, &model, (&states, curve.closed), index) {
        Ok(period) => {
            // What the run says of this point was looked at more closely.
            let known = reader.verification(&row.task)?.filter(|known| known.count == curve.size);
            let is_there = written(period.omega) == omega;
            let known = known.and_then(|known| known.verdicts().get(index).copied().flatten()).filter(|_| is_there);
            let known = known.filter(|known| matches!(known, Verdict::Stable | Verdict::Unstable | Verdict::Marginal));
            let period = MarchedPeriod { verdict: known.unwrap_or(period.verdict), ..period };
            figure = motion_marched(figure, motions, &period, &mut columns);
            match written(period.omega) {
                same if same == omega => "marched there".into(),
                other => format!("marched at {other} {unit}, for at this frequency time marching has no such motion"),
            }
        }
        Err(reason) => reason.to_string(),
    };
    // ω is in rad/s.
    let symbol = if unit == FrequencyUnit::Hertz { "f" } else { "ω" };
    figure.title = Some(format!("A = {amplitude}, {}, point {index}, {symbol} = {omega} {unit}; {beside}", curve.name));
    Ok(Sheet { figure, columns, choice: 0, frame: None })
}

/// The motions of a branch that a result holds; none without one.
fn states(result: &StoredResult, size: &Size) -> Result<Vec<State>, ArrayError> {
    let motions = result.branch.as_ref().map(|branch| &branch.points.motions);
    motions.map_or(Ok(Vec::new()), |motions| motions.states(size.channels, size.modes))
}

/// Where on a branch.
enum Index {
    Peak,
    Point(usize),
}

impl Index {
    fn point(&self, curve: &Curve, monitor: usize) -> Result<usize, Error> {
        let amplitude = &curve.amplitude[monitor].values;
        match *self {
            Self::Peak => Ok(largest(amplitude)),
            Self::Point(index) if index < curve.size => Ok(index),
            Self::Point(index) => {
                let last = curve.size.saturating_sub(1);
                Err(Error::Usage(format!("--at: {} has no point {index}, but 0 to {last}, or peak", curve.name)))
            }
        }
    }
}

/// The point that `A/branch/index` names, with its forcing amplitude as typed in the study.
fn named<'s>(report: &'s Report, reader: &Reader, text: &str) -> Result<(&'s BranchRow, &'s str, Index), Error> {
    let usage =
        || Error::Usage(format!("--at {text}: write A/branch/index, like \"20/isola 1/43\" or \"20/main/peak\""));
    let parts: Vec<&str> = text.split('/').map(str::trim).collect();
    let (amplitude, branch, index) = match parts[..] {
        [amplitude, branch] => (amplitude, branch, "peak"),
        [amplitude, branch, index] => (amplitude, branch, index),
        _ => return Err(usage()),
    };
    let summary = &report.overview.levels[level(&report.overview.levels, "--at", amplitude)?];
    let names: Vec<String> = summary.branches.iter().map(BranchRow::name).collect();
    let known = if names.is_empty() { "nothing yet".into() } else { names.join(", ") };
    let unknown = || {
        let other = of_another_order(reader, (amplitude, branch));
        let other = other.map_or_else(String::new, |order| format!("; there is one of order {order}: --order {order}"));
        Error::Usage(format!("--at {text}: A = {} has no such branch, but {known}{other}", summary.amplitude))
    };
    let row = summary.branches.iter().find(|row| row.name() == branch).ok_or_else(unknown)?;
    let index = match index {
        "peak" => Index::Peak,
        digits => Index::Point(digits.parse().map_err(|_| usage())?),
    };
    Ok((row, &summary.amplitude, index))
}

/// Another order of motions of the run that has a branch, given by its level and name.
fn of_another_order(reader: &Reader, (amplitude, branch): (&str, &str)) -> Option<usize> {
    let first = Reader::open(reader.dir()).ok()?;
    let own = first.model().ok()?.forcing_harmonic;
    let further = first.further_orders().ok()?;
    let has_it = |order: usize| {
        let other = if order == own { Reader::open(reader.dir()) } else { first.of_order(order) };
        let overview = Overview::read(&other.ok()?, &mut Omissions::default()).ok()?;
        let place = level(&overview.levels, "--at", amplitude).ok()?;
        overview.levels[place].branches.iter().any(|row| row.name() == branch).then_some(order)
    };
    let told_of = reader.order().unwrap_or(own);
    std::iter::once(own).chain(further).filter(|order| *order != told_of).find_map(has_it)
}

/// The highest isola, else the highest branch that does not leave through both ends of the frequencies, else the highest of all.
fn highest(report: &Report) -> Result<(&BranchRow, &str, Index), Error> {
    let all = || {
        report.overview.levels.iter().flat_map(|level| level.branches.iter().map(|row| (row, level.amplitude.as_str())))
    };
    let by_amplitude = |a: &(&BranchRow, &str), b: &(&BranchRow, &str)| a.0.amplitude_max.total_cmp(&b.0.amplitude_max);
    let isola = all().filter(|(row, _)| row.is_isola()).max_by(by_amplitude);
    let (row, amplitude) = isola
        .or_else(|| all().filter(|(row, _)| row.kind != BranchKind::Open.name()).max_by(by_amplitude))
        .or_else(|| all().max_by(by_amplitude))
        .ok_or_else(|| Error::Other("nothing to draw: no branch has been computed yet".into()))?;
    Ok((row, amplitude, Index::Peak))
}

fn stored(reader: &Reader, row: &BranchRow) -> Result<(StoredResult, Curve), Error> {
    let result = verified_result(reader, row).map_err(|error| reader.corrupt(error))?;
    let curve = Curve::of(&result, 0).map_err(|error| reader.corrupt(error))?;
    let curve = curve.ok_or_else(|| reader.corrupt(format!("the branch of task {} is missing", row.task)))?;
    Ok((result, curve))
}
