//! A result as it reaches the engine.

use protocol::array::ArrayError;
use protocol::branch::FindingMessage;
use protocol::critical::CriticalMessage;
use protocol::curve::Size;
use protocol::digest::HashedBranch;
use protocol::from_worker::{Lease, SubmitRequest};
use protocol::landings::LandingsMessage;
use results::store::Extent;
use solver::response::task::Brought;
use solver::stability::verification::Verification;

/// A result that fits the model, its branch encoded and hashed. Making one takes as long as its branch is large: done
/// beside the engine.
#[derive(Debug)]
pub struct CheckedResult {
    /// Whose.
    pub lease: Lease,
    /// Version of the program that computed it.
    pub program: String,
    /// Computing time, s.
    pub seconds: f64,
    /// The new branch, if it found one.
    pub branch: HashedBranch,
    /// The new fold curve, if it found one.
    pub curve: Option<CriticalMessage>,
    /// What seeds landed on.
    pub landings: Option<LandingsMessage>,
    /// What marching says of a branch.
    pub verification: Option<Verification>,
    /// The new branch in numbers.
    pub extent: Option<Extent>,
    /// What the task brought.
    pub brought: Brought,
}

impl CheckedResult {
    /// Checks, encodes and hashes what was submitted for a model of this size, in a run of so many harmonics.
    ///
    /// # Errors
    /// If it does not fit the run.
    pub fn new(request: SubmitRequest, size: &Size, expected: usize) -> Result<Self, ArrayError> {
        let SubmitRequest { lease, program, seconds, finding } = request;
        // What does not fit would be stored, and refused by every task that needs it.
        if let Some(harmonics) = finding.motions().map(|motions| motions.harmonics).filter(|h| *h != expected) {
            return Err(ArrayError::OtherHarmonics { harmonics, expected });
        }
        let brought = finding.brought();
        let (mut branch, mut curve, mut landings, mut verification) = (None, None, None, None);
        match finding {
            FindingMessage::Landings(found) => landings = Some(found),
            FindingMessage::Branch(found) => branch = Some(found),
            FindingMessage::Curve(found) => curve = Some(found),
            FindingMessage::Verification(found) => verification = Some(found),
            FindingMessage::Nothing(_) => {}
        }
        if let Some(landings) = &landings {
            landings.landings(size)?;
        }
        if let Some(branch) = &branch {
            branch.branch(size)?;
        }
        if let Some(curve) = &curve {
            curve.curve(size)?;
        }
        if verification.as_ref().is_some_and(|found| !found.is_sound(size.monitors)) {
            return Err(ArrayError::Verification);
        }
        let extent = branch.as_ref().map(Extent::of);
        let branch = HashedBranch::new(branch);
        Ok(Self { lease, program, seconds, branch, curve, landings, verification, extent, brought })
    }
}
