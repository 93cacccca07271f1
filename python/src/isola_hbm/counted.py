"""Things in words: numbers and lists of them."""

from __future__ import annotations

from collections.abc import Sequence


def count(number: int, thing: str, plural: str | None = None) -> str:
    """A number of things: ``1 branch``, ``2 branches``."""
    return f"{number} {thing if number == 1 else plural or thing + 's'}"


def listed(texts: Sequence[str]) -> str:
    """``1``, ``1 and 2``, ``1, 2 and 3``."""
    return " and ".join(part for part in (", ".join(texts[:-1]), *texts[-1:]) if part)
