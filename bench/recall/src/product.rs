//! The product on a structure of the truth: model and study as files, `isola sweep`, and what its `summary.csv` lists.

use crate::record::Record;
use npyz::NpyFile;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use thiserror::Error;

/// Why the product could not be run.
#[derive(Debug, Error)]
pub enum ProductError {
    /// A file cannot be written, or the program cannot be started.
    #[error("{path}: {source}")]
    File {
        /// File or program.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The model cannot be said as TOML.
    #[error("model {number}: {source}")]
    Model {
        /// Number of the structure.
        number: u64,
        /// What is wrong.
        source: toml::ser::Error,
    },
    /// A motion is not as expected.
    #[error("{path}: {what}")]
    Motion {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The table is not as expected.
    #[error("{path}: {source}")]
    Table {
        /// The table.
        path: PathBuf,
        /// What is wrong.
        source: csv::Error,
    },
}

/// What a run has left.
#[derive(Debug)]
pub struct Run {
    /// Exit code; none if it was ended by a signal.
    pub code: Option<i32>,
    /// Rows of `summary.csv`.
    pub rows: Vec<Row>,
    /// Its folder.
    pub folder: PathBuf,
}

/// A row of `summary.csv`, as far as it is compared.
#[derive(Debug, Clone, Deserialize)]
pub struct Row {
    /// Forcing amplitude A.
    pub amplitude: f64,
    /// Number of the branch within its kind.
    pub branch: usize,
    /// main, isola, open, cut, branched or unfinished.
    pub kind: String,
    /// Lowest frequency, rad/s.
    pub omega_min: Option<f64>,
    /// Highest frequency, rad/s.
    pub omega_max: Option<f64>,
    /// Peak, m.
    pub amplitude_max: Option<f64>,
    /// Its frequency, rad/s.
    pub omega_at_max: Option<f64>,
    /// Whether that is the peak (`at`), or only as far as the branch is known.
    pub peak_standing: String,
}

/// The study: levels and range; everything else is left to its default.
#[derive(Debug, Serialize)]
struct Study {
    amplitudes: Vec<f64>,
    frequency: Frequency,
}

#[derive(Debug, Serialize)]
struct Frequency {
    min: f64,
    max: f64,
}

/// Runs `isola sweep` on a structure, in a folder, with a number of workers and further arguments.
///
/// # Errors
/// If a file cannot be written or read, or the program not started. That it ends with a code is no error.
pub fn sweep(isola: &Path, record: &Record, folder: &Path, arguments: &[String]) -> Result<Run, ProductError> {
    let file = |path: &Path| {
        let path = path.to_owned();
        |source| ProductError::File { path, source }
    };
    let text = |source| ProductError::Model { number: record.number, source };
    let study = Study {
        amplitudes: record.levels.iter().map(|level| level.forcing).collect(),
        frequency: Frequency { min: record.range[0], max: record.range[1] },
    };
    let files = [
        ("model.toml", toml::to_string(&record.model).map_err(text)?),
        ("study.toml", toml::to_string(&study).map_err(text)?),
    ];
    std::fs::create_dir_all(folder).map_err(file(folder))?;
    for (name, text) in files {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(file(&path))?;
    }
    let run = folder.join("run");
    let log = folder.join("log");
    let output = std::fs::File::create(&log).map_err(file(&log))?;
    let errors = output.try_clone().map_err(file(&log))?;
    let status = Command::new(isola)
        .arg("sweep")
        .arg(folder.join("study.toml"))
        .arg("--out")
        .arg(&run)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(output)
        .stderr(errors)
        .status()
        .map_err(file(isola))?;
    kept(folder, status.code())
}

/// What a run in a folder has left, that ended with this code.
///
/// # Errors
/// If there is no table, or it is another one.
pub fn kept(folder: &Path, code: Option<i32>) -> Result<Run, ProductError> {
    let run = folder.join("run");
    // What was exported of an earlier run in this folder is not of this one.
    let _ = std::fs::remove_dir_all(run.join("npz"));
    let path = run.join("summary.csv");
    let rows = read(&path).map_err(|source| ProductError::Table { path, source })?;
    Ok(Run { code, rows, folder: run })
}

fn read(path: &Path) -> Result<Vec<Row>, csv::Error> {
    csv::Reader::from_path(path)?.deserialize().collect()
}

impl Run {
    /// Some motions of the branch of a row, evenly spread over its points: for each the coefficients of 1, cos τ, sin τ, cos 2τ, …
    /// up to `harmonics`, in m, of dof after dof, and ω in rad/s.
    ///
    /// # Errors
    /// If `isola export` cannot be started, or what it writes is not as expected.
    pub fn motions(
        &self,
        isola: &Path,
        row: &Row,
        harmonics: usize,
        count: usize,
    ) -> Result<Vec<Vec<f64>>, ProductError> {
        let to = self.folder.join("npz");
        if !to.exists() {
            let arguments = ["export", "--format", "npz", "--to"];
            let output = Command::new(isola).args(arguments).arg(&to).arg(&self.folder).output();
            let output = output.map_err(|source| ProductError::File { path: isola.to_owned(), source })?;
            if !output.status.success() {
                let what = String::from_utf8_lossy(&output.stderr).into_owned();
                return Err(ProductError::Motion { path: self.folder.clone(), what });
            }
        }
        let branches = to.join("branches");
        let suffix = format!("-{}-{}", row.kind, row.branch);
        let is_of_row = |path: &PathBuf| {
            let name = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
            name.strip_suffix(&suffix).and_then(|amplitude| amplitude.parse().ok()) == Some(row.amplitude)
        };
        let list = std::fs::read_dir(&branches);
        let list = list.map_err(|source| ProductError::File { path: branches.clone(), source })?;
        let path = list.flatten().map(|entry| entry.path()).find(is_of_row).unwrap_or(branches.join(suffix));
        let motions = motions_of(&path, &to.join("run.npz"), harmonics, count);
        motions.map_err(|error| ProductError::Motion { path, what: error.to_string() })
    }
}

fn motions_of(
    path: &Path,
    run: &Path,
    harmonics: usize,
    count: usize,
) -> Result<Vec<Vec<f64>>, Box<dyn std::error::Error>> {
    let open = |path| Ok::<_, Box<dyn std::error::Error>>(zip::ZipArchive::new(std::fs::File::open(path)?)?);
    let (mut branch, mut run) = (open(path)?, open(run)?);
    let shapes: Vec<f64> = NpyFile::new(run.by_name("model.shapes.npy")?)?.into_vec()?;
    let omega: Vec<f64> = NpyFile::new(branch.by_name("omega.npy")?)?.into_vec()?;
    let file = NpyFile::new(branch.by_name("modal.npy")?)?;
    let &[points, modes, width] = file.shape() else { return Err("modal amplitudes have three axes".into()) };
    let (points, modes, width) = (points as usize, modes as usize, width as usize);
    let modal: Vec<Complex64> = file.into_vec()?;
    if points == 0 || omega.len() != points || shapes.len() != modes * modes {
        return Err("expected points with the amplitudes of all modes".into());
    }
    let motion = |point: usize| {
        let modal = &modal[point * modes * width..(point + 1) * modes * width];
        let mut motion = Vec::with_capacity(modes * (2 * harmonics + 1) + 1);
        for shape in shapes.chunks(modes) {
            let along = |k: usize| shape.iter().zip(modal.chunks(width)).map(move |(shape, q)| q[k] * shape).sum();
            let coefficient = |k: usize| -> Complex64 { if k < width { along(k) } else { Complex64::default() } };
            motion.push(coefficient(0).re);
            motion.extend((1..=harmonics).flat_map(|k| [coefficient(k).re, -coefficient(k).im]));
        }
        motion.push(omega[point]);
        motion
    };
    Ok((0..count).map(|i| motion(i * points / count)).collect())
}
