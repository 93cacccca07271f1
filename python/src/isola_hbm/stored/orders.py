"""A run by orders of motions: those of order m last m periods of the force. A reading tells of one of them, as of a run of its own."""

from __future__ import annotations

import sqlite3

#: What stands between amplitude and order in the name of a level: ``60-m3``. Levels of a run's first order are named by amplitudes alone.
SEPARATOR = "-m"

#: Tables with what selects their rows by their levels; those of branches and curves after these.
_VIEWS = {
    "branches": "level IN (SELECT level FROM levels)",
    "tasks": "level IN (SELECT level FROM levels)",
    "windows": "level IN (SELECT level FROM levels)",
    "results": "task IN (SELECT id FROM tasks)",
    "curves": "task IN (SELECT id FROM tasks)",
    "curve_points": "curve IN (SELECT number FROM curves)",
    "points": "branch IN (SELECT id FROM branches)",
    "verifications": "branch IN (SELECT id FROM branches)",
    "verified_points": "task IN (SELECT task FROM verifications)",
    "bifurcations": "task IN (SELECT task FROM verifications)",
    "motions": "branch IN (SELECT id FROM branches)",
    "pushes": "branch IN (SELECT id FROM branches)",
}


def orders_of(db: sqlite3.Connection) -> list[int]:
    """Orders of motions that a run has beyond its first one, ascending."""
    names = [name for (name,) in db.execute("SELECT amplitude FROM main.levels")]
    found = {name.rpartition(SEPARATOR)[2] for name in names if isinstance(name, str) and SEPARATOR in name}
    return sorted(int(order) for order in found if order.isdecimal())


def tell_of(db: sqlite3.Connection, order: int | None) -> None:
    """Lets a connection see one order alone, None being the first: names of tables mean what they have of it."""
    suffix = "" if order is None else f"{SEPARATOR}{order}"
    which = f"NOT LIKE '%{SEPARATOR}%'" if order is None else f"LIKE '%{suffix}'"
    there = {name for (name,) in db.execute("SELECT name FROM main.sqlite_master WHERE type = 'table'")}
    db.execute(
        f"CREATE TEMP VIEW levels AS SELECT level, substr(amplitude, 1, length(amplitude) - {len(suffix)}) AS amplitude, value "
        f"FROM main.levels WHERE amplitude {which}"
    )
    for table, rows in _VIEWS.items():
        if table in there:
            db.execute(f"CREATE TEMP VIEW {table} AS SELECT * FROM main.{table} WHERE {rows}")
    if order is not None:
        # Tables hold the backbones of the first order.
        for table in there & {"modes", "backbone"}:
            db.execute(f"CREATE TEMP VIEW {table} AS SELECT * FROM main.{table} WHERE 0")
