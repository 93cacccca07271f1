//! Size and SHA-256 of a stored result, as they are announced.
//!
//! The branch of a result may have megabytes and is known before anybody has decided what becomes of it. It comes first in
//! the encoding, so that it can be encoded and hashed beforehand: what the decision adds are a few hundred bytes.

use crate::branch::BranchMessage;
use crate::codec::{encode, encode_onto, encode_part, hexadecimal, sha256};
use crate::ids::{Attempt, TaskId, WorkerId};
use crate::to_everyone::{Amplitude, StoredResult};
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use solver::response::task::{BranchId, SeedOutcome, Task};

/// How the encoding of a [plain](StoredResult::is_plain) result begins: a map of ten fields, of which the first is `branch`.
const HEAD: &[u8] = b"\x8a\xa6branch";
/// What follows if there is no branch: nil.
const NO_BRANCH: usize = 1;

/// Size and SHA-256 of an encoding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Digest {
    /// Bytes.
    pub size: u64,
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

impl Digest {
    /// Of a result.
    pub fn of(result: &StoredResult) -> Self {
        Self::of_bytes(&encode(result))
    }

    fn of_bytes(bytes: &[u8]) -> Self {
        Self { size: bytes.len() as u64, sha256: sha256(bytes) }
    }
}

/// The branch of a result to be, or that there is none, encoded and hashed.
#[derive(Debug, Clone)]
pub struct HashedBranch {
    branch: Option<BranchMessage>,
    /// The beginning of the encoding.
    bytes: Vec<u8>,
    hash: Sha256,
}

/// A result with its encoding and the digest of that.
#[derive(Debug)]
pub struct Encoded {
    /// The result.
    pub result: StoredResult,
    /// Its encoding.
    pub bytes: Vec<u8>,
    /// Size and SHA-256 of that.
    pub digest: Digest,
}

impl HashedBranch {
    /// Encodes and hashes the beginning of a result.
    pub fn new(branch: Option<BranchMessage>) -> Self {
        let mut bytes = HEAD.to_vec();
        encode_onto(&mut bytes, &branch);
        let hash = Sha256::new_with_prefix(&bytes);
        Self { branch, bytes, hash }
    }

    /// The branch.
    pub fn branch(&self) -> Option<&BranchMessage> {
        self.branch.as_ref()
    }

    /// The result with this branch and everything else as in `rest`.
    pub fn complete(self, rest: StoredResult) -> Encoded {
        if !rest.is_plain() {
            let bytes = encode(&rest);
            let digest = Digest::of_bytes(&bytes);
            return Encoded { result: rest, bytes, digest };
        }
        let rest = StoredResult { branch: None, ..rest };
        let end = &encode(&rest)[HEAD.len() + NO_BRANCH..];
        let mut bytes = self.bytes;
        bytes.extend_from_slice(end);
        let sha256 = hexadecimal(&self.hash.chain_update(end).finalize());
        let digest = Digest { size: bytes.len() as u64, sha256 };
        Encoded { result: StoredResult { branch: self.branch, ..rest }, bytes, digest }
    }
}

/// The encoding of a result that has this SHA-256, if one has: with the branch first or, as in the first runs that were
/// stored, after the name.
pub fn announced(result: &StoredResult, expected: &str) -> Option<Vec<u8>> {
    let with_branch_first = encode(result);
    if sha256(&with_branch_first) == expected {
        return Some(with_branch_first);
    }
    let as_at_first = encode_part(&AsAtFirst::from(result));
    (sha256(&as_at_first) == expected).then_some(as_at_first)
}

/// The fields of a result in the order that they first had.
#[derive(Serialize)]
struct AsAtFirst<'r> {
    task: &'r TaskId,
    attempt: Attempt,
    amplitude: &'r Amplitude,
    work: &'r Task,
    outcome: &'r SeedOutcome,
    name: Option<BranchId>,
    branch: Option<&'r BranchMessage>,
    worker: &'r WorkerId,
    program: &'r str,
    seconds: f64,
}

impl<'r> From<&'r StoredResult> for AsAtFirst<'r> {
    fn from(result: &'r StoredResult) -> Self {
        Self {
            task: &result.task,
            attempt: result.attempt,
            amplitude: &result.amplitude,
            work: &result.work,
            outcome: &result.outcome,
            name: result.name,
            branch: result.branch.as_ref(),
            worker: &result.worker,
            program: &result.program,
            seconds: result.seconds,
        }
    }
}
