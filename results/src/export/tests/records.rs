//! What is read back from files for MATLAB and NumPy is what is stored, to the bit, under the documented names.

use super::*;
use crate::export::contents::Contents;
use crate::export::value::{Record, Value};
use crate::overview::Overview;
use matrw::{MatFile, MatVariable, MatlabType, load_matfile};
use npyz::NpyFile;
use num_complex::Complex64;
use protocol::array::Array;
use protocol::backbone::BackboneMessage;
use protocol::model::ModelMessage;
use solver::response::columns::{of_backbone, of_points};
use std::fs::File;
use std::io::Read;
use zip::ZipArchive;

/// Arrays of an npz file: axes, and numbers as bits (complex ones in pairs).
fn npz(path: &Path, name: &str) -> (Vec<usize>, Vec<u64>) {
    let mut archive = ZipArchive::new(File::open(path).unwrap()).unwrap();
    let mut bytes = Vec::new();
    archive.by_name(&format!("{name}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
    let array = NpyFile::new(&bytes[..]).unwrap();
    let shape = array.shape().iter().map(|&axis| axis as usize).collect();
    let bits = match array.dtype().descr().as_str() {
        "'<c16'" => pairs(array.into_vec::<Complex64>().unwrap().into_iter().map(|z| (z.re, z.im))),
        "'<f8'" => array.into_vec::<f64>().unwrap().into_iter().map(f64::to_bits).collect(),
        "'<i8'" => array.into_vec::<i64>().unwrap().into_iter().map(|i| (i as f64).to_bits()).collect(),
        "'|b1'" => array.into_vec::<bool>().unwrap().into_iter().map(u64::from).collect(),
        other => panic!("{name}: {other}"),
    };
    (shape, bits)
}

fn npz_texts(path: &Path, name: &str) -> (Vec<u64>, Vec<String>) {
    let mut archive = ZipArchive::new(File::open(path).unwrap()).unwrap();
    let array = NpyFile::new(archive.by_name(&format!("{name}.npy")).unwrap()).unwrap();
    (array.shape().to_vec(), array.into_vec::<String>().unwrap())
}

fn pairs(numbers: impl Iterator<Item = (f64, f64)>) -> Vec<u64> {
    numbers.flat_map(|(re, im)| [re.to_bits(), im.to_bits()]).collect()
}

/// Arrays of a mat file, in row-major order.
fn mat(variable: &MatVariable) -> (Vec<usize>, Vec<u64>) {
    let MatVariable::NumericArray(array) = variable else { panic!("{variable:?}") };
    let real: Vec<u64> = match &array.value {
        MatlabType::F64(values) => values.iter().map(|value| value.to_bits()).collect(),
        MatlabType::BOOL(values) => values.iter().map(|&value| u64::from(value)).collect(),
        other => panic!("{other:?}"),
    };
    let imaginary = array.value_cmp.as_ref().map(|values| match values {
        MatlabType::F64(values) => values.iter().map(|value| value.to_bits()).collect::<Vec<u64>>(),
        other => panic!("{other:?}"),
    });
    let mut bits = Vec::new();
    let mut index = vec![0; array.dim.len()];
    for _ in 0..real.len() {
        let place = index.iter().zip(&array.dim).rev().fold(0, |place, (i, axis)| place * axis + i);
        bits.push(real[place]);
        bits.extend(imaginary.iter().map(|imaginary| imaginary[place]));
        for axis in (0..index.len()).rev() {
            index[axis] = (index[axis] + 1) % array.dim[axis];
            if index[axis] > 0 {
                break;
            }
        }
    }
    (array.dim.clone(), bits)
}

fn mat_text(variable: &MatVariable) -> String {
    match variable {
        MatVariable::NumericArray(array) => match &array.value {
            MatlabType::UTF8(characters) => characters.iter().collect(),
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    }
}

fn variable<'m>(file: &'m MatFile, name: &str) -> &'m MatVariable {
    match name.split_once('.') {
        Some((group, field)) => &file[group][field],
        None => &file[name],
    }
}

/// With an extension; names of branches have points of their own.
fn file(stem: &Path, extension: &str) -> PathBuf {
    let mut name = stem.as_os_str().to_owned();
    name.push(format!(".{extension}"));
    name.into()
}

/// Bits of an array of the store, and its axes as both formats have them.
fn stored(array: &Array, is_complex: bool) -> (Vec<usize>, Vec<u64>) {
    let bits = array.data.as_chunks::<8>().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
    let count = array.shape.len() - usize::from(is_complex);
    (array.shape[..count].to_vec(), bits)
}

/// Both files have this array under this name.
fn assert_array(path: &Path, name: &str, array: &Array, is_complex: bool) {
    let (axes, bits) = stored(array, is_complex);
    assert_eq!(npz(&file(path, "npz"), name), (axes.clone(), bits.clone()), "{name}");
    let mat_file = load_matfile(file(path, "mat").to_str().unwrap()).unwrap();
    let (read_axes, read) = mat(variable(&mat_file, name));
    let mut padded = axes;
    while padded.len() < 2 {
        padded.push(1);
    }
    assert_eq!((read_axes, read), (padded, bits), "{name}");
}

fn assert_text(path: &Path, name: &str, text: &str) {
    assert_eq!(npz_texts(&file(path, "npz"), name), (vec![], vec![text.to_string()]), "{name}");
    let mat_file = load_matfile(file(path, "mat").to_str().unwrap()).unwrap();
    assert_eq!(mat_text(variable(&mat_file, name)), text, "{name}");
}

fn assert_texts(path: &Path, name: &str, texts: &[&str]) {
    assert_eq!(npz_texts(&file(path, "npz"), name).1, texts, "{name}");
    let mat_file = load_matfile(file(path, "mat").to_str().unwrap()).unwrap();
    let MatVariable::CellArray(cells) = variable(&mat_file, name) else { panic!("{name}") };
    assert_eq!(cells.dim, [texts.len(), 1], "{name}");
    assert_eq!(cells.value.iter().map(mat_text).collect::<Vec<String>>(), texts, "{name}");
}

#[test]
fn every_array_comes_back() {
    let (study, dir) = (Study::new("two_masses_stop", 3, &["0.02"]), tempdir().unwrap());
    let (store, results) = study.finished(&dir.path().join("run"));
    for format in [Format::Mat, Format::Npz] {
        assert_eq!(export(&store, format, dir.path()).unwrap().omissions, Omissions::default());
    }
    let result = &results[0];
    let points = &result.branch.as_ref().unwrap().points;
    let path = dir.path().join("branches/0.02-main-1");
    for (name, array) in
        [("omega", &points.motions.omega), ("decay", &points.motions.decay), ("forcing", &points.motions.forcing)]
    {
        assert_array(&path, name, array, false);
    }
    assert_eq!(points.columns.iter().count(), of_points().len());
    for (name, array) in points.columns.iter() {
        assert_array(&path, name, array, false);
    }
    assert_array(&path, "argument", &points.motions.argument, true);
    assert_array(&path, "modal", &points.motions.modal, true);
    let displacement = store.array(result.task.as_str(), "displacement").unwrap().unwrap();
    assert_array(&path, "displacement", &displacement, true);
    assert_array(&path, "level_value", &Array::new([], [0.02]), false);
    assert_array(&path, "seconds", &Array::new([], [result.seconds]), false);
    let special = &result.branch.as_ref().unwrap().special;
    let indices = special.iter().map(|point| point.index as f64);
    assert_array(&path, "special_index", &Array::new([special.len()], indices), false);
    assert_text(&path, "level", "0.02");
    assert_text(&path, "worker", "worker-1");
    assert_texts(&path, "displacement_dofs", &["x1", "x2"]);

    let run = dir.path().join("run");
    let backbone = BackboneMessage::from(&study.backbone);
    for (name, array) in
        [("backbone.omega", &backbone.points.motions.omega), ("backbone.decay", &backbone.points.motions.decay)]
    {
        assert_array(&run, name, array, false);
    }
    assert_eq!(backbone.columns.iter().count(), of_backbone().len());
    for (name, array) in backbone.points.columns.iter().chain(backbone.columns.iter()) {
        assert_array(&run, &format!("backbone.{name}"), array, false);
    }
    assert_array(&run, "backbone.argument", &backbone.points.motions.argument, true);
    assert_array(&run, "backbone.modal", &backbone.points.motions.modal, true);
    let model = ModelMessage::from(&study.model);
    for (name, array) in [
        ("model.mass", &model.mass),
        ("model.stiffness", &model.stiffness),
        ("model.frequencies", &model.frequencies),
        ("model.shapes", &model.shapes),
        ("model.damping", &model.damping),
        ("model.forcing_shape", &model.forcing),
    ] {
        assert_array(&run, name, array, false);
    }
    assert_texts(&run, "model.dofs", &["x1", "x2"]);
    assert_texts(&run, "branches.file", &["0.02-main-1"]);
    assert_texts(&run, "run.overrides", &["amplitudes=3e-3,0.006"]);
    assert_text(&run, "run.study", "model = \"damper\"\n");
}

/// Name, kind and number of axes.
type Entry = (String, &'static str, usize);

fn entries(record: &Record) -> Vec<Entry> {
    let kind = |value: &Value| match value {
        Value::Real(_) => "real",
        Value::Complex(_) => "complex",
        Value::Integers(..) => "integer",
        Value::Flags(..) => "logical",
        Value::Text(_) => "text",
        Value::Texts(_) => "texts",
    };
    record.0.iter().map(|(name, value)| (name.clone(), kind(value), value.shape().len())).collect()
}

/// The rows of the table under a heading of `EXPORTS.md`.
fn documented(heading: &str) -> Vec<(String, String, Vec<usize>)> {
    let document = include_str!("../../../EXPORTS.md");
    let section = document.split("\n## ").find(|section| section.starts_with(heading)).unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    rows.map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let axes = |shape: &str| if shape.is_empty() { 0 } else { shape.split('×').count() };
        (cells[1].trim_matches('`').into(), cells[2].into(), cells[3].split(" or ").map(axes).collect())
    })
    .collect()
}

fn assert_documented(heading: &str, record: &Record) {
    let (document, entries) = (documented(heading), entries(record));
    let names = |list: Vec<&String>| list.into_iter().cloned().collect::<Vec<String>>();
    let documented_names = names(document.iter().map(|row| &row.0).collect());
    assert_eq!(names(entries.iter().map(|entry| &entry.0).collect()), documented_names);
    for ((name, kind, axes), row) in entries.iter().zip(&document) {
        assert_eq!(*kind, row.1, "{name}");
        assert!(row.2.contains(axes), "{name}: {axes} axes");
        // The width of a field in files for MATLAB.
        assert!(name.split('.').all(|part| part.len() < 32), "{name}");
    }
}

#[test]
fn names_are_those_of_the_document() {
    let (study, dir) = (Study::new("two_masses_stop", 3, &["0.02"]), tempdir().unwrap());
    let (store, results) = study.finished(dir.path());
    let mut omissions = Omissions::default();
    let overview = Overview::read(&store, &mut omissions).unwrap();
    let contents = Contents::new(&store, &overview);
    assert_documented("The run", &contents.run(&mut omissions));
    assert_documented("A branch", &contents.branch("0.02-main-1", results[0].clone(), &mut omissions).unwrap());
    assert_eq!(omissions, Omissions::default());
}
