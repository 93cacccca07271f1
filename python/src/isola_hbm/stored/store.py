"""The store of a run, ``run.sqlite``: opened for reading, beside whoever writes it. All SQL of this package uses it."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import Damaged, IsolaError, NoSuchRun, OtherVersion
from ..live.wire import Floats
from .orders import orders_of, tell_of

#: The file of a run, in its folder.
FILE = "run.sqlite"
#: Marks files of Isola: "ISOL".
APPLICATION = 0x49534F4C
#: Versions of the schema that are read. Version 1 has no `peak_standing` and what follows it in `branches`; 1 and 2 know one
#: backbone and no fold curves.
VERSIONS = range(1, 14)
#: What SQLite raises of a damaged file; texts of it are not always texts.
ERRORS = (sqlite3.DatabaseError, UnicodeDecodeError)
#: How long to wait for whoever writes, s.
PATIENCE = 10.0

#: A row by names of columns.
Row = dict[str, Any]
#: A column of numbers or of texts.
Values = NDArray[Any]


class Store:
    """Where the store is, and how it is opened. Holds no connection: nothing of a run in progress is kept busy."""

    def __init__(self, where: str | PathLike[str], order: int | None = None) -> None:
        path = Path(where)
        #: The order of motions that is told of; None for the first.
        self.order = order
        #: The file.
        self.file = path if path.name == FILE and not path.is_dir() else path / FILE
        #: Folder of the run.
        self.folder = self.file.parent
        if path.is_file() and path != self.file:
            raise NoSuchRun(f"{path}: a file; name the folder of a run, which holds `{FILE}`")
        if not self.file.is_file():
            raise NoSuchRun(
                f"{self.file}: there is no such file; name the folder of a run, which holds `{FILE}`"
            )

    @contextmanager
    def read(self) -> Iterator[Reading]:
        """A reading: everything in it is of one moment."""
        db = self._open()
        try:
            if self.order is not None or self._has_orders(db):
                tell_of(db, self.order)
            db.execute("BEGIN")
            yield Reading(self, db)
        except ERRORS as error:
            raise self.error(error) from error
        finally:
            db.close()

    def orders(self) -> list[int]:
        """Orders of motions that the run has beyond its first one."""
        db = self._open()
        try:
            return orders_of(db)
        except ERRORS as error:
            raise self.error(error) from error
        finally:
            db.close()

    def _has_orders(self, db: sqlite3.Connection) -> bool:
        try:
            return bool(orders_of(db))
        except ERRORS:
            # What is damaged is told of where it is read.
            return False

    def _open(self) -> sqlite3.Connection:
        try:
            return self._identified("mode=ro")
        except sqlite3.OperationalError as error:
            # A log without shared memory: SQLite wants to write beside the file.
            if not any(text in str(error) for text in ("unable to open", "readonly")):
                raise self.error(error) from error
            if self._has_log():
                raise IsolaError(
                    f"{self.file}: the run was interrupted here, copy its folder to where you may write"
                ) from error
        except ERRORS as error:
            raise self.error(error) from error
        try:
            return self._identified("immutable=1")
        except ERRORS as error:
            raise self.error(error) from error

    def _identified(self, parameters: str) -> sqlite3.Connection:
        uri = f"{self.file.absolute().as_uri()}?{parameters}"
        db = sqlite3.connect(uri, uri=True, timeout=PATIENCE, isolation_level=None)
        try:
            try:
                self._identify(db)
            except sqlite3.DatabaseError as error:
                if "malformed" not in str(error):
                    raise
                # Of a file that was cut short SQLite reads what is left only if it is told not to insist on its size.
                db.execute("PRAGMA writable_schema = ON")
                self._identify(db)
        except BaseException:
            db.close()
            raise
        return db

    def _identify(self, db: sqlite3.Connection) -> None:
        """Raises unless this is a run in a known format."""
        (application,) = db.execute("PRAGMA application_id").fetchone()
        (version,) = db.execute("PRAGMA user_version").fetchone()
        if application != APPLICATION:
            size = self.file.stat().st_size
            # Shorter than the head of the format: SQLite takes it for a new file.
            if size < 100 and not self._has_log():
                raise self._foreign(f"a file of {size} bytes: not begun, or cut short")
            raise self._foreign("an SQLite file of another program")
        if version < VERSIONS.start:
            raise self._foreign(f"version {version} of its format never was")
        if version >= VERSIONS.stop:
            raise OtherVersion(
                f"{self.file}: written in version {version} of the format, this package knows version "
                f"{VERSIONS.stop - 1}; use a newer `isola-hbm`"
            )

    def _has_log(self) -> bool:
        """Whether there are commits that are not in the file itself yet."""
        log = self.file.with_name(f"{FILE}-wal")
        return log.is_file() and log.stat().st_size > 0

    def _foreign(self, found: str) -> NoSuchRun:
        return NoSuchRun(f"{self.file}: this is not a run of Isola ({found}); name the folder of a run")

    def error(self, error: Exception) -> IsolaError:
        """An error of SQLite, told apart."""
        if "not a database" in str(error):
            return self._foreign("not an SQLite file")
        if isinstance(error, sqlite3.OperationalError) and "locked" in str(error):
            return IsolaError(f"{self.file}: {error} for {PATIENCE:g} s; stop whatever holds it")
        return Damaged(self.file, error)


def _values(column: list[Any]) -> Values:
    """A column of numbers, or of texts."""
    if any(isinstance(value, (str, bytes)) for value in column):
        return np.array(["" if value is None else value for value in column], dtype=object)
    return np.array(column, dtype=np.float64)


class Reading:
    """A connection in a transaction: what it reads is of one moment. Everything raises :class:`Damaged`."""

    def __init__(self, store: Store, db: sqlite3.Connection) -> None:
        self.store = store
        self._db = db
        (self.version,) = self._fetch("PRAGMA user_version")[1][0]

    def _fetch(
        self, sql: str, parameters: tuple[object, ...] = ()
    ) -> tuple[list[str], list[tuple[Any, ...]]]:
        """Names of columns, and rows."""
        try:
            cursor = self._db.execute(sql, parameters)
            return [column[0] for column in cursor.description], cursor.fetchall()
        except ERRORS as error:
            raise self.store.error(error) from error

    def rows(self, sql: str, *parameters: object) -> list[Row]:
        """The rows that `sql` selects, by names of columns."""
        names, rows = self._fetch(sql, parameters)
        return [dict(zip(names, row)) for row in rows]

    def rows_of(self, table: str, rest: str, *parameters: object) -> list[Row]:
        """Rows of a table, whose columns of numbers hold numbers; `rest` says which, and in what order."""
        rows = self.rows(f"SELECT * FROM {table} {rest}", *parameters)
        sql = "SELECT name FROM pragma_table_info(?) WHERE type IN ('REAL', 'INTEGER')"
        numbers = self.column(sql, table) if rows else []
        for row in rows:
            for name in numbers:
                if not isinstance(row[name], (int, float, type(None))):
                    raise Damaged(self.store.file, f"`{name}` in the table `{table}` is no number")
        return rows

    def one(self, sql: str, *parameters: object) -> Row | None:
        """The first of them, if any."""
        return next(iter(self.rows(sql, *parameters)), None)

    def column(self, sql: str, *parameters: object) -> list[Any]:
        """The first column of the rows that `sql` selects."""
        return [row[0] for row in self._fetch(sql, parameters)[1]]

    def arrays(self, sql: str, *parameters: object) -> dict[str, Values]:
        """The columns of the rows that `sql` selects, by name: numbers, NULL being NaN, or texts, NULL being empty."""
        names, rows = self._fetch(sql, parameters)
        try:
            numbers = np.array(rows, dtype=np.float64).reshape(len(rows), len(names))
        except (TypeError, ValueError):
            return {name: _values([row[i] for row in rows]) for i, name in enumerate(names)}
        return {name: np.ascontiguousarray(numbers[:, i]) for i, name in enumerate(names)}

    def columns(self, table: str) -> list[str]:
        """Names of the columns of a table; none if there is no such table."""
        return self.column("SELECT name FROM pragma_table_info(?)", table)

    def definition(self, table: str) -> str:
        """How the file itself defines a table, comments included; empty if there is no such table."""
        sql = "SELECT sql FROM sqlite_master WHERE type = 'table' AND name = ?"
        return next(iter(self.column(sql, table)), None) or ""

    def fact(self, key: str) -> Any:
        """A fact that holds for the whole run, from the table `meta`; None if it is not known (yet)."""
        return next(iter(self.column("SELECT value FROM meta WHERE key = ?", key)), None)

    def shapes(self, owner: str) -> dict[str, tuple[int, ...]]:
        """Shapes of all arrays of the model, a backbone or the task of a branch, without reading them."""
        sql = "SELECT name, shape FROM arrays WHERE owner = ?"
        return {row["name"]: self._shape(owner, row) for row in self.rows(sql, owner)}

    def array(self, owner: str, name: str) -> Floats:
        """One array, read-only."""
        sql = "SELECT name, dtype, shape, data FROM arrays WHERE owner = ? AND name = ?"
        row = self.one(sql, owner, name)
        if row is None:
            raise Damaged(self.store.file, f"the array `{name}` of {owner} is gone")
        if row["dtype"] != "<f8":
            raise Damaged(self.store.file, f"the array `{name}` of {owner} has the type `{row['dtype']}`")
        try:
            return np.frombuffer(row["data"], "<f8").reshape(self._shape(owner, row))
        except (TypeError, ValueError) as error:
            raise Damaged(self.store.file, f"the array `{name}` of {owner}: {error}") from error

    def _shape(self, owner: str, row: Row) -> tuple[int, ...]:
        try:
            return tuple(int(length) for length in json.loads(row["shape"]))
        except (TypeError, ValueError) as error:
            raise Damaged(self.store.file, f"the shape of `{row['name']}` of {owner}: {error}") from error

    def check(self) -> None:
        """Raises with the first place where tables and indices of the file do not hang together."""
        (found,) = self.column("PRAGMA quick_check(1)")
        if found != "ok":
            raise Damaged(self.store.file, found)
