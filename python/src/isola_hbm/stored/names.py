"""Names along the axes of arrays: dofs, contacts, arguments of laws."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import msgpack
import pandas as pd

from ..errors import Corrupt, Damaged
from ..live.types import Model
from ..live.wire import sha256
from .store import Reading


@dataclass(frozen=True)
class Names:
    """Names along axes, and what the numbers there are."""

    #: By axis: monitor, element (contacts), dof (nonlinear and monitored ones), channel (arguments of laws).
    axes: dict[str, pd.Index]
    #: Units of the arguments of laws.
    units: list[str]

    @classmethod
    def read(cls, reading: Reading) -> Names:
        """Of the model of a run."""
        row = reading.one("SELECT monitors, displacement_dofs, contacts FROM model")
        if row is None:
            raise Damaged(reading.store.file, "the model is gone")
        try:
            monitors, dofs, contacts = (json.loads(text) for text in row.values())
        except (TypeError, ValueError) as error:
            raise Damaged(reading.store.file, f"the model: {error}") from error
        arguments, units = [], []
        for element in model(reading).elements:
            count = len(element.channels)
            arguments += [f"{element.name} {number}" for number in range(1, count + 1)]
            units += ["N" if element.law == "contact" else "m"] + ["m"] * (count - 1)
        axes = {"monitor": monitors, "element": contacts, "dof": dofs, "channel": arguments}
        return cls({axis: pd.Index(names, dtype=object) for axis, names in axes.items()}, units)

    def along(self, axis: str, length: int) -> pd.Index | None:
        """Coordinates along an axis; None if there are none that fit."""
        if axis == "harmonic":
            return pd.RangeIndex(length)
        if axis == "mode":
            return pd.RangeIndex(1, length + 1)
        names = self.axes.get(axis)
        return names if names is not None and len(names) == length else None


def model(reading: Reading) -> Model:
    """The structure: matrices, mode shapes, elements.

    Raises:
        Damaged: It is not the one that the run began with.
    """
    payloads = reading.column("SELECT payload FROM model")
    try:
        structure = Model.read(msgpack.unpackb(payloads[0]))
    except (msgpack.UnpackException, Corrupt, ValueError, TypeError, LookupError, AttributeError) as error:
        raise Damaged(reading.store.file, f"the model: {error}") from error
    if sha256(payloads[0]) != reading.fact("model_sha256"):
        raise Damaged(reading.store.file, "the model is not the one that the run began with")
    order = reading.store.order
    return structure if order is None else replace(structure, forcing_harmonic=order)
