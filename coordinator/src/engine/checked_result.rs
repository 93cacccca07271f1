//! A result as it reaches the engine.

use protocol::array::ArrayError;
use protocol::branch::TaskResultMessage;
use protocol::curve::Size;
use protocol::digest::HashedBranch;
use protocol::from_worker::{Lease, SubmitRequest};
use protocol::orbits::OrbitsMessage;
use results::store::Extent;
use solver::response::orders::{Order, Orders};
use solver::response::recheck::{Recheck, Refutation, drawn};
use solver::response::task::{Brought, Task};
use solver::stability::disturbance::Disturbance;
use solver::stability::recheck::{NoOrbit, recheck};
use solver::stability::settling::Settling;
use solver::stability::verification::{Verification, VerifiedPoint};
use solver::structure::Model;
use thiserror::Error;

/// Of one in so many points that were verified the multipliers are computed again.
const WITHOUT_TANGENT: usize = 20;

/// Longest name of a version that a program may have, bytes.
const PROGRAM: usize = 100;

/// What a result has to be of.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Forcing amplitude.
    pub amplitude: f64,
    /// Order of the motions, if it is not the first one.
    pub order: Option<usize>,
    /// What was to be done.
    pub work: Task,
    /// Of a verification: number of points of its branch.
    pub points: Option<usize>,
}

/// Why a result is not one of the run.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Unsound {
    /// Its arrays do not fit the run.
    #[error(transparent)]
    Arrays(#[from] ArrayError),
    /// It does not solve the equations.
    #[error(transparent)]
    Equations(#[from] Refutation),
    /// An orbit that it tells of is none.
    #[error("what is told of point {point} is not so: {why}")]
    Orbit {
        /// Number of the point of its branch.
        point: usize,
        /// What does not hold.
        why: NoOrbit,
    },
    /// A verification without the orbits that it tells of.
    #[error("it tells of {told} orbits, and {given} came with it")]
    Orbits {
        /// How many it tells of.
        told: usize,
        /// How many came with it.
        given: usize,
    },
    /// A verification of another branch.
    #[error("it verifies a branch of {found} points, not one of {expected}")]
    OtherBranch {
        /// Points of the branch that it is of.
        found: usize,
        /// Points of the one asked for.
        expected: usize,
    },
    /// Pushes that cannot be those that were asked for.
    #[error("it is no scan of the pushes that were asked for")]
    OtherPushes,
    /// A motion that cannot be what was asked for.
    #[error("it is not what the motion that was asked for turns into")]
    OtherMotion,
    /// Not the part of the branch that was asked for.
    #[error("it verifies another part of the branch")]
    OtherStretch,
    /// Motions that are not looked for.
    #[error("motions of its order are not looked for")]
    Order,
    /// What is said of the computation is none.
    #[error("a computing time of {0} s")]
    Seconds(f64),
    /// A version that is none.
    #[error("the version of the program has more than {PROGRAM} bytes")]
    Program,
}

/// A result that fits the run and solves its equations as far as that was checked, its branch encoded and hashed. Making one
/// takes as long as its branch is large: done beside the engine.
#[derive(Debug)]
pub struct CheckedResult {
    /// Whose.
    pub lease: Lease,
    /// Version of the program that computed it.
    pub program: String,
    /// Computing time, s.
    pub seconds: f64,
    /// Whether the thread takes its next task with the acknowledgement.
    pub next: bool,
    /// The new branch, if it found one.
    pub branch: HashedBranch,
    /// What else it found, or why nothing.
    pub found: Option<TaskResultMessage>,
    /// The new branch in numbers.
    pub extent: Option<Extent>,
    /// What the task brought.
    pub brought: Brought,
}

impl CheckedResult {
    /// Checks, encodes and hashes what was submitted, against the model of a run with its numerics. `draw`: which points are checked beside those that always are.
    ///
    /// # Errors
    /// If it does not fit the run, or does not solve its equations.
    pub fn new(request: SubmitRequest, orders: &Orders, expected: &Expected, draw: u64) -> Result<Self, Unsound> {
        let SubmitRequest { lease, program, seconds, next, orbits, finding } = request;
        if program.len() > PROGRAM {
            return Err(Unsound::Program);
        }
        if !(0.0..f64::INFINITY).contains(&seconds) {
            return Err(Unsound::Seconds(seconds));
        }
        let Order { model, settings, .. } = orders.get(expected.order).ok_or(Unsound::Order)?;
        // What does not fit would be stored, and refused by every task that needs it.
        let harmonics = settings.harmonics.count;
        if let Some(other) = finding.motions().map(|motions| motions.harmonics).filter(|h| *h != harmonics) {
            return Err(ArrayError::OtherHarmonics { harmonics: other, expected: harmonics }.into());
        }
        let (size, recheck) = (Size::of(model), Recheck::new(model, settings, draw));
        match &finding {
            TaskResultMessage::Landings(found) => {
                recheck.landings(&found.landings(&size)?, expected.work.forcing(expected.amplitude))?;
            }
            TaskResultMessage::Branch(found) => recheck.branch(&found.branch(&size)?, expected.amplitude)?,
            TaskResultMessage::Curve(found) => recheck.curve(&found.curve(&size)?)?,
            TaskResultMessage::Verification(found) => {
                verifies(found, &size, expected)?;
                marches(model, found, orbits.as_ref(), expected.amplitude, draw)?;
            }
            TaskResultMessage::Disturbance(found) => disturbs(found, &size, expected)?,
            TaskResultMessage::Settling(found) => settles(found, &size, expected)?,
            TaskResultMessage::Nothing(_) => {}
        }
        let brought = finding.brought();
        let (branch, found) = match finding {
            TaskResultMessage::Branch(found) => (Some(found), None),
            found => (None, Some(found)),
        };
        let extent = branch.as_ref().map(Extent::of);
        let branch = HashedBranch::new(branch);
        Ok(Self { lease, program, seconds, next, branch, found, extent, brought })
    }
}

/// Whether pushes are those that were asked for.
fn disturbs(found: &Disturbance, size: &Size, expected: &Expected) -> Result<(), Unsound> {
    match &expected.work {
        Task::Disturb(place) if found.is_sound(place, size.monitors) => Ok(()),
        _ => Err(Unsound::OtherPushes),
    }
}

/// Whether a motion is the one that was asked for.
fn settles(found: &Settling, size: &Size, expected: &Expected) -> Result<(), Unsound> {
    match &expected.work {
        Task::March(place) if found.is_sound(place, size.monitors) => Ok(()),
        _ => Err(Unsound::OtherMotion),
    }
}

/// Whether one of the orbits that a verification tells of, drawn, is what it is said to be: by a period, and for one in twenty of the
/// points with its multipliers, which takes ten times as long.
fn marches(
    model: &Model,
    found: &Verification,
    orbits: Option<&OrbitsMessage>,
    forcing: f64,
    draw: u64,
) -> Result<(), Unsound> {
    let told: Vec<&VerifiedPoint> = found.points.iter().filter(|point| point.orbit.is_some()).collect();
    let given = orbits.map_or(0, OrbitsMessage::len);
    if given != told.len() {
        return Err(Unsound::Orbits { told: told.len(), given });
    }
    let Some(orbits) = orbits.filter(|orbits| !orbits.is_empty()) else { return Ok(()) };
    let number = drawn(draw, 0, given);
    let (point, omega) = (told[number], told[number].orbit.as_ref().map_or(0.0, |orbit| orbit.omega));
    let with_tangent = drawn(draw, 1, WITHOUT_TANGENT) < found.points.len();
    let why = recheck(model, &orbits.orbit(number, omega, forcing)?, point, with_tangent);
    why.map_err(|why| Unsound::Orbit { point: point.index, why })
}

/// Whether a verification is of the branch that was asked for.
fn verifies(found: &Verification, size: &Size, expected: &Expected) -> Result<(), Unsound> {
    if !found.is_sound(size.monitors) {
        return Err(ArrayError::Verification.into());
    }
    if let Some(points) = expected.points.filter(|points| *points != found.count) {
        return Err(Unsound::OtherBranch { found: found.count, expected: points });
    }
    match &expected.work {
        Task::Verify(place) if place.stretch != found.stretch => Err(Unsound::OtherStretch),
        _ => Ok(()),
    }
}
