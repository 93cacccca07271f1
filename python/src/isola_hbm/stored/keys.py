"""Branches by their names: where they are in the file, and what there is instead."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from ..counted import is_same
from .orders import SEPARATOR
from .store import Reading, Row, Store
from .verified import name_of

#: A branch: ``"60/isola 1"``, or forcing amplitude (as typed or as a number) and name.
Key: TypeAlias = "str | tuple[str | float, str]"

#: Levels and branches that a message names.
_NAMED = 12


def parts(key: object) -> tuple[str | float, str] | None:
    """Forcing amplitude and name of a branch; `None` of what is not written as a branch is."""
    if isinstance(key, tuple) and len(key) == 2 and isinstance(key[1], str):
        return key
    if isinstance(key, str) and "/" in key:
        amplitude, _, name = key.partition("/")
        return amplitude, name
    return None


def find(reading: Reading, key: object) -> tuple[Row, float] | None:
    """The row of a branch, and its forcing amplitude A."""
    amplitude, name = parts(key) or (None, "")
    for level in reading.rows_of("levels", "") if name else ():
        if _is_amplitude(amplitude, level["amplitude"], level["value"]):
            where = "WHERE level = ? AND kind = ? AND number = ?"
            for row in reading.rows_of("branches", where, level["level"], *_kind_and_number(name)):
                return row, level["value"]
    return None


def _kind_and_number(name: str) -> tuple[str, int]:
    kind, _, number = name.strip().partition(" ")
    return kind, int(number) if number.isdecimal() else 0 if number else 1


def _is_amplitude(wanted: object, text: str, value: float) -> bool:
    if wanted == text or wanted == value:
        return True
    try:
        return is_same(float(wanted), value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return False


def other_order(reading: Reading, order: int) -> str | None:
    """What tells of motions of this order, if that is another one which the run has."""
    store = reading.store
    return f"load(folder, order={order})" if store.order != order and order in store.orders() else None


def missing(reading: Reading, key: object) -> str:
    """That there is no such branch, what there is instead, and how that is written."""
    branches = reading.rows(
        "SELECT branches.*, value FROM branches JOIN levels USING (level) "
        "ORDER BY value, kind != 'main', kind, number"
    )
    levels = reading.column("SELECT amplitude FROM levels ORDER BY value")
    there = f"levels are {_listed(levels)}"
    if (pair := parts(key)) is None:
        return _incomplete(key, branches, there)
    amplitude, name = pair
    level, separator, order = str(amplitude).partition(SEPARATOR)
    if separator and order.isdecimal() and (how := other_order(reading, int(order))):
        return f'motions of order {order} are those of {how}, there "{level}/{name}"; this tells of another order'
    here = [name_of(row) for row in branches if _is_amplitude(amplitude, row["amplitude"], row["value"])]
    instead = f"there are {_listed(here)}" if here else there
    return f"there is no branch `{name}` at A = {amplitude}; {instead}{_elsewhere(reading, key)}"


def _elsewhere(reading: Reading, key: object) -> str:
    """How a branch is read that another order of motions of the run has under this name."""
    store = reading.store
    for order in (None, *store.orders()):
        if order == store.order:
            continue
        with Store(store.file, order).read() as other:
            if find(other, key) is not None:
                which, how = ("the first order", "") if order is None else (f"order {order}", f", order={order}")
                return f"; there is one of {which}: load(folder{how})"
    return ""


def _incomplete(key: object, branches: Sequence[Row], levels: str) -> str:
    """The same of a key that is a level alone, a name alone, or neither."""
    if not branches:
        return f"`{key}` is no branch, and the run has none yet; {levels}"
    if here := [row for row in branches if _is_amplitude(key, row["amplitude"], row["value"])]:
        return f"`{key}` is a level, with {_listed([name_of(row) for row in here])}: {_written(here[-1])}"
    named = [row for row in branches if isinstance(key, str) and _kind_and_number(key) == (row["kind"], row["number"])]
    if named:
        at = _listed([row["amplitude"] for row in named])
        return f"`{key}` is a branch at A = {at}: {_written(named[0])}"
    names = _listed(list(dict.fromkeys(name_of(row) for row in branches)))
    return f"`{key}` is no level and no branch; {levels}, branches {names}: {_written(branches[-1])}"


def _written(row: Row) -> str:
    """How a branch that there is is written."""
    name, amplitude = name_of(row), row["amplitude"]
    return f'write run["{amplitude}/{name}"] or run[{amplitude}, "{name}"]'


def _listed(texts: Sequence[str]) -> str:
    return ", ".join(texts[:_NAMED]) + (", …" if len(texts) > _NAMED else "")
