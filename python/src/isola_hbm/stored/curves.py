"""Branches and backbones of the store as :class:`Motions`."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..errors import Damaged
from ..live.wire import Floats
from .columns import HARMONIC, Column, documented
from .levels import Omissions, levels, named
from .motions import Later, Motions, Source, lazily
from .names import Names
from .store import Reading, Row, Store, Values
from .verified import name_of, table, verified

#: Columns of a row of `branches` that say where something is in the file.
_INTERNAL = {"id", "level", "amplitude", "special"}
#: What is known of a result beside its branch.
_RESULT = "SELECT attempt, worker, program, seconds FROM results WHERE task = ?"
#: Arrays of motions whose columns have other names.
_RENAMED = {"zeta": "decay"}


def branch(reading: Reading, row: Row, level_value: float, names: Names) -> Motions:
    """The branch that `row` of the table of branches describes."""
    of = _Curve(reading, row["task"], "points", "branch", row["id"])
    attributes = {
        "name": name_of(row),
        "level": row["amplitude"],
        "level_value": level_value,
        **{name: value for name, value in row.items() if name not in _INTERNAL and value is not None},
        "closed": bool(row["closed"]),
        **special(reading, row),
        **(reading.one(_RESULT, row["task"]) or {}),
    }
    return of.motions(names, attributes, _OfBranch(reading.store, row))


def backbone(reading: Reading, mode: int, owner: str, outcome: str, names: Names) -> Motions:
    """The backbone of a mode, from 1, whose arrays have this owner."""
    of = _Curve(reading, owner, "backbone", "mode", mode)
    attributes = {"name": f"backbone of mode {mode}", "mode": mode, "status": outcome}
    return of.motions(names, attributes, _OfOwner(reading.store, owner))


def special(reading: Reading, row: Row) -> dict[str, Any]:
    """Start, peak and folds of a branch, as indices of points."""
    try:
        points = [(point["kind"], int(point["index"])) for point in json.loads(row["special"])]
    except (TypeError, ValueError, LookupError) as error:
        raise Damaged(reading.store.file, f"the special points of {name_of(row)}: {error}") from error
    ones = {kind: index for kind, index in points if kind != "fold"}
    return {**ones, "folds": [index for kind, index in points if kind == "fold"]}


def folds(reading: Reading, omissions: Omissions) -> dict[str, list[int]]:
    """Points at which branches turn back, as indices, by the names of these."""
    found = {}
    for level in levels(reading, omissions):
        for row in level.branches:
            name = named(level, row)
            points = omissions.attempt(f"The folds of branch {name} are", partial(special, reading, row))
            found[name] = points["folds"] if points else []
    return found


@dataclass(frozen=True)
class _Curve:
    """Where the numbers of a curve are: owner of its arrays, and table, column and key of its points."""

    reading: Reading
    owner: str
    table: str
    key: str
    of: int

    def motions(self, names: Names, attributes: dict[str, Any], source: Source) -> Motions:
        """As a dataset."""
        shapes = self.reading.shapes(self.owner)
        known = documented(self.reading, self.table)
        columns = self.columns(shapes)
        count = len(columns["omega"])
        variables: dict[str, xr.Variable] = {}
        for name, values in columns.items():
            what = known.get(name, Column(name))
            axes = ("point", *_axes(what, name, values.ndim - 1))
            self.require(name, values.shape, values.ndim == len(axes) and len(values) == count)
            variables[name] = xr.Variable(axes, values, what.attributes)
        for name in HARMONIC:
            shape = shapes.get(name, ())
            self.require(name, shape, len(shape) == 4 and shape[0] == count)
            axes = ("point", *(known[name].axes or ()), "harmonic")
            variables[name] = lazily(axes, Later(source, name, shape[:-1]), known[name].attributes)
        place = {name: i for i, name in enumerate(known)}
        variables = dict(sorted(variables.items(), key=lambda item: place.get(item[0], len(place))))
        return _with_coordinates(variables, names, attributes)

    def require(self, name: str, shape: tuple[int, ...], fits: bool) -> None:
        """Raises unless an array is there and has the shape that it is to have."""
        if not fits:
            what = f"has the shape {shape}" if shape else "is gone"
            raise Damaged(self.reading.store.file, f"the array `{name}` of {self.owner} {what}")

    def columns(self, shapes: dict[str, tuple[int, ...]]) -> dict[str, Values]:
        """Everything but harmonics: from arrays and, what is not among them, from the table."""
        arrays = {name: self.reading.array(self.owner, name) for name in shapes if name not in HARMONIC}
        held = [name for name in self.reading.columns(self.table) if name not in (self.key, "i")]
        held = [name for name in held if _RENAMED.get(name, name) not in arrays]
        rows = table(self.reading, self.table, self.key, self.of, held)
        found = {_RENAMED.get(name, name): values for name, values in rows.items()}
        if "omega" not in found | arrays:
            raise Damaged(self.reading.store.file, f"the points of {self.owner} are gone")
        return {**found, **arrays}


def _axes(what: Column, name: str, count: int) -> tuple[str, ...]:
    """Names of the axes after that of the points: of an array that the file does not document, its own."""
    return tuple(f"{name}_{axis}" for axis in range(1, count + 1)) if what.axes is None else what.axes


def _with_coordinates(variables: dict[str, xr.Variable], names: Names, attributes: dict[str, Any]) -> Motions:
    """The dataset; ω and names along axes are its coordinates."""
    lengths = {str(axis): n for variable in variables.values() for axis, n in variable.sizes.items()}
    found = {axis: names.along(axis, length) for axis, length in lengths.items()}
    coordinates: dict[Any, Any] = {axis: along for axis, along in found.items() if along is not None}
    coordinates["omega"] = variables.pop("omega")
    if "channel" in coordinates:
        coordinates["unit"] = xr.Variable("channel", np.array(names.units, dtype=str))
    return Motions(variables, coordinates, attributes)


def _complex(values: Floats) -> NDArray[np.complex128]:
    """Real and imaginary parts, the last axis, as complex numbers: the same bytes."""
    return values.view(np.complex128)[..., 0]


class _OfBranch(Source):
    """Harmonics of a branch, compared with what was announced when it was found."""

    def __init__(self, store: Store, row: Row) -> None:
        self._store = store
        self._row = row

    def read(self) -> dict[str, NDArray[np.complex128]]:
        with self._store.read() as reading:
            arrays = verified(reading, self._row)
            arrays["displacement"] = reading.array(self._row["task"], "displacement")
        return {name: _complex(arrays[name]) for name in HARMONIC}


class _OfOwner(Source):
    """Harmonics as they are stored."""

    def __init__(self, store: Store, owner: str) -> None:
        self._store = store
        self._owner = owner

    def read(self) -> dict[str, NDArray[np.complex128]]:
        with self._store.read() as reading:
            return {name: _complex(reading.array(self._owner, name)) for name in HARMONIC}
