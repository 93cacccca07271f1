//! Bytes as the format has them. `tests/records.rs` reads whole files with another implementation.

use super::*;
use protocol::array::Array;
use tempfile::tempdir;

fn bytes(name: &str, value: &Value) -> Vec<u8> {
    let (matrix, mut out) = (Matrix::of(value), Vec::new());
    matrix.write(name, &mut out).unwrap();
    assert_eq!(out.len() as u64, matrix.bytes(name));
    out
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect()
}

#[test]
fn a_complex_matrix() {
    // 2 x 3, z = 10 row + column - i.
    let numbers = (0..6).flat_map(|i| [f64::from(10 * (i / 3) + i % 3), -1.0]);
    let out = bytes("z", &Value::Complex(Array::new([2, 3, 2], numbers)));
    let head = [14, out.len() as u32 - 8, 6, 8, 0x0806, 0, 5, 8, 2, 3, 1, 1, u32::from(b'z'), 0, 9, 48];
    assert_eq!(words(&out[..64]), head);
    let numbers: Vec<f64> = out[64..].as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    assert_eq!(numbers[..6], [0.0, 10.0, 1.0, 11.0, 2.0, 12.0]);
    assert_eq!(words(&out[112..120]), [9, 48]);
    assert_eq!(numbers[7..], [-1.0; 6]);
}

#[test]
fn texts() {
    // One unit a character, whatever the characters are.
    for (text, words_of_text) in [("R", [16, 1, 0x52, 0]), ("ω", [17, 2, 0x3C9, 0]), ("𝄞", [18, 4, 0x1D11E, 0])] {
        let out = bytes("", &Value::Text(text.into()));
        assert_eq!(words(&out[16..48]), [4, 0, 5, 8, 1, 1, 1, 0]);
        assert_eq!(words(&out[48..]), words_of_text);
    }
    let out = bytes("", &Value::Text(String::new()));
    assert_eq!(words(&out[24..]), [5, 8, 0, 0, 1, 0, 16, 0]);
    // A column of cells; none.
    let out = bytes("list", &Value::Texts(vec!["ab".into(), "c".into()]));
    assert_eq!(words(&out[16..40]), [1, 0, 5, 8, 2, 1]);
    let out = bytes("list", &Value::Texts(Vec::new()));
    assert_eq!(words(&out[16..40]), [1, 0, 5, 8, 0, 1]);
    assert_eq!(out.len(), 56);
}

#[test]
fn truth_is_logical() {
    let out = bytes("", &Value::Flags(vec![3], vec![true, false, true]));
    assert_eq!(words(&out[16..40]), [0x0209, 0, 5, 8, 3, 1]);
    assert_eq!(out[48..], [2, 0, 0, 0, 3, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0]);
}

#[test]
fn a_group_is_a_structure() {
    let mut record = Record::default();
    record.group("").add("alone", 1.0);
    record.group("group").add("first", 2.0);
    record.group("group").add("second", 3_usize);
    let variables = variables(&record);
    assert_eq!(variables.iter().map(|(name, _)| *name).collect::<Vec<&str>>(), ["alone", "group"]);
    let mut out = Vec::new();
    variables[1].1.write("group", &mut out).unwrap();
    assert_eq!(words(&out[16..24]), [2, 0]);
    assert_eq!(words(&out[56..72]), [0x0004_0005, 32, 1, 64]);
    assert!(out[72..].starts_with(b"first\0") && out[104..].starts_with(b"second\0"));
}

#[test]
fn a_variable_that_is_too_large_is_named() {
    let dir = tempdir().unwrap();
    // Told from the axes: nothing of that size is made here.
    let huge = Array { dtype: "<f8".into(), shape: vec![1 << 14, 1 << 14, 2], data: Vec::new() };
    let mut record = Record::default();
    record.group("").add("modal", Value::Complex(huge));
    let error = write(dir.path(), "60-main-1.mat", &record).unwrap_err().to_string();
    assert!(error.contains("60-main-1.mat: `modal` is larger than the 2 GB"), "{error}");
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}
