//! Connections to the file, and what tells it from other files.

use super::error::At;
use super::points_table::schema;
use super::{FILE, StoreError};
use rusqlite::{Connection, ErrorCode, OpenFlags};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Marks files of this program: "ISOL".
pub(super) const APPLICATION: i64 = 0x4953_4F4C;
/// Version of the schema. Earlier ones are read; runs of theirs do not go on.
pub(super) const VERSION: i64 = 13;
/// The first one: `branches` ends with the range of contact, branches that are not main ones are all called isolas. The second
/// one knows the backbone of one mode, and no fold curves. The third one has no verifications. The
/// fifth one keeps no steps of tasks under way, and no ranges with twice the harmonics. The sixth one lists no branches that branch off
/// others. The seventh one says of a main branch that begins where the response is not linear that it does so at a bound. The eighth
/// one has no births and merges with twice the harmonics.
const FIRST: i64 = 1;
/// How long a connection waits for another one.
const PATIENCE: Duration = Duration::from_secs(10);
/// Large enough for arrays, small enough for records.
const PAGE: i64 = 8192;

/// Pages in the log before they are copied to where they belong, 32 MB: with the usual 8 MB the disk is waited for after every
/// few results.
const LOG: i64 = 4096;

/// Creates a file with the tables of a run.
pub(super) fn create(file: &Path) -> Result<Connection, StoreError> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = connect(file, flags)?;
    connection.pragma_update(None, "page_size", PAGE).at(file)?;
    connection.pragma_update(None, "application_id", APPLICATION).at(file)?;
    connection.pragma_update(None, "user_version", VERSION).at(file)?;
    connection.execute_batch(&schema()).at(file)?;
    Ok(connection)
}

/// Opens the run in `dir` for writing, checked from end to end.
pub(super) fn open_to_write(dir: &Path) -> Result<Connection, StoreError> {
    let file = existing(dir)?;
    let connection = connect(&file, OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
    let found = identify(&connection, &file)?;
    if found < VERSION {
        return Err(StoreError::Older { file, found, known: VERSION });
    }
    let mode: String = connection.pragma_update_and_check(None, "journal_mode", "WAL", |row| row.get(0)).at(&file)?;
    connection.pragma_update(None, "wal_autocheckpoint", LOG).at(&file)?;
    if mode != "wal" {
        let source = std::io::Error::other("this file system has no shared memory, use a local disk");
        return Err(StoreError::Io { file, source });
    }
    let check: String = connection.query_row("PRAGMA quick_check(1)", [], |row| row.get(0)).at(&file)?;
    if check != "ok" {
        return Err(StoreError::Corrupt { file, detail: check });
    }
    Ok(connection)
}

/// Opens the run in `dir` for reading, next to whoever writes.
pub(super) fn open_to_read(dir: &Path) -> Result<Connection, StoreError> {
    let file = existing(dir)?;
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = connect(&file, flags)?;
    match identify(&connection, &file) {
        Ok(_) => Ok(connection),
        Err(StoreError::Sqlite { source, .. }) if needs_shared_memory(&source) => {
            if has_log(&file) {
                Err(interrupted(file))
            } else {
                open_immutable(&file)
            }
        }
        Err(StoreError::Corrupt { .. }) => {
            // Of a file that was cut short SQLite reads what is left only if it is told not to insist on its size.
            connection.pragma_update(None, "writable_schema", true).at(&file)?;
            identify(&connection, &file)?;
            Ok(connection)
        }
        Err(error) => Err(error),
    }
}

/// What was committed last is in a log that cannot be read where nothing can be written.
fn interrupted(file: PathBuf) -> StoreError {
    let source = std::io::Error::other("the run was interrupted here, copy its folder to where you may write");
    StoreError::Io { file, source }
}

/// Opens a file in a folder that cannot be written to; nobody else writes it either.
pub(super) fn open_immutable(file: &Path) -> Result<Connection, StoreError> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
    let path = std::path::absolute(file).at(file)?;
    let escaped: String = path.display().to_string().chars().map(escape).collect();
    let connection = Connection::open_with_flags(format!("file:{escaped}?immutable=1"), flags).at(file)?;
    identify(&connection, file)?;
    Ok(connection)
}

fn escape(c: char) -> String {
    match c {
        '%' => "%25".into(),
        '?' => "%3f".into(),
        '#' => "%23".into(),
        c => c.to_string(),
    }
}

fn needs_shared_memory(error: &rusqlite::Error) -> bool {
    matches!(error.sqlite_error_code(), Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly))
}

/// Whether there are commits that are not in the file itself yet.
fn has_log(file: &Path) -> bool {
    let log = file.with_extension("sqlite-wal");
    log.metadata().is_ok_and(|metadata| metadata.len() > 0)
}

fn existing(dir: &Path) -> Result<PathBuf, StoreError> {
    let file = dir.join(FILE);
    if file.is_file() { Ok(file) } else { Err(StoreError::Missing { file }) }
}

fn connect(file: &Path, flags: OpenFlags) -> Result<Connection, StoreError> {
    let connection = Connection::open_with_flags(file, flags).at(file)?;
    connection.busy_timeout(PATIENCE).at(file)?;
    connection.set_prepared_statement_cache_capacity(64);
    connection.pragma_update(None, "foreign_keys", true).at(file)?;
    Ok(connection)
}

/// Version of the schema.
pub(super) fn version(connection: &Connection, file: &Path) -> Result<i64, StoreError> {
    connection.pragma_query_value(None, "user_version", |row| row.get(0)).at(file)
}

/// Whether this is a run, in a format that is known: in which version.
fn identify(connection: &Connection, file: &Path) -> Result<i64, StoreError> {
    let application = connection.pragma_query_value(None, "application_id", |row| row.get::<_, i64>(0)).at(file)?;
    if application != APPLICATION {
        let found = "an SQLite file of another program".to_string();
        return Err(StoreError::Foreign { file: file.into(), found });
    }
    match version(connection, file)? {
        found @ FIRST..=VERSION => Ok(found),
        found if found < FIRST => {
            Err(StoreError::Foreign { file: file.into(), found: format!("version {found} of its format never was") })
        }
        found => Err(StoreError::Newer { file: file.into(), found, known: VERSION }),
    }
}
