//! The folder of a run: where it is, and how to reach whoever serves it.

use crate::error::Error;
use results::store::{FILE, Store};
use results::words::listed;
use std::io::{self, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

/// File with the endpoint of the coordinator.
const ADDRESS: &str = "address";
/// File with the address at which the run is served over HTTP.
const HTTP: &str = "http";
/// File with the token that lets somebody read there.
pub const HTTP_TOKEN: &str = "http-token";

/// A new folder under `runs/`, named after the study and the time.
pub fn default_directory(study: &str) -> PathBuf {
    let name: String =
        study.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect();
    let name = name.split('-').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("-");
    let time = results::clock::compact();
    let base = Path::new("runs");
    let plain = base.join(format!("{name}-{time}"));
    let numbered = |number: u32| base.join(format!("{name}-{time}-{number}"));
    if !plain.exists() {
        return plain;
    }
    (2..).map(numbered).find(|directory| !directory.exists()).unwrap_or(plain)
}

/// Folder with what local workers write.
pub const LOGS: &str = "logs";
/// Where workers of other machines find the coordinator: written by who launches both (`deploy/slurm/isola-run.sbatch`).
const ELSEWHERE: &str = "elsewhere";
/// How many files of others are named.
const NAMED: usize = 3;

/// Refuses a folder of a new run that holds something else, unless that is the study: what a run writes would lie among the files of others.
/// A folder with a run is left to those who create one.
///
/// # Errors
/// With some of what is there.
pub fn refuse_foreign(directory: &Path, study: &Path) -> Result<(), Error> {
    let place = |file: &Path| file.canonicalize().ok();
    let is_of_study =
        study.file_name().and_then(|name| place(&directory.join(name))).is_some_and(|file| place(study) == Some(file));
    if directory.join(FILE).exists() || is_of_study {
        return Ok(());
    }
    // What cannot be read is told where it is written.
    let Ok(entries) = std::fs::read_dir(directory) else { return Ok(()) };
    let names = entries.filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()));
    // A run that was discarded may have left some of its own.
    let own = [ADDRESS, HTTP, HTTP_TOKEN, LOGS, ELSEWHERE, Store::LOCK, protocol::secret::FILE];
    let is_own = |name: &String| own.contains(&name.as_str());
    let mut foreign: Vec<String> = names.filter(|name| !name.starts_with('.') && !is_own(name)).collect();
    foreign.sort();
    if foreign.is_empty() {
        return Ok(());
    }
    let further = foreign.len().saturating_sub(NAMED);
    foreign.truncate(NAMED);
    foreign.extend((further > 0).then(|| format!("{further} more")));
    Err(Error::Usage(format!(
        "--out {}: this folder holds {}, and no run; name a folder that is new or empty",
        directory.display(),
        listed(&foreign)
    )))
}

/// Removes a run that holds nothing, with its folder if that was made for it.
pub fn discard(directory: &Path, is_new: bool) {
    // Missing is as good as removed.
    if is_new {
        let _ = std::fs::remove_dir_all(directory);
    } else {
        Store::discard(directory);
        let _ = std::fs::remove_file(directory.join(protocol::secret::FILE));
    }
}

/// Notes where the coordinator of a run is reached.
pub fn write_address(directory: &Path, endpoint: &str) -> io::Result<()> {
    let partial = directory.join(".address");
    std::fs::write(&partial, format!("{endpoint}\n"))?;
    std::fs::rename(partial, directory.join(ADDRESS))
}

/// Where the coordinator of a run was last reached.
pub fn read_address(directory: &Path) -> Option<String> {
    let text = std::fs::read_to_string(directory.join(ADDRESS)).ok()?;
    Some(text.trim().to_string()).filter(|endpoint| !endpoint.is_empty())
}

/// Nobody serves the run any more.
pub fn remove_address(directory: &Path) {
    // Missing is as good as removed.
    for file in [ADDRESS, HTTP] {
        let _ = std::fs::remove_file(directory.join(file));
    }
}

/// Notes where the run is served over HTTP, and with which token one may read there, in a file for its owner alone.
pub fn write_http(directory: &Path, url: &str, token: Option<&str>) -> io::Result<()> {
    let file = directory.join(HTTP_TOKEN);
    match std::fs::remove_file(&file) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    if let Some(token) = token {
        let mut file = std::fs::OpenOptions::new().write(true).create_new(true).mode(0o600).open(file)?;
        writeln!(file, "{token}")?;
    }
    let partial = directory.join(".http");
    std::fs::write(&partial, format!("{url}\n"))?;
    std::fs::rename(partial, directory.join(HTTP))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::tempdir;

    #[test]
    fn a_folder_with_files_of_others_is_refused() {
        let dir = tempdir().unwrap();
        let out = dir.path().join("out");
        let elsewhere = dir.path().join("study.toml");
        let refused = || refuse_foreign(&out, &elsewhere).map_err(|error| error.to_string());
        assert_eq!(refused(), Ok(()));
        std::fs::create_dir(&out).unwrap();
        let add = |names: &[&str]| names.iter().for_each(|name| std::fs::write(out.join(name), "").unwrap());
        // Empty for all that people see, or but for what a discarded run has left.
        add(&[".hidden", "lock", "secret"]);
        assert_eq!(refused(), Ok(()));
        add(&["b.csv", "a.txt"]);
        let message = |names: &str| {
            Err(format!(
                "--out {}: this folder holds {names}, and no run; name a folder that is new or empty",
                out.display()
            ))
        };
        assert_eq!(refused(), message("a.txt and b.csv"));
        add(&["c", "d", "e"]);
        assert_eq!(refused(), message("a.txt, b.csv, c and 2 more"));
        // Beside the study itself; and a run is refused by whoever would create another one.
        assert!(refuse_foreign(&out, &out.join("c")).is_ok());
        add(&[FILE]);
        assert_eq!(refused(), Ok(()));
    }
}
