"""Bytes to values: encodings, MessagePack, arrays."""

from __future__ import annotations

import hashlib
from typing import Any

import msgpack
import numpy as np
from numpy.typing import NDArray

from ..errors import Corrupt, OtherVersion

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Version of the messages, the number behind ``v`` in keys and encodings.
VERSION = 13
#: First chunk of every key unless told otherwise.
NAMESPACE = "isola"
#: Encoding of a refusal in words.
REFUSAL = "text/plain;isola.refusal"


def encoding(name: str) -> str:
    """Encoding of the message called `name`."""
    return f"application/msgpack;{name}.v{VERSION}"


def decode(payload: bytes, found: str, name: str) -> Any:
    """The message `name` in `payload` that came with the encoding `found`: a dict (or a str, or None)."""
    if found != encoding(name):
        raise OtherVersion(
            f"this is `{found}`, expected `{encoding(name)}`: "
            "the other side runs another version of Isola, or is not Isola"
        )
    try:
        # No limits beyond the payload itself: lengths are checked by the unpacker.
        return msgpack.unpackb(payload)
    except (ValueError, msgpack.UnpackException) as error:
        raise Corrupt(f"malformed `{name}` message: {error}") from error


def sha256(payload: bytes) -> str:
    """SHA-256 in hexadecimal digits."""
    return hashlib.sha256(payload).hexdigest()


def array(message: dict[str, Any]) -> Floats:
    """Array of numbers: type, shape and bytes. Read-only, without a copy."""
    try:
        if message["dtype"] != "<f8":
            raise Corrupt(f"array of type `{message['dtype']}`, expected `<f8`")
        return np.frombuffer(message["data"], "<f8").reshape(message["shape"])
    except (KeyError, TypeError, ValueError) as error:
        raise Corrupt(f"not an array: {error}") from error


def is_array(value: Any) -> bool:
    """Whether a part of a message is meant as an array of numbers that are known here."""
    return isinstance(value, dict) and {"dtype", "shape", "data"} <= value.keys() and value["dtype"] == "<f8"


def harmonics(message: dict[str, Any]) -> Complexes:
    """Array whose last axis is (re, im), as complex numbers without that axis. Read-only, without a copy."""
    values = array(message)
    if values.ndim == 0 or values.shape[-1] != 2:
        raise Corrupt(f"shape {values.shape}, expected a last axis of 2: real and imaginary parts")
    return values.view(np.complex128)[..., 0]


def variant(value: Any) -> tuple[str, Any]:
    """Enumeration as (name, content): ``"main"`` is ("main", None), ``{"isola": 0}`` is ("isola", 0)."""
    if isinstance(value, str):
        return value, None
    if isinstance(value, dict) and len(value) == 1:
        return next(iter(value.items()))
    raise Corrupt(f"{value!r} is not a variant of an enumeration")
