"""Branches by their names: where they are in the file, and what there is instead."""

from __future__ import annotations

from typing import TypeAlias

from ..errors import NoSuchBranch
from .orders import SEPARATOR
from .store import Reading, Row
from .verified import name_of

#: A branch: ``"60/isola 1"``, or forcing amplitude (as typed or as a number) and name.
Key: TypeAlias = "str | tuple[str | float, str]"


def parts(key: object) -> tuple[str | float, str]:
    """Forcing amplitude and name of a branch."""
    if isinstance(key, tuple) and len(key) == 2 and isinstance(key[1], str):
        return key
    if isinstance(key, str) and "/" in key:
        amplitude, _, name = key.partition("/")
        return amplitude, name
    raise NoSuchBranch(f'{key!r} is no branch: write "60/isola 1", or 60, "isola 1"')


def find(reading: Reading, amplitude: str | float, name: str) -> tuple[Row, float] | None:
    """The row of a branch, and its forcing amplitude A."""
    for level in reading.rows_of("levels", ""):
        if _is_amplitude(amplitude, level["amplitude"], level["value"]):
            where = "WHERE level = ? AND kind = ? AND number = ?"
            for row in reading.rows_of("branches", where, level["level"], *_kind_and_number(name)):
                return row, level["value"]
    return None


def _kind_and_number(name: str) -> tuple[str, int]:
    kind, _, number = name.strip().partition(" ")
    return kind, int(number) if number.isdecimal() else 0 if number else 1


def _is_amplitude(wanted: str | float, text: str, value: float) -> bool:
    if wanted == text or wanted == value:
        return True
    try:
        return float(wanted) == value
    except ValueError:
        return False


def other_order(reading: Reading, order: int) -> str | None:
    """What tells of motions of this order, if that is another one which the run has."""
    store = reading.store
    return f"load(folder, order={order})" if store.order != order and order in store.orders() else None


def missing(reading: Reading, amplitude: str | float, name: str) -> str:
    """That there is no such branch, and what there is instead."""
    level, separator, order = str(amplitude).partition(SEPARATOR)
    if separator and order.isdecimal() and (how := other_order(reading, int(order))):
        return f'motions of order {order} are those of {how}, there "{level}/{name}"; this tells of another order'
    rows = reading.rows("SELECT branches.*, value FROM branches JOIN levels USING (level)")
    there = [name_of(row) for row in rows if _is_amplitude(amplitude, row["amplitude"], row["value"])]
    texts = reading.column("SELECT amplitude FROM levels ORDER BY value")
    levels = f"levels are {', '.join(texts[:12])}" + (", …" if len(texts) > 12 else "")
    instead = f"there are {', '.join(there)}" if there else levels
    return f"there is no branch `{name}` at A = {amplitude}; {instead}"
