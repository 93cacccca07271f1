//! The digest of a result, whole, in two parts, and as it was at first.

use crate::samples;
use protocol::branch::BranchMessage;
use protocol::codec::{decode_stored, encode, sha256};
use protocol::digest::{Digest, HashedBranch, announced};
use protocol::to_everyone::StoredResult;
use solver::response::task::{SeedPlace, Task};
use solver::response::windows::Window;

#[test]
fn a_branch_hashed_beforehand_gives_the_digest_of_the_whole_result() {
    for result in [samples::result(), samples::result_nothing()] {
        let hashed = HashedBranch::new(result.branch.clone());
        assert_eq!(hashed.branch(), result.branch.as_ref());
        let whole = hashed.complete(StoredResult { branch: None, ..result.clone() });
        let bytes = encode(&result);
        assert_eq!((&whole.result, &whole.bytes), (&result, &bytes));
        assert_eq!(whole.digest, Digest { size: bytes.len() as u64, sha256: sha256(&bytes) });
        assert_eq!(whole.digest, Digest::of(&result));
    }
}

/// As before branches said of what kind they are, and what their numbers are worth, and windows of which mode.
fn as_before(result: StoredResult) -> StoredResult {
    let of_first_mode = |place: SeedPlace| SeedPlace { well: Window { mode: 0, ..place.well }, ..place };
    let work = match result.work {
        Task::Land(place) => Task::Land(of_first_mode(place)),
        Task::Seed(place) => Task::Seed(of_first_mode(place)),
        main => main,
    };
    let before = |branch| BranchMessage { kind: None, peak_standing: None, certificate: None, ..branch };
    StoredResult { branch: result.branch.map(before), work, ..result }
}

/// `../earlier/` holds results as they were encoded when the branch came after the name.
#[test]
fn results_stored_in_the_first_order_of_fields_keep_their_bytes() {
    let earlier: [(&[u8], StoredResult); 2] = [
        (include_bytes!("../earlier/result.msgpack"), as_before(samples::result())),
        (include_bytes!("../earlier/result_nothing.msgpack"), as_before(samples::result_nothing())),
    ];
    for (bytes, result) in earlier {
        assert_eq!(decode_stored::<StoredResult>(bytes).unwrap(), result);
        assert_ne!(encode(&result), bytes);
        assert_eq!(announced(&result, &sha256(bytes)).as_deref(), Some(bytes));
        assert_eq!(announced(&result, &sha256(&encode(&result))), Some(encode(&result)));
        assert_eq!(announced(&StoredResult { seconds: 7.0, ..result }, &sha256(bytes)), None);
    }
}
