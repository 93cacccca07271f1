//! One coordinator per run: a lock that ends with the process that holds it, and says who that is.
//!
//! The lock of the system need not reach other machines. So who holds it is written down, and that it lives by the time at which
//! the file was changed.

use super::StoreError;
use super::error::At;
use super::holder::Holder;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::{Duration, Instant, SystemTime};

/// Name of the file that is locked.
pub(super) const LOCK: &str = "lock";

/// Time between two signs of life.
const BEAT: Duration = Duration::from_secs(5);

/// A holder without a sign of life for so long is gone: machines' clocks may differ by less.
const SILENCE: Duration = Duration::from_secs(60);

/// The lock of a run; released when dropped.
#[derive(Debug)]
pub(super) struct RunLock {
    file: File,
    beat: Instant,
}

impl RunLock {
    /// Locks folder `dir`.
    pub fn take(dir: &Path) -> Result<Self, StoreError> {
        let path = dir.join(LOCK);
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).at(&path)?;
        let locked = |holder| Err(StoreError::Locked { dir: dir.into(), holder });
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return locked(noted(&mut file)),
            Err(TryLockError::Error(source)) => return Err(StoreError::from_io(&path, source)),
        }
        // This machine's locks are those of the system; another's may not be seen here.
        if let Some(holder) = noted(&mut file).filter(|holder| !holder.is_here && is_alive(&file)) {
            return locked(Some(holder));
        }
        note_holder(&mut file).at(&path)?;
        Ok(Self { file, beat: Instant::now() })
    }

    /// Gives a sign of life, if the last one was long ago.
    pub fn beat(&mut self) {
        if self.beat.elapsed() >= BEAT {
            self.beat = Instant::now();
            // Where times cannot be set, other machines know no better.
            let _ = self.file.set_modified(SystemTime::now());
        }
    }
}

impl Drop for RunLock {
    fn drop(&mut self) {
        // Nobody holds it any more; somebody who crashed is told by silence.
        let _ = self.file.set_len(0);
    }
}

/// Who conducts the run in folder `dir`, as far as can be told from here; `None` if nobody does.
pub(super) fn holder_of(dir: &Path) -> Option<Holder> {
    let mut file = File::open(dir.join(LOCK)).ok()?;
    let holder = noted(&mut file)?;
    let is_held =
        if holder.is_here { matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)) } else { is_alive(&file) };
    is_held.then_some(holder)
}

/// Writes down who holds the lock.
fn note_holder(file: &mut File) -> std::io::Result<()> {
    file.set_len(0)?;
    file.seek(SeekFrom::Start(0))?;
    writeln!(file, "{} {}", std::process::id(), host())?;
    file.flush()
}

fn noted(file: &mut File) -> Option<Holder> {
    let mut text = String::new();
    file.read_to_string(&mut text).ok()?;
    let mut words = text.split_whitespace();
    let pid = words.next()?.parse().ok()?;
    // Earlier programs noted the process alone.
    let host = words.next().map_or_else(host, str::to_string);
    Some(Holder { pid, is_here: host == self::host(), host })
}

fn is_alive(file: &File) -> bool {
    let changed = file.metadata().and_then(|metadata| metadata.modified());
    changed.is_ok_and(|changed| SystemTime::now().duration_since(changed).is_ok_and(|age| age < SILENCE))
}

/// The name of this machine.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    if name.trim().is_empty() { "localhost".into() } else { name.trim().into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinator_on_another_machine() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(LOCK);
        std::fs::write(&path, "77 elsewhere\n").unwrap();
        let elsewhere = Holder { pid: 77, host: "elsewhere".into(), is_here: false };
        assert_eq!(holder_of(dir.path()), Some(elsewhere.clone()));
        match RunLock::take(dir.path()) {
            Err(StoreError::Locked { holder, .. }) => assert_eq!(holder, Some(elsewhere)),
            other => panic!("{other:?}"),
        }
        // It has given no sign of life for long.
        let file = File::options().write(true).open(&path).unwrap();
        file.set_modified(SystemTime::now() - 2 * SILENCE).unwrap();
        assert_eq!(holder_of(dir.path()), None);
        let lock = RunLock::take(dir.path()).unwrap();
        let here = holder_of(dir.path()).unwrap();
        assert!(here.is_here && here.pid == std::process::id(), "{here:?}");
        assert!(matches!(RunLock::take(dir.path()), Err(StoreError::Locked { .. })));
        drop(lock);
        assert_eq!(holder_of(dir.path()), None);
    }
}
