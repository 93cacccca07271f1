//! Whether what somebody else has computed solves the equations: evaluated again at a few points, in a thousandth of the time
//! that finding it took.
//!
//! A point solves them if its scaled residual is as small as Newton's method leaves it, if the entries of its state that follow
//! from others do, and if its columns are those of its motion. Checked are the ends of a curve, its special points, the points
//! that its range and its peak are told by, and some that are drawn.

use crate::curve::continuation::CurvePoint;
use crate::curve::problem::Problem;
use crate::formulation::Formulation;
use crate::formulation::pressure::PressureForm;
use crate::formulation::scales::Scales;
use crate::formulation::state::State;
use crate::formulation::unknown::Unknown;
use crate::response::branch::{Branch, BranchKind, BranchPoint, SpecialKind};
use crate::response::certificate::Certificate;
use crate::response::columns::{self, Row};
use crate::response::critical::CriticalCurve;
use crate::response::orders::Shorter;
use crate::response::seeds::Landing;
use crate::settings::Settings;
use crate::structure::Model;
use std::collections::BTreeSet;
use thiserror::Error;

/// Points drawn beside those that are always checked.
const DRAWN: usize = 2;

/// Most special points, or landings, that are checked; which of more is drawn.
const MOST: usize = 6;

/// A residual may be this many times what Newton's method leaves: other processors round differently, and the last step of a
/// method that converges need not be the same.
const SLACK: f64 = 1e3;

/// Largest difference of entries that follow from others, relative to the largest entry: what a residual of that size leaves
/// of an amplitude close to a lightly damped resonance.
const FOLLOWING: f64 = 1e-6;

/// Largest difference of a column from that of the motion, relative to the larger of both and 1: a share of a period in
/// contact varies like the square root of a pressure where that touches zero.
const COLUMN: f64 = 1e-6;

/// Columns that tell how a point was found, not what it is.
const OF_THE_WAY: [&str; 2] = ["residual", "iterations"];

/// Why something is no solution.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Refutation {
    /// Nothing to check.
    #[error("there is no point")]
    Empty,
    /// A forcing amplitude that is not the one of the task.
    #[error("point {point} is at the forcing amplitude {forcing}, not at {expected}")]
    Forcing {
        /// Number of the point.
        point: usize,
        /// Its forcing amplitude.
        forcing: f64,
        /// The one asked for.
        expected: f64,
    },
    /// Not a forced response.
    #[error("point {point} is no forced response: it decays, or has no frequency")]
    Motion {
        /// Number of the point.
        point: usize,
    },
    /// A motion of an earlier order.
    #[error("point {point} repeats itself after fewer periods of the force, as motions of an earlier order do")]
    Shorter {
        /// Number of the point.
        point: usize,
    },
    /// Numbers that are none.
    #[error("`{column}` of point {point} is not finite")]
    NotFinite {
        /// Column.
        column: &'static str,
        /// Number of the point.
        point: usize,
    },
    /// The equations do not hold.
    #[error("point {point} does not solve the equations: its scaled residual is {residual:.1e}, above {limit:.1e}")]
    Residual {
        /// Number of the point.
        point: usize,
        /// Largest scaled residual.
        residual: f64,
        /// What it may be.
        limit: f64,
    },
    /// Entries of a state that follow from others do not.
    #[error("point {point} contradicts itself: what follows from its forces differs by {difference:.1e}")]
    Following {
        /// Number of the point.
        point: usize,
        /// Largest difference, relative to the largest entry.
        difference: f64,
    },
    /// A column that is not that of the motion.
    #[error("`{column}` of point {point} is not that of its motion")]
    Column {
        /// Column.
        column: &'static str,
        /// Number of the point.
        point: usize,
    },
    /// A fold that does not turn back, or a peak that is not the highest point.
    #[error("point {point} is no {kind}")]
    Special {
        /// Number of the point.
        point: usize,
        /// What it was said to be.
        kind: &'static str,
    },
    /// What is said of the whole cannot be.
    #[error("{0}")]
    Whole(&'static str),
}

/// Checks what others have computed of a model.
#[derive(Debug, Clone, Copy)]
pub struct Recheck<'m> {
    model: &'m Model,
    settings: &'m Settings,
    /// What points are drawn by.
    draw: u64,
}

impl<'m> Recheck<'m> {
    /// Of a model by these settings; `draw`: which points are drawn. Whoever computes should not know it.
    pub fn new(model: &'m Model, settings: &'m Settings, draw: u64) -> Self {
        Self { model, settings, draw }
    }

    /// Whether a branch is one at this forcing amplitude.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn branch(&self, branch: &Branch, forcing: f64) -> Result<(), Refutation> {
        let points = &branch.points;
        let states = points.iter().map(|point| &point.state);
        if !is_same(branch.forcing, forcing) {
            return Err(Refutation::Forcing { point: 0, forcing: branch.forcing, expected: forcing });
        }
        self.forced(states, forcing)?;
        finite(points)?;
        if match branch.kind {
            BranchKind::Isola => !branch.is_closed(),
            BranchKind::Branched => false,
            _ => branch.is_closed(),
        } {
            return Err(Refutation::Whole("an isola is closed, and a closed branch an isola or branched"));
        }
        if !is_finite(&branch.certificate) {
            return Err(Refutation::Whole("what is said of the harmonics left out is not finite"));
        }
        special(branch)?;
        let listed = branch.special.iter().map(|special| special.index);
        let mut problem = self.problem(Unknown::Frequency { forcing });
        self.chosen(points, listed).into_iter().try_for_each(|point| self.solves(&mut problem, points, point))
    }

    /// Whether responses that seeds landed on are some at this forcing amplitude.
    ///
    /// # Errors
    /// What is wrong with one of them.
    pub fn landings(&self, landings: &[Landing], forcing: f64) -> Result<(), Refutation> {
        let states: Vec<&State> = landings.iter().map(|landing| &landing.state).collect();
        self.forced(states.iter().copied(), forcing)?;
        let shorter = Shorter::of(self.model, self.settings.search.harmonics.as_ref());
        if let Some(point) = states.iter().position(|state| shorter.has(state)) {
            return Err(Refutation::Shorter { point });
        }
        let mut problem = self.problem(Unknown::Frequency { forcing });
        let chosen = self.some_of((0..states.len()).collect(), MOST);
        chosen.into_iter().try_for_each(|point| self.state_solves(&mut problem, states[point], point))
    }

    /// Whether the points of a curve over the forcing amplitude are some: by the balance and by the condition that makes them
    /// extrema, or at one frequency. At a corner that has no derivative; it is left to the points beside it.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn curve(&self, curve: &CriticalCurve) -> Result<(), Refutation> {
        let points = &curve.points;
        if points.is_empty() {
            return Err(Refutation::Empty);
        }
        finite(points)?;
        if let Some(point) = points.iter().position(|point| !is_response(&point.state)) {
            return Err(Refutation::Motion { point });
        }
        let listed = curve.events.iter().map(|event| event.index);
        let mut chosen = self.chosen(points, listed);
        chosen.retain(|index| curve.corners.iter().all(|corner| corner.index != *index));
        let unknown = match curve.quantity {
            Some(quantity) => Unknown::Extremum(quantity),
            None => Unknown::Forcing { omega: points[0].omega() },
        };
        if curve.quantity.is_none() {
            if points.iter().any(|point| point.omega() != points[0].omega()) {
                return Err(Refutation::Whole("its points are to be at one frequency, and are not"));
            }
            if !curve.events.is_empty() {
                return Err(Refutation::Whole("nothing is born or merges along responses at one frequency"));
            }
        }
        let scales = Scales::new(self.model, self.settings.tracked(self.model));
        let problem = PressureForm::build(
            self.model,
            self.settings.harmonics,
            self.settings.tracked(self.model),
            unknown,
            scales,
        );
        let Ok(mut problem) = problem else {
            return Err(Refutation::Whole(
                "the laws of this model have no second derivatives, so that it has no such curve",
            ));
        };
        let highest = curve.forcing_range().1;
        problem.measure_forcing_by(highest.max(scales.forcing));
        chosen.into_iter().try_for_each(|point| self.solves(&mut problem, points, point))
    }

    fn problem(&self, unknown: Unknown) -> PressureForm<'m> {
        let scales = Scales::new(self.model, self.settings.tracked(self.model));
        PressureForm::new(self.model, self.settings.harmonics, self.settings.tracked(self.model), unknown, scales)
    }

    /// Whether all are forced responses at this forcing amplitude, as far as that is seen without the equations.
    fn forced<'s>(&self, states: impl Iterator<Item = &'s State>, forcing: f64) -> Result<(), Refutation> {
        let mut count = 0;
        for (point, state) in states.enumerate() {
            if !is_same(state.forcing, forcing) {
                return Err(Refutation::Forcing { point, forcing: state.forcing, expected: forcing });
            }
            if !is_response(state) {
                return Err(Refutation::Motion { point });
            }
            count += 1;
        }
        if count == 0 { Err(Refutation::Empty) } else { Ok(()) }
    }

    /// The points that are checked: both ends, the lowest and the highest frequency, the largest amplitude, some of those listed
    /// and some that are drawn.
    fn chosen(&self, points: &[BranchPoint], listed: impl Iterator<Item = usize>) -> BTreeSet<usize> {
        let count = points.len();
        let extreme = |of: fn(&BranchPoint) -> f64| {
            (0..count).max_by(|&a, &b| of(&points[a]).total_cmp(&of(&points[b]))).unwrap_or_default()
        };
        let mut chosen: BTreeSet<usize> = self.some_of(listed.filter(|&index| index < count).collect(), MOST);
        chosen.extend([0, count - 1, extreme(BranchPoint::omega), extreme(|point| -point.omega())]);
        chosen.insert(extreme(BranchPoint::amplitude));
        chosen.extend((0..DRAWN).map(|number| drawn(self.draw, number, count)));
        chosen
    }

    /// So many of these at most, drawn.
    fn some_of(&self, mut list: Vec<usize>, most: usize) -> BTreeSet<usize> {
        for number in 0..list.len().min(most) {
            let other = number + drawn(self.draw, number, list.len() - number);
            list.swap(number, other);
        }
        list.into_iter().take(most).collect()
    }

    /// Whether a point solves the equations of a problem, and its columns are those of its motion.
    fn solves(&self, problem: &mut PressureForm<'m>, points: &[BranchPoint], point: usize) -> Result<(), Refutation> {
        let BranchPoint { state, values } = &points[point];
        self.state_solves(problem, state, point)?;
        let curve = CurvePoint {
            y: Vec::new(),
            tangent: Vec::new(),
            iterations: 0,
            factorisations: 0,
            residual: 0.0,
            orientation: 0.0,
            step: 0.0,
        };
        let own = Row::of_point(self.model, problem.aft(), &curve, state);
        let listed = columns::of_points().enumerate().filter(|(_, column)| !OF_THE_WAY.contains(&column.name));
        for (place, column) in listed {
            let (Some(told), Some(own)) = (values.get(place), own.get(place)) else { continue };
            let is_close = |(a, b): (&f64, &f64)| (a - b).abs() <= COLUMN * scale(column.unit, *a, *b);
            if told.len() != own.len() || !told.iter().zip(own).all(is_close) {
                return Err(Refutation::Column { column: column.name, point });
            }
        }
        Ok(())
    }

    /// Whether a state solves the equations of a problem.
    fn state_solves(&self, problem: &mut PressureForm<'m>, state: &State, point: usize) -> Result<(), Refutation> {
        let given = problem.encode(state);
        let mut completed = given.clone();
        let residual = problem.linearise(&mut completed);
        let tolerance = self.settings.continuation.newton.tolerance;
        // What rounding leaves is asked of few points: it takes receptances of all harmonics.
        if residual > SLACK * tolerance || residual.is_nan() {
            let limit = SLACK * tolerance.max(problem.rounding());
            if residual > limit || residual.is_nan() {
                return Err(Refutation::Residual { point, residual, limit });
            }
        }
        let motion = problem.motion_metric().len();
        let largest = given[..motion].iter().fold(0.0f64, |most, entry| most.max(entry.abs()));
        let changes = given[..motion].iter().zip(&completed).map(|(given, completed)| (given - completed).abs());
        let difference = changes.fold(0.0f64, f64::max) / largest.max(f64::MIN_POSITIVE);
        if difference > FOLLOWING { Err(Refutation::Following { point, difference }) } else { Ok(()) }
    }
}

/// What a difference of two values is measured by: shares by 1, sizes by themselves.
fn scale(unit: &str, a: f64, b: f64) -> f64 {
    let size = a.abs().max(b.abs());
    if unit.is_empty() { size.max(1.0) } else { size }
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

fn is_response(state: &State) -> bool {
    state.decay == 0.0 && state.omega > 0.0 && state.omega.is_finite()
}

fn is_finite(certificate: &Certificate) -> bool {
    let Certificate { penetration, pressure_beyond, doubled, elsewhere, contact_omega, slowest_sliding } = certificate;
    let range = doubled.and_then(|doubled| doubled.range).map(|(low, high)| [low, high]);
    let doubled = doubled.map(|doubled| [doubled.amplitude, doubled.shift]);
    let elsewhere = elsewhere.map(|change| [change.omega, change.share.unwrap_or_default()]);
    let contact = contact_omega.map(|(low, high)| [low, high]);
    let pairs = [doubled, range, elsewhere, contact].into_iter().flatten().flatten();
    [*penetration, *pressure_beyond, *slowest_sliding].into_iter().flatten().chain(pairs).all(f64::is_finite)
}

/// Whether every column of every point is finite.
fn finite(points: &[BranchPoint]) -> Result<(), Refutation> {
    for (point, values) in points.iter().map(|point| &point.values).enumerate() {
        for (place, column) in columns::of_points().enumerate() {
            if !values.get(place).unwrap_or_default().iter().all(|value| value.is_finite()) {
                return Err(Refutation::NotFinite { column: column.name, point });
            }
        }
    }
    Ok(())
}

/// Whether folds turn back and the peak is the highest point. At an end of an open branch nothing is known of that.
fn special(branch: &Branch) -> Result<(), Refutation> {
    let (points, count) = (&branch.points, branch.points.len());
    let omega = |index: usize| points[index % count].omega();
    for special in &branch.special {
        let index = special.index;
        let refuted = |kind| Err(Refutation::Special { point: index, kind });
        match special.kind {
            SpecialKind::Start | SpecialKind::BranchPoint => {}
            SpecialKind::Peak if points[index].amplitude() < branch.peak().amplitude() => return refuted("peak"),
            SpecialKind::Peak => {}
            SpecialKind::Fold if !branch.is_closed() && (index == 0 || index + 1 == count) => {}
            SpecialKind::Fold => {
                let [before, after] = [omega(index + count - 1), omega(index + 1)].map(|other| omega(index) - other);
                if before * after < 0.0 && before.abs().min(after.abs()) > TURN * omega(index) {
                    return refuted("fold");
                }
            }
        }
    }
    Ok(())
}

/// A fold is located to this share of its frequency: neighbours may be off its height by as much.
const TURN: f64 = 1e-6;

/// Draws one of `count` by a seed that whoever is checked does not know; draws of another number are others.
pub fn drawn(draw: u64, number: usize, count: usize) -> usize {
    // Steele, Lea & Flood, Fast splittable pseudorandom number generators, 2014.
    let mut z = draw.wrapping_add((number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) % count.max(1) as u64) as usize
}
