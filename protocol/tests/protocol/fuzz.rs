//! Every decoder against bytes that somebody has tampered with: a message or an error, never a panic, and no more memory than a
//! few times the bytes.
//!
//! Ten seconds in all, a minute in continuous integration; `ISOLA_FUZZ_SECONDS=3600` for an hour.

use crate::samples::{self, SIZE, Visit};
use protocol::branch::TaskResultMessage;
use protocol::codec::{Message, decode_stored, encode, encoding};
use protocol::from_worker::{CheckpointRequest, SubmitRequest};
use protocol::model::ModelMessage;
use protocol::to_everyone::StoredResult;
use protocol::to_worker::{Checkpoint, LeaseReply};
use rand::{Rng, SeedableRng};
use solver::response::task::Task;
use std::fmt::Debug;
use std::time::{Duration, Instant};

/// Messages that samples are of.
const SAMPLES: u32 = 52;
/// More than anything that the samples' bytes may become, kB.
const MEMORY: u64 = 256 << 10;

/// What a tampered copy is made of.
fn tampered(bytes: &[u8], random: &mut impl Rng) -> Vec<u8> {
    let mut copy = bytes.to_vec();
    for _ in 0..random.gen_range(1..5) {
        if copy.is_empty() {
            break;
        }
        let at = random.gen_range(0..copy.len());
        match random.gen_range(0..7) {
            0 => copy[at] ^= 1 << random.gen_range(0..8),
            1 => copy[at] = random.gen_range(0..=u8::MAX),
            2 => copy.truncate(at),
            3 => drop(copy.remove(at)),
            // Lengths of text, bytes, arrays and maps that are far beyond the end.
            4 => {
                let kind = [0xdb, 0xc6, 0xdd, 0xdf, 0xd9, 0xc4, 0xdc][random.gen_range(0..7)];
                let length: [u8; 4] = [0x7f, 0xff, 0xff, 0xff];
                copy.splice(at..at, [kind].into_iter().chain(length));
            }
            5 => {
                let from = random.gen_range(0..copy.len());
                let part = copy[from..(from + random.gen_range(1..64)).min(copy.len())].to_vec();
                copy.splice(at..at, part);
            }
            // Numbers that are none, and that overflow.
            _ => {
                let number = [f64::NAN, f64::INFINITY, -0.0, 1e308, 5e-324][random.gen_range(0..5)].to_le_bytes();
                let end = (at + 8).min(copy.len());
                copy.splice(at..end, number);
            }
        }
    }
    copy
}

struct Fuzz {
    each: Duration,
    random: rand_chacha::ChaCha8Rng,
    tried: u64,
    read: u64,
}

impl Visit for Fuzz {
    fn visit<M: Message + PartialEq + Debug>(&mut self, _file: &str, sample: &M) {
        let bytes = encode(sample);
        let began = Instant::now();
        while began.elapsed() < self.each {
            let copy = tampered(&bytes, &mut self.random);
            self.tried += 1;
            if let Ok(message) = decode_stored::<M>(&copy) {
                self.read += 1;
                // What was read can be written, and is read as the same again.
                let again = encode(&message);
                assert_eq!(encode(&decode_stored::<M>(&again).expect("it was written")), again);
            }
            converted(&copy);
        }
    }
}

/// What becomes of bytes that are read as what a coordinator or a worker makes something of.
fn converted(bytes: &[u8]) {
    let _ = SubmitRequest::lease_in(bytes, &encoding::<SubmitRequest>());
    if let Ok(SubmitRequest { finding, .. }) = decode_stored(bytes) {
        let _ = finding.brought();
        match finding {
            TaskResultMessage::Branch(branch) => drop(branch.branch(&SIZE)),
            TaskResultMessage::Curve(curve) => drop(curve.curve(&SIZE)),
            TaskResultMessage::Landings(landings) => drop(landings.landings(&SIZE)),
            TaskResultMessage::Verification(verification) => {
                if verification.is_sound(SIZE.monitors) && verification.count < 1 << 16 {
                    assert_eq!(verification.verdicts().len(), verification.count);
                }
            }
            TaskResultMessage::Disturbance(_) | TaskResultMessage::Settling(_) | TaskResultMessage::Nothing(_) => {}
        }
    }
    if let Ok(StoredResult { branch, disturbance, settling, work, .. }) = decode_stored(bytes) {
        let _ = branch.is_some_and(|branch| branch.branch(&SIZE).is_ok());
        if let (Some(disturbance), Task::Disturb(place)) = (disturbance, work) {
            let _ = disturbance.is_sound(&place, SIZE.monitors);
        }
        if let (Some(settling), Task::March(place)) = (settling, work) {
            let _ = settling.is_sound(&place, SIZE.monitors);
        }
    }
    if let Ok(CheckpointRequest { steps, .. }) = decode_stored(bytes) {
        let _ = steps.steps().is_ok();
    }
    if let Ok(Checkpoint { parts, .. }) = decode_stored(bytes) {
        let _ = parts.iter().all(|part| part.steps().is_ok());
    }
    if let Ok(LeaseReply::Grant(grant)) = decode_stored(bytes) {
        let _ = grant.seeds.seeds(&SIZE);
    }
    let _ = decode_stored::<ModelMessage>(bytes).map(|model| model.model().is_ok());
}

/// Most memory that this process ever had, kB.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok()).unwrap_or(0)
}

#[test]
fn tampered_bytes_are_messages_or_errors() {
    let seconds = std::env::var("ISOLA_FUZZ_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(10.0);
    let seed = std::process::id().into();
    let random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let each = Duration::from_secs_f64(seconds / f64::from(SAMPLES));
    let mut fuzz = Fuzz { each, random, tried: 0, read: 0 };
    let before = peak_memory();
    println!("seed {seed}");
    samples::all(&mut fuzz);
    let Fuzz { tried, read, .. } = fuzz;
    println!("{tried} tampered messages, {read} of them read; {} kB more at most", peak_memory() - before);
    assert!(tried > 10_000 && read > 100, "{tried} tried, {read} read");
    assert!(peak_memory() - before < MEMORY, "{} kB", peak_memory() - before);
}
