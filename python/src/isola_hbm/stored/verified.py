"""Branches to the bit: what a worker announced by its SHA-256, put together again from the tables."""

from __future__ import annotations

import hashlib
from typing import Any

import msgpack
import numpy as np

from ..errors import Damaged
from ..live.wire import Floats
from ..live.words import branch_name
from .store import Reading, Row, Values

#: Arrays of a result that stand apart from its columns.
MOTIONS = ("omega", "decay", "forcing", "argument", "modal")
#: What a row of `branches` repeats of the points, and the frequency at the last.
EXTENT = ("omega_min", "omega_max", "amplitude_max")


def verified(reading: Reading, branch: Row) -> dict[str, Floats]:
    """The arrays of a branch by name, read-only; `branch` is its row in the table of branches.

    The store keeps the message of a result without the numbers of its arrays, and these in tables. Put together again and
    encoded, they have the SHA-256 that was announced when the result was accepted.

    Raises:
        Damaged: They have not.
    """
    file, task = reading.store.file, branch["task"]
    row = reading.one("SELECT record, sha256 FROM results WHERE task = ?", task)
    if row is None:
        raise Damaged(file, f"the result of task {task} is gone")
    try:
        result = msgpack.unpackb(row["record"])
        points = result["branch"]["points"]
        arrays = _arrays(reading, branch, [*MOTIONS, *(name for name in points if name != "motions")])
        for name, values in arrays.items():
            (points["motions"] if name in MOTIONS else points)[name] = _message(values)
        digest = _sha256(result)
        name = branch_name(result["name"])
    except (msgpack.UnpackException, ValueError, TypeError, LookupError) as error:
        raise Damaged(file, f"the result of task {task}: {error}") from error
    if digest != row["sha256"]:
        raise Damaged(file, f"the result of task {task} is not what was stored")
    if name != name_of(branch):
        raise Damaged(file, f"the result of task {task} is another one, {name}")
    if not _is_extent(branch, arrays):
        raise Damaged(file, "its numbers in the table of branches are others")
    return arrays


def name_of(branch: Row) -> str:
    """``main``, ``main 2``, ``isola 1``, …: of a row of the table of branches."""
    kind, number = branch["kind"], branch["number"]
    return kind if (kind, number) == ("main", 1) else f"{kind} {number}"


def _arrays(reading: Reading, branch: Row, names: list[str]) -> dict[str, Floats]:
    """Arrays by name: those that are stored as such, the others from the table of points."""
    stored = reading.shapes(branch["task"])
    columns = set(reading.columns("points"))
    held = [name for name in names if name not in stored and name in columns]
    arrays = {name: reading.array(branch["task"], name) for name in names if name in stored}
    return {**table(reading, "points", "branch", branch["id"], held), **arrays}


def table(reading: Reading, name: str, key: str, of: int, columns: list[str]) -> dict[str, Values]:
    """Columns of a table of points, of the curve `of`. A table without the column `key` holds one curve."""
    if not columns:
        return {}
    chosen = ", ".join(quoted(column) for column in columns)
    if key in reading.columns(name):
        return reading.arrays(f"SELECT {chosen} FROM {name} WHERE {key} = ? ORDER BY i", of)
    return reading.arrays(f"SELECT {chosen} FROM {name} ORDER BY i")


def quoted(name: str) -> str:
    """A name as SQL takes it, whatever is in it: not in double quotes, in which SQLite takes unknown names for texts."""
    return "`" + name.replace("`", "``") + "`"


def _message(values: Floats) -> dict[str, Any]:
    """An array as it is sent."""
    return {"dtype": "<f8", "shape": list(values.shape), "data": values.ravel().view(np.uint8).data}


def _sha256(message: dict[str, Any]) -> str:
    """SHA-256 of a message as MessagePack, whose megabytes of arrays are not copied for it."""
    digest, packer = hashlib.sha256(), msgpack.Packer()

    def feed(value: Any) -> None:
        if isinstance(value, dict):
            digest.update(packer.pack_map_header(len(value)))
            for key, content in value.items():
                feed(key)
                feed(content)
        elif isinstance(value, memoryview):
            digest.update(_binary_header(len(value)))
            digest.update(value)
        else:
            digest.update(packer.pack(value))

    feed(message)
    return digest.hexdigest()


def _binary_header(length: int) -> bytes:
    """How bytes begin in MessagePack: bin 8, bin 16, bin 32."""
    for marker, size in ((0xC4, 1), (0xC5, 2), (0xC6, 4)):
        if length < 1 << 8 * size:
            return bytes([marker]) + length.to_bytes(size, "big")
    raise ValueError(f"{length} bytes are more than a message can have")


def _is_extent(branch: Row, arrays: dict[str, Floats]) -> bool:
    """Whether the row says of the points what they are."""
    omega, amplitude = arrays["omega"], arrays["amplitude"][:, 0]
    if not len(omega):
        return True
    extent = [omega.min(), omega.max(), amplitude.max()]
    peaks = omega[amplitude == amplitude.max()]
    return extent == [branch[name] for name in EXTENT] and branch["omega_at_max"] in peaks
