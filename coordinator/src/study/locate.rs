//! Finds the study file and the folder of its model.

use super::error::StudyError;
use solver::structure::{ModelError, Place};
use std::path::{Path, PathBuf};

const STUDY: &str = "study.toml";
const MODEL: &str = "model.toml";

/// The study file that a path stands for: itself, or the `study.toml` of a folder.
pub(super) fn locate(path: &Path) -> Result<PathBuf, StudyError> {
    let refused = |problem: String| Err(StudyError::NoStudy { path: path.into(), problem });
    let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    if path.is_dir() {
        let file = path.join(STUDY);
        match (file.is_file(), path.join(MODEL).is_file()) {
            (true, _) => Ok(file),
            (false, true) => {
                refused(format!("a model, but no {STUDY} that says what to compute{}", what_to_write(path)))
            }
            (false, false) => refused(format!(
                "a folder with neither {STUDY} nor {MODEL}; give a study file or its folder{}",
                listed(path)
            )),
        }
    } else if path.file_name().is_some_and(|name| name == MODEL) && path.is_file() {
        refused(format!("a model, not a study{}", what_to_write(&folder)))
    } else if !path.exists() {
        refused(format!("no such file; give a study file, or a folder that holds a {STUDY}{}", listed(&folder)))
    } else {
        Ok(path.to_path_buf())
    }
}

/// Folder of the model: `written` in the study `file`.
pub(super) fn model_folder(file: &Path, written: &str, place: impl Fn() -> Place) -> Result<PathBuf, ModelError> {
    let joined = file.parent().unwrap_or(Path::new("")).join(written);
    // Without the dots inside of the path, which messages would show.
    let dir: PathBuf = joined.components().collect();
    let dir = if dir.as_os_str().is_empty() { PathBuf::from(".") } else { dir };
    let refused = |problem: &str| {
        let remedy = format!(
            "{problem} {}; give the folder that holds {MODEL}, relative to the folder of the study",
            dir.display()
        );
        Err(ModelError::value(place(), format!("\"{written}\""), remedy))
    };
    if !dir.is_dir() {
        return refused("there is no folder");
    }
    if !dir.join(MODEL).is_file() {
        return refused(&format!("there is no {MODEL} in"));
    }
    Ok(dir)
}

/// How to make a study of a model's folder.
fn what_to_write(folder: &Path) -> String {
    format!(
        "; write a {STUDY} beside {MODEL}, at least the line amplitudes = \"20:140:20\" with your forcing amplitudes (it may be empty where --amplitudes gives them){}",
        listed(folder)
    )
}

/// The studies of a folder, as the end of a message.
fn listed(folder: &Path) -> String {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut studies: Vec<String> = entries
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml") && path.is_file())
        .filter_map(|path| path.file_name().map(|name| name.to_string_lossy().into_owned()))
        .filter(|name| name != MODEL && name != "Cargo.toml")
        .collect();
    studies.sort();
    if studies.is_empty() { String::new() } else { format!("; studies in this folder: {}", studies.join(", ")) }
}
