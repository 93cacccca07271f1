//! Points of a curve as columns of a CSV file. Which there are follows from the list of the solver.

use super::ExportError;
use super::table::{Table, optional, text};
use crate::store::{Scalar, Scalars, scalars, verdict_name};
use protocol::array::{Array, ArrayError};
use protocol::backbone::BackboneMessage;
use protocol::branch::BranchMessage;
use solver::response::columns::{self, Axis, Column, Csv};
use solver::stability::verification::Verification;
use std::path::Path;

/// The column of the mode that a backbone is of.
const MODE: &str = "mode";

/// Columns: names and cells.
#[derive(Default)]
pub(super) struct CsvColumns(Vec<(String, Vec<String>)>);

/// How numbers are written.
type Cell = fn(f64) -> String;

/// A number, nothing if there is none.
fn blank(value: f64) -> String {
    optional(Some(value).filter(|value| !value.is_nan()))
}

impl CsvColumns {
    /// Of the points of a branch: what the first programs had, every further monitored dof by its name, what came later.
    pub fn of_branch(branch: &BranchMessage, monitors: Option<&[String]>) -> Result<Self, ArrayError> {
        let Scalars { omega, columns } = Scalars::new(&branch.points)?;
        let name =
            |i: usize| monitors.and_then(|names| names.get(i)).map_or_else(|| (i + 1).to_string(), String::clone);
        let mut csv = Self::default();
        csv.add("omega", &omega, blank);
        for is_later in [false, true] {
            csv.ones(&columns, |column| column.branch_csv, is_later, blank);
            let arrays = branch.points.columns.among(columns::of_points());
            csv.others(arrays, |column| column.branch_csv, is_later, name)?;
        }
        Ok(csv)
    }

    /// With what marching says of the points, nothing where they were not verified: whether the response there is stable, and
    /// the largest modulus of its multipliers.
    pub fn with_stability(mut self, verified: Option<&Verification>) -> Self {
        let count = self.0.first().map_or(0, |(_, cells)| cells.len());
        let verified = verified.filter(|verified| verified.count == count);
        let verdicts = verified.map_or_else(|| vec![None; count], Verification::verdicts);
        let moduli = verified.map_or_else(|| vec![None; count], Verification::moduli);
        let words = verdicts.into_iter().map(|verdict| verdict.map_or("", verdict_name).to_string());
        self.0.push(("stable".into(), words.collect()));
        self.0.push(("multiplier".into(), moduli.into_iter().map(optional).collect()));
        self
    }

    /// Of the points of backbones, one after the other, with the mode that each is of, from 1, at the end.
    pub fn of_backbones(backbones: &[&BackboneMessage]) -> Result<Self, ArrayError> {
        let mut all = Self::default();
        for backbone in backbones {
            let mut one = Self::of_backbone(backbone)?;
            one.0.push((MODE.into(), vec![(backbone.mode + 1).to_string(); backbone.points.len()]));
            if all.0.is_empty() {
                all = one;
                continue;
            }
            // Of one model and one program: the columns are the same.
            for (column, (_, cells)) in all.0.iter_mut().zip(one.0) {
                column.1.extend(cells);
            }
        }
        Ok(all)
    }

    /// Of the points of a backbone: what the first programs had, every mode by its number, what came later.
    fn of_backbone(backbone: &BackboneMessage) -> Result<Self, ArrayError> {
        let count = backbone.points.len();
        let Scalars { omega, mut columns } = Scalars::new(&backbone.points)?;
        columns.append(&mut scalars(&backbone.columns, columns::of_backbone_in_files(), count)?);
        let mut csv = Self::default();
        csv.add("omega", &omega, text);
        csv.add("zeta", &backbone.points.motions.decay.values("decay", &[count])?, text);
        for is_later in [false, true] {
            csv.ones(&columns, |column| column.backbone_csv, is_later, if is_later { blank } else { text });
            let arrays = backbone.points.columns.among(columns::of_points());
            let arrays = arrays.chain(backbone.columns.among(columns::of_backbone_in_files()));
            csv.others(arrays, |column| column.backbone_csv, is_later, |i| (i + 1).to_string())?;
        }
        Ok(csv)
    }

    /// Of a backbone that there is not yet: names alone, and none for modes, whose number is not known.
    pub fn without_backbone() -> Self {
        let list = || columns::of_points().chain(columns::of_backbone_in_files());
        let with_one = |column: &&Column| column.backbone_csv != Csv::No && column.axis != Axis::Modes;
        let listed = [false, true].map(|is_later| list().filter(with_one).filter(move |c| c.is_later == is_later));
        let names = ["omega", "zeta"].into_iter().chain(listed.into_iter().flatten().map(|column| column.name));
        let names = names.chain([MODE]);
        Self(names.map(|name| (name.to_string(), Vec::new())).collect())
    }

    fn add(&mut self, name: impl Into<String>, values: &[f64], cell: Cell) {
        self.0.push((name.into(), values.iter().map(|&value| cell(value)).collect()));
    }

    /// Adds the columns with one number a row.
    fn ones(&mut self, scalars: &[Scalar], csv: fn(&Column) -> Csv, is_later: bool, cell: Cell) {
        for Scalar { column, values } in scalars {
            if column.is_later == is_later && csv(column) != Csv::No {
                self.add(column.name, values, cell);
            }
        }
    }

    /// Adds what there is of every mode, and of every monitored dof after the first one.
    fn others<'a>(
        &mut self,
        arrays: impl Iterator<Item = (&'static Column, &'a Array)>,
        csv: fn(&Column) -> Csv,
        is_later: bool,
        name: impl Fn(usize) -> String,
    ) -> Result<(), ArrayError> {
        for (column, array) in arrays.filter(|(column, _)| column.is_later == is_later) {
            let Csv::Every(prefix) = csv(column) else { continue };
            let width = array.shape.get(1).copied().unwrap_or(0);
            let values = array.values(column.name, &[array.len(), width])?;
            for i in usize::from(column.axis != Axis::Modes)..width {
                let one: Vec<f64> = values.iter().skip(i).step_by(width).copied().collect();
                self.add(format!("{prefix}_{}", name(i)), &one, text);
            }
        }
        Ok(())
    }

    /// Writes them as `name` in folder `dir`.
    pub fn write(self, dir: &Path, name: &str) -> Result<(), ExportError> {
        let names: Vec<String> = self.0.iter().map(|(name, _)| name.clone()).collect();
        let mut table = Table::create(dir, name, &names)?;
        for i in 0..self.0.first().map_or(0, |(_, cells)| cells.len()) {
            table.row(self.0.iter().map(|(_, cells)| &cells[i]))?;
        }
        table.finish()
    }
}
