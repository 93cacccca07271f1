//! Frozen bytes: what is stored or sent today must be readable tomorrow, and by tools that are not written in Rust.
//!
//! `../frozen/` holds one small sample of every message (of every variant, for replies) twice: its bytes
//! (`*.snap.msgpack`, which the tests of the Python client read as well) and a view of them (`*.view.snap`), where numbers
//! have the types they have on the wire. A change of any of them is a new `protocol::VERSION`, unless it only adds a field or
//! changes the order of fields.

use crate::samples::Visit;
use crate::{samples, view};
use protocol::VERSION;
use protocol::codec::{CodecError, Message, decode, decode_stored, encode, encoding};
use protocol::ids::{Attempt, TaskId};
use protocol::to_everyone::{Done, Manifest, StoredResult};
use protocol::to_worker::LeaseReply;
use std::collections::BTreeSet;
use std::fmt::Debug;

/// Snapshots are files of `../frozen`, named by what they hold.
fn settings() -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../frozen");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings
}

/// Compares bytes with the frozen ones, which have to be read as the same sample.
struct Freeze;

impl Visit for Freeze {
    fn visit<M: Message + PartialEq + Debug>(&mut self, file: &str, sample: &M) {
        let bytes = encode(sample);
        let view = format!("{}\n{}", encoding::<M>(), view::view(&bytes));
        settings().bind(|| {
            insta::assert_binary_snapshot!(&format!("{file}.msgpack"), bytes.clone());
            insta::assert_snapshot!(format!("{file}.view"), view);
        });
        assert_eq!(&decode::<M>(&bytes, &encoding::<M>()).unwrap(), sample, "{file}");
    }
}

#[test]
fn bytes_are_the_frozen_ones() {
    samples::all(&mut Freeze);
}

/// Outcomes are printed by other tools in the same words.
#[test]
fn words_are_the_frozen_ones() {
    fn line<T: serde::Serialize + std::fmt::Display>(kind: &str, outcome: &T) -> String {
        let bytes = rmp_serde::to_vec_named(outcome).unwrap();
        let hexadecimal = bytes.iter().fold(String::new(), |text, byte| format!("{text}{byte:02x}"));
        format!("{kind} {hexadecimal} {outcome}\n")
    }
    let (curves, seeds) = samples::outcomes();
    let curves = curves.iter().map(|outcome| line("outcome", outcome));
    let words: String = curves.chain(seeds.iter().map(|outcome| line("seed_outcome", outcome))).collect();
    settings().bind(|| insta::assert_snapshot!("words", words));
}

/// Names of messages among the samples.
#[derive(Default)]
struct Names(BTreeSet<String>);

impl Visit for Names {
    fn visit<M: Message + PartialEq + Debug>(&mut self, _: &str, _: &M) {
        self.0.insert(M::NAME.to_string());
    }
}

#[test]
fn every_message_has_a_sample_and_a_name_of_its_own() {
    let mut declared = Vec::new();
    let sources = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for file in std::fs::read_dir(sources).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        for block in text.split("\nmessages! {").skip(1) {
            let block = block.split('}').next().unwrap();
            declared.extend(block.split('"').skip(1).step_by(2).map(str::to_string));
        }
    }
    let distinct: BTreeSet<String> = declared.iter().cloned().collect();
    assert_eq!(distinct.len(), declared.len(), "{declared:?}");
    let mut sampled = Names::default();
    samples::all(&mut sampled);
    assert_eq!(sampled.0, distinct);
}

/// Refuses everything whose encoding is not exactly the one expected.
struct Refuse;

impl Visit for Refuse {
    fn visit<M: Message + PartialEq + Debug>(&mut self, file: &str, sample: &M) {
        let bytes = encode(sample);
        let right = encoding::<M>();
        assert_eq!(right, format!("application/msgpack;{}.v{VERSION}", M::NAME));
        let next = format!("application/msgpack;{}.v{}", M::NAME, VERSION + 1);
        for wrong in [next.as_str(), "application/msgpack;other.v2", "application/msgpack", "zenoh/bytes", ""] {
            let error = decode::<M>(&bytes, wrong).unwrap_err();
            let CodecError::Encoding { found, expected } = &error else { panic!("{file}: {error:?}") };
            assert_eq!((found.as_str(), expected), (wrong, &right));
            let text = error.to_string();
            assert!(text.contains(wrong) && text.contains(&right) && text.contains("another version"), "{text}");
        }
    }
}

#[test]
fn another_version_or_name_is_refused_in_words() {
    samples::all(&mut Refuse);
}

/// Cuts and bends the bytes: errors with the name of the message, never a panic.
struct Damage;

impl Visit for Damage {
    fn visit<M: Message + PartialEq + Debug>(&mut self, file: &str, sample: &M) {
        let bytes = encode(sample);
        for length in 0..bytes.len() {
            let error = decode_stored::<M>(&bytes[..length]).expect_err(file);
            assert!(error.to_string().contains(&format!("malformed `{}` message", M::NAME)), "{error}");
        }
        for index in 0..bytes.len() {
            for bent in [0x00, 0x80, 0xc0, 0xc6, 0xdd, 0xff] {
                let mut damaged = bytes.clone();
                damaged[index] = bent;
                let _ = decode_stored::<M>(&damaged);
            }
        }
    }
}

#[test]
fn damaged_bytes_are_errors() {
    samples::all(&mut Damage);
}

/// The map `bytes` with one more field at its end.
fn with_another_field(bytes: &[u8]) -> Vec<u8> {
    let (count, rest) = match bytes[0] {
        head @ 0x80..=0x8f => (u16::from(head & 0x0f), &bytes[1..]),
        0xde => (u16::from_be_bytes([bytes[1], bytes[2]]), &bytes[3..]),
        head => panic!("not a map: {head:#x}"),
    };
    let mut more = vec![0xde];
    more.extend((count + 1).to_be_bytes());
    more.extend(rest);
    // "field of tomorrow": {"a": [1, nil]}
    more.push(0xa0 | 17);
    more.extend(b"field of tomorrow");
    more.extend([0x81, 0xa1, b'a', 0x92, 0x01, 0xc0]);
    more
}

/// Reads messages with a field that is not known today.
#[derive(Default)]
struct Tomorrow(usize);

impl Visit for Tomorrow {
    fn visit<M: Message + PartialEq + Debug>(&mut self, file: &str, sample: &M) {
        // Enumerations are a string or a map of one variant: variants cannot be ignored.
        if file.contains('-') || file.starts_with("control_request") {
            return;
        }
        assert_eq!(&decode_stored::<M>(&with_another_field(&encode(sample))).expect(file), sample);
        self.0 += 1;
    }
}

#[test]
fn a_field_can_be_added_later() {
    let mut tomorrow = Tomorrow::default();
    samples::all(&mut tomorrow);
    assert!(tomorrow.0 >= 15, "{} messages are maps", tomorrow.0);
}

#[test]
fn a_missing_field_and_an_unknown_variant_are_named() {
    let error = decode_stored::<Done>(&[0x81, 0xa8, b's', b'e', b'q', b'u', b'e', b'n', b'c', b'e', 0x01]).unwrap_err();
    assert!(error.to_string().contains("missing field `task`"), "{error}");
    let error = decode_stored::<LeaseReply>(b"\xa5later").unwrap_err();
    assert!(error.to_string().contains("unknown variant `later`"), "{error}");
}

#[test]
fn names_are_checked_when_read() {
    let mut bytes = encode(&samples::done());
    let place = bytes.windows(5).position(|chunk| chunk == b"2.5-3").unwrap();
    bytes[place + 1] = b'*';
    let error = decode_stored::<Done>(&bytes).unwrap_err();
    assert!(error.to_string().contains("`2*5-3` is not a name"), "{error}");
}

#[test]
fn the_branch_of_a_result_is_the_one_submitted() {
    let StoredResult { branch, task, attempt, .. } = samples::result();
    assert_eq!(branch.as_ref(), Some(&samples::branch()));
    assert_eq!((task, attempt), (TaskId::new("2.5-3").unwrap(), Attempt(2)));
    let Manifest { protocol, .. } = samples::manifest();
    assert_eq!(protocol, VERSION);
}
