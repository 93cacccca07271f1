"""Values as TOML: for model files, and for keys of a study that are set from outside."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any


class NoName(TypeError):
    """A key that is no text."""

    def __init__(self, name: object) -> None:
        super().__init__(f"{name!r} ({type(name).__name__}) is no name; a text is needed")


def literal(value: Any) -> str:
    """A value in one line: numbers (NumPy's as well) to the last bit, texts, lists, inline tables.

    Raises:
        TypeError: It has no form in TOML.
        NoName: A key in it is no text.
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key(name)} = {literal(content)}" for name, content in value.items()) + " }"
    if isinstance(value, (list, tuple, range)):
        return "[" + ", ".join(map(literal, value)) + "]"
    raise TypeError(f"{value!r} ({type(value).__name__}) has no form in TOML")


def key(name: Any) -> str:
    """A key, in quotes where it needs them.

    Raises:
        NoName: It is no text.
    """
    if not isinstance(name, str):
        raise NoName(name)
    bare = name.isascii() and name.replace("-", "a").replace("_", "a").isalnum()
    return name if bare else json.dumps(name, ensure_ascii=False)


def dotted(settings: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Dotted keys with their values: ``{"harmonics": {"count": 20}}`` is ``harmonics.count``, ``20``."""
    for name, value in settings.items():
        if not isinstance(name, str):
            raise NoName(name)
        if isinstance(value, Mapping):
            yield from dotted(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", literal(value)
