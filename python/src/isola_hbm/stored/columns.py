"""What the numbers of a point are: name, unit, meaning and axes, as the file of the run itself documents them."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from .store import Reading

#: A column of a table with its comment, as the program writes them.
_COLUMN = re.compile(r"((?:[ \t]*--[^\n]*\n)+)[ \t]*\"?(\w+)\"?[ \t]+(?:REAL|INTEGER|TEXT)")
#: What a comment says if the array of the same name has a number for each of them: axis.
_OF_EACH = {"of the first monitored dof": "monitor", "the largest over the contact elements": "element"}
#: The units that end a comment.
_UNITS = re.compile(r", (rad/s|1/s|Hz|m/s|m|mm|N|J|J a period|s|kg)$")


@dataclass(frozen=True)
class Column:
    """Numbers of every point of a curve."""

    #: In words, without the unit.
    meaning: str
    #: Unit; "1" if there is none.
    unit: str = "1"
    #: Axes of the array after that of the points; None: as far as it is known, one number a point.
    axes: tuple[str, ...] | None = None
    #: What else has to be known of the numbers.
    comment: str = ""

    @property
    def attributes(self) -> dict[str, str]:
        """As xarray wants them."""
        comment = {"comment": self.comment} if self.comment else {}
        return {"long_name": self.meaning, "units": self.unit, **comment}


#: What the attribute `comment` says of complex harmonics.
_SERIES = "complex harmonics X_k: x(t) = Re Σ_k X_k exp(i k ω t); time() has a period"

#: What tables of points do not document: arrays that have no column of their own.
ARRAYS = {
    "omega": Column("Frequency ω", "rad/s", ()),
    "decay": Column("Decay rate ζ", "1/s", ()),
    "forcing": Column("Forcing amplitude A", "1", ()),
    "argument": Column(
        "Arguments of the laws: contact normals predicted pressure, N, else m", "m", ("channel",), _SERIES
    ),
    "modal": Column("Modal amplitudes y", "kg^0.5 m", ("mode",), _SERIES),
    "displacement": Column("Displacements", "m", ("dof",), _SERIES),
    "contributions": Column("Modal contributions, summing to 1", "1", ("mode",)),
}
#: What the attribute `comment` says of columns that are known at some points only.
_COMMENTS = {
    "multiplier": "NaN at points whose frequency no marched orbit has, and so of all points that were not verified: verified() has the others",
    "stable": "stable, unstable, marginal, none (no periodic motion near), not_comparable (not comparable: marching loses impact energy "
    "that the balance keeps), empty: not verified",
}
#: Those of them that are complex harmonics, axis k last.
HARMONIC = ("argument", "modal", "displacement")


def documented(reading: Reading, table: str) -> dict[str, Column]:
    """The columns of a table of points, by name, as far as the file documents them."""
    found = {}
    for comment, name in _COLUMN.findall(reading.definition(table)):
        text = " ".join(line.strip().removeprefix("--").strip() for line in comment.splitlines())
        found[name] = replace(_column(text.removesuffix(".")), comment=_COMMENTS.get(name, ""))
    return {**found, **ARRAYS}


def _column(text: str) -> Column:
    """What a comment says."""
    axes: tuple[str, ...] = ()
    for phrase, axis in _OF_EACH.items():
        text, found, _ = text.partition(f", {phrase}")
        axes = (axis,) if found else axes
    unit = _UNITS.search(text)
    meaning = text[: unit.start()] if unit else text
    return Column(meaning, unit[1] if unit else "1", axes)
