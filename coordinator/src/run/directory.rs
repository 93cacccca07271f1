//! The folder of a run: where it is, and how to reach whoever serves it.

use results::store::Store;
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
