//! Columns: what is known of every point of a curve besides its motion.
//!
//! Two lists: what points of any curve have, and what points of a backbone have besides. Everything that carries, stores,
//! writes or shows columns follows them. Columns are added at the end and are later ([`Column::later`]), as results of before
//! do not have them.

use crate::curve::continuation::CurvePoint;
use crate::formulation::aft::Aft;
use crate::formulation::harmonics::{rms, width};
use crate::formulation::state::State;
pub use crate::response::column::{Axis, Column, Csv, Hover, Number};
use crate::response::melnikov::Energies;
use crate::settings::Criterion;
use crate::structure::Model;
use serde::{Deserialize, Serialize};

/// A converged point of a curve, as its columns are computed from it.
struct Converged<'p> {
    /// The structure.
    model: &'p Model,
    /// Frequency–time work space of the curve's truncation.
    aft: &'p mut Aft,
    /// Where Newton's method ended.
    curve: &'p CurvePoint,
    /// The motion there.
    state: &'p State,
    /// Displacements of the monitored dofs, m.
    monitored: Vec<Vec<f64>>,
}

/// A column of points of any curve.
struct PointColumn {
    column: Column,
    compute: fn(&mut Converged<'_>) -> Vec<f64>,
}

/// What points of any curve have, in the order of the wire.
static POINTS: [PointColumn; 6] = [
    PointColumn {
        column: Column::new("amplitude", "m", Axis::Monitors, "largest |x| over the period")
            .hover("amplitude", 5)
            .csv(Csv::Every("amplitude"), Csv::One),
        compute: |at| at.monitored.iter().map(|series| at.aft.max_abs(series)).collect(),
    },
    PointColumn {
        column: Column::new("rms", "m", Axis::Monitors, "root mean square over the period")
            .hover("rms", 5)
            .csv(Csv::One, Csv::No),
        compute: |at| at.monitored.iter().map(|series| rms(series)).collect(),
    },
    PointColumn {
        column: Column::new("contact", "", Axis::Contacts, "share of the period in contact")
            .percentage("in contact", 3)
            .csv(Csv::One, Csv::No),
        compute: contact,
    },
    PointColumn {
        column: Column::new("residual", "", Axis::Point, "largest scaled residual")
            .hover("residual", 2)
            .csv(Csv::One, Csv::No),
        compute: |at| vec![at.curve.residual],
    },
    PointColumn {
        column: Column::new("high_harmonics", "", Axis::Point, "share of the two highest harmonics in the motion")
            .hover("highest harmonics", 2)
            .csv(Csv::One, Csv::No),
        compute: |at| vec![high_harmonics(at.state)],
    },
    PointColumn {
        column: Column::new("iterations", "", Axis::Point, "Newton iterations")
            .of_integers()
            .hover("Newton iterations", 3),
        compute: |at| vec![at.curve.iterations as f64],
    },
];

/// Share of the period in contact, per contact element.
fn contact(at: &mut Converged<'_>) -> Vec<f64> {
    let nc = width(at.state.harmonics);
    let pressure = |first: usize| &at.state.arguments[first * nc..(first + 1) * nc];
    let mut share = |first| at.aft.coverage(pressure(first), 0.0).fraction();
    at.model.contacts().map(|contact| share(contact.first)).collect()
}

/// Share of the two highest harmonics in the norm of the modal amplitudes.
fn high_harmonics(state: &State) -> f64 {
    let nc = width(state.harmonics);
    let energy =
        |from: usize| -> f64 { state.modal.chunks(nc).flat_map(|series| &series[from..]).map(|c| c * c).sum() };
    let high = if state.harmonics >= 2 { energy(nc - 4) / energy(0) } else { 1.0 };
    if high.is_finite() { high.sqrt() } else { 0.0 }
}

/// A converged point of a backbone, as its columns are computed from it.
pub(super) struct OnBackbone<'p> {
    /// Frequency–time work space of the curve's truncation.
    pub aft: &'p mut Aft,
    /// Its motion.
    pub state: &'p State,
    /// Energy balance there.
    pub energies: Energies,
    /// What the threshold is.
    pub criterion: Criterion,
    /// Scaled arc length from the first point.
    pub arc: f64,
    /// Piece it belongs to, from 0.
    pub piece: usize,
}

/// A column that a backbone has besides.
struct BackboneColumn {
    column: Column,
    compute: fn(&mut OnBackbone<'_>) -> Vec<f64>,
}

/// What points of a backbone have besides, in the order of the wire.
static BACKBONE: [BackboneColumn; 8] = [
    BackboneColumn {
        column: Column::new("r_lin", "J a period", Axis::Point, "work of the linear damping")
            .hover("R_lin", 4)
            .csv(Csv::No, Csv::One),
        compute: |at| vec![at.energies.linear],
    },
    BackboneColumn {
        column: Column::new("r_nl", "J a period", Axis::Point, "work of the nonlinear elements")
            .hover("R_nl", 4)
            .csv(Csv::No, Csv::One),
        compute: |at| vec![at.energies.nonlinear],
    },
    BackboneColumn {
        column: Column::new(
            "work_per_amplitude",
            "J a period",
            Axis::Point,
            "largest work of the forcing per unit of A",
        )
        .csv(Csv::No, Csv::One),
        compute: |at| vec![at.energies.work_per_amplitude],
    },
    BackboneColumn {
        column: Column::new("certificate", "", Axis::Point, "relative error of the energy balance")
            .hover("energy certificate", 2),
        compute: |at| vec![at.energies.certificate],
    },
    BackboneColumn {
        column: Column::new(
            "threshold",
            "",
            Axis::Point,
            "threshold A*: forced responses are predicted for A > A*; infinite where the forcing does no work",
        )
        .hover("threshold A*", 4)
        .csv(Csv::No, Csv::One),
        compute: |at| vec![at.energies.threshold(at.criterion)],
    },
    BackboneColumn { column: Column::new("arc", "", Axis::Point, "scaled arc length"), compute: |at| vec![at.arc] },
    BackboneColumn {
        column: Column::new("contributions", "", Axis::Modes, "modal contributions, summing to 1")
            .csv(Csv::No, Csv::Every("contribution")),
        compute: contributions,
    },
    BackboneColumn {
        column: Column::new(
            "piece",
            "",
            Axis::Point,
            "piece of the backbone: 0 grows out of the linear mode, others cross it, or each other, or go on beyond a tongue",
        )
        .of_integers()
        .csv(Csv::No, Csv::One)
        .later(),
        compute: |at| vec![at.piece as f64],
    },
];

/// Share of each mode: max |γ_j(t)| over a period, γ_j = Φ_jᵀ M x, divided by their sum (paper [35, 36]).
fn contributions(at: &mut OnBackbone<'_>) -> Vec<f64> {
    shares(at.aft, at.state)
}

/// Largest amplitude of each mode in a motion over the sum of all.
pub(super) fn shares(aft: &mut Aft, state: &State) -> Vec<f64> {
    let nc = width(state.harmonics);
    let maxima: Vec<f64> = state.modal.chunks(nc).map(|series| aft.max_abs(series)).collect();
    let sum: f64 = maxima.iter().sum();
    maxima.iter().map(|maximum| maximum / sum).collect()
}

/// Columns of points of any curve, in the order of the wire.
pub fn of_points() -> impl ExactSizeIterator<Item = &'static Column> + Clone {
    POINTS.iter().map(|entry| &entry.column)
}

/// Columns that a backbone has besides, in the order of the wire.
pub fn of_backbone() -> impl ExactSizeIterator<Item = &'static Column> + Clone {
    BACKBONE.iter().map(|entry| &entry.column)
}

/// The column of this name, of either list.
pub fn named(name: &str) -> Option<&'static Column> {
    of_points().chain(of_backbone()).find(|column| column.name == name)
}

/// Columns that a backbone has besides, in the order of tables and files: there the threshold has its place before the
/// certificate.
pub fn of_backbone_in_files() -> impl Iterator<Item = &'static Column> + Clone {
    let place = |i: usize| match i {
        CERTIFICATE => THRESHOLD,
        THRESHOLD => CERTIFICATE,
        i => i,
    };
    (0..BACKBONE.len()).map(move |i| &BACKBONE[place(i)].column)
}

/// The values of a point, by place in the list of its columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row(Vec<Option<Vec<f64>>>);

impl Row {
    /// Of values in the order of the list; `None`: there are none, of a column that was added later.
    pub fn new(values: Vec<Option<Vec<f64>>>) -> Self {
        Self(values)
    }

    /// Of a converged point of any curve.
    pub(super) fn of_point(model: &Model, aft: &mut Aft, curve: &CurvePoint, state: &State) -> Self {
        let displacement = |&dof: &usize| state.displacement(model, dof);
        let monitored = model.monitors().iter().map(displacement).collect();
        let mut at = Converged { model, aft, curve, state, monitored };
        Self(POINTS.iter().map(|entry| Some((entry.compute)(&mut at))).collect())
    }

    /// Of a converged point of a backbone.
    pub(super) fn of_backbone(mut at: OnBackbone<'_>) -> Self {
        Self(BACKBONE.iter().map(|entry| Some((entry.compute)(&mut at))).collect())
    }

    /// The values at a place of the list; `None` if there are none.
    pub fn get(&self, place: usize) -> Option<&[f64]> {
        self.0.get(place)?.as_deref()
    }

    /// The values of a column that every point has; none if it is not there.
    pub(super) fn all(&self, place: usize) -> &[f64] {
        self.get(place).unwrap_or_default()
    }

    /// The value of a column that every point has; NaN if it is not there.
    pub(super) fn first(&self, place: usize) -> f64 {
        self.all(place).first().copied().unwrap_or(f64::NAN)
    }
}

const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

/// Places of columns that the numerics use: a name that is not in the list does not compile.
macro_rules! places {
    ($($list:ident: $($place:ident = $name:literal),+;)+) => {
        $($(pub(super) const $place: usize = {
            let mut place = 0;
            while !is_same($list[place].column.name, $name) {
                place += 1;
            }
            place
        };)+)+
    };
}

places! {
    POINTS: AMPLITUDE = "amplitude", CONTACT = "contact", RESIDUAL = "residual";
    BACKBONE: R_LIN = "r_lin", R_NL = "r_nl", WORK = "work_per_amplitude", CERTIFICATE = "certificate",
        THRESHOLD = "threshold", ARC = "arc", CONTRIBUTIONS = "contributions", PIECE = "piece";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_and_each_has_its_place_in_files() {
        let names: Vec<&str> = of_points().chain(of_backbone()).map(|column| column.name).collect();
        for (i, name) in names.iter().enumerate() {
            assert!(!names[..i].contains(name), "{name}");
            assert_eq!(named(name).map(|column| column.name), Some(*name));
        }
        let first: Vec<&str> = of_backbone_in_files().map(|column| column.name).take(7).collect();
        let expected = ["r_lin", "r_nl", "work_per_amplitude", "threshold", "certificate", "arc", "contributions"];
        assert_eq!(first, expected);
        assert_eq!(of_backbone_in_files().count(), of_backbone().len());
    }
}
