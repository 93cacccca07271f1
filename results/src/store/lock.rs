//! One coordinator per run: a lock that ends with the process that holds it.

use super::StoreError;
use super::error::At;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Name of the file that is locked.
pub(super) const LOCK: &str = "lock";

/// The lock of a run; released when dropped.
#[derive(Debug)]
pub(super) struct RunLock {
    _file: File,
}

impl RunLock {
    /// Locks folder `dir`.
    pub fn take(dir: &Path) -> Result<Self, StoreError> {
        let path = dir.join(LOCK);
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).at(&path)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(StoreError::Locked { dir: dir.into(), pid: holder(&mut file) });
            }
            Err(TryLockError::Error(source)) => return Err(StoreError::from_io(&path, source)),
        }
        note_holder(&mut file).at(&path)?;
        Ok(Self { _file: file })
    }
}

/// Writes down who holds the lock.
fn note_holder(file: &mut File) -> std::io::Result<()> {
    file.set_len(0)?;
    file.seek(SeekFrom::Start(0))?;
    writeln!(file, "{}", std::process::id())?;
    file.flush()
}

fn holder(file: &mut File) -> Option<u32> {
    let mut text = String::new();
    file.read_to_string(&mut text).ok()?;
    text.trim().parse().ok()
}
