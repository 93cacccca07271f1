"""Things in words: numbers and lists of them; which numbers are one."""

from __future__ import annotations

import math
from collections.abc import Sequence

#: Relative distance within which numbers are one but for rounding.
_ROUNDING = 1e-14


def count(number: int, thing: str, plural: str | None = None) -> str:
    """A number of things: ``1 branch``, ``2 branches``."""
    return f"{number} {thing if number == 1 else plural or thing + 's'}"


def digits(value: float, count: int) -> str:
    """A number with so many digits at most, without exponent unless it is very small, as the program writes it."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    before = math.floor(math.log10(abs(value))) + 1
    if before < -3:
        mantissa, _, exponent = f"{value:.{max(count - 1, 0)}e}".partition("e")
        return f"{mantissa}e{int(exponent)}"
    written = f"{value:.{max(count - before, 0)}f}"
    return written.rstrip("0").rstrip(".") if "." in written else written


def is_same(value: float, level: float) -> bool:
    """Whether a number is a forcing level but for rounding: levels have fifteen digits at most."""
    return abs(value - level) <= _ROUNDING * abs(level)


def listed(texts: Sequence[str]) -> str:
    """``1``, ``1 and 2``, ``1, 2 and 3``."""
    return " and ".join(part for part in (", ".join(texts[:-1]), *texts[-1:]) if part)
