//! A file that is there when it is complete.

use super::ExportError;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file under way, under another name until it is finished.
pub(super) struct Partial {
    partial: PathBuf,
    path: PathBuf,
}

impl Partial {
    /// Begins `name` in folder `dir`.
    ///
    /// # Errors
    /// If the file cannot be made.
    pub fn create(dir: &Path, name: &str) -> Result<(Self, File), ExportError> {
        let (path, partial) = (dir.join(name), dir.join(format!(".{name}.partial")));
        let file = File::create(&partial).map_err(|source| failed(&path, source))?;
        Ok((Self { partial, path }, file))
    }

    /// Gives the file, which has been written and closed, its name.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn finish(self) -> Result<(), ExportError> {
        fs::rename(&self.partial, &self.path).map_err(|source| self.failed(source))
    }

    /// It cannot be written.
    pub fn failed(&self, source: io::Error) -> ExportError {
        failed(&self.path, source)
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // There is nothing to remove once it has its name.
        let _ = fs::remove_file(&self.partial);
    }
}

/// Writes a file that is there when it is complete.
///
/// # Errors
/// If it cannot be written.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), ExportError> {
    let unnamed = || failed(path, io::ErrorKind::InvalidFilename.into());
    let name = path.file_name().and_then(|name| name.to_str()).ok_or_else(unnamed)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    if !folder.as_os_str().is_empty() && !folder.exists() {
        return Err(ExportError::Folder { file: path.into(), folder: folder.into() });
    }
    let (partial, mut file) = Partial::create(folder, name)?;
    file.write_all(bytes).map_err(|source| partial.failed(source))?;
    partial.finish()
}

/// What the folder of the branches is called.
pub(super) const BRANCHES: &str = "branches/";

/// The folder of the branches in `dir`.
///
/// # Errors
/// If it cannot be made.
pub(super) fn branches_folder(dir: &Path) -> Result<PathBuf, ExportError> {
    let folder = dir.join(BRANCHES);
    fs::create_dir_all(&folder).map_err(|source| failed(&folder, source))?;
    Ok(folder)
}

fn failed(file: &Path, source: io::Error) -> ExportError {
    ExportError::Write { file: file.into(), source }
}
