"""What a run has lost, and what it has not got yet: compared table by table and number by number."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import msgpack
import numpy as np

from ..errors import Damaged
from ..live.wire import sha256
from .levels import Level, Omissions, levels, named
from .names import model
from .store import Reading, Row
from .verified import verified

#: Levels that a sentence names.
_NAMED = 8
#: How far stored displacements may be from those of the modal amplitudes, relative to the largest: another processor adds up
#: in another order.
_ROUNDING = 1e-9


def check(reading: Reading) -> list[str]:
    """Everything that is damaged, gone or not there yet, in sentences; none of a finished run that is whole.

    Reads and verifies every number of the run.
    """
    omissions = Omissions()
    omissions.attempt("Part of the file is", reading.check)
    omissions.attempt("The model is", lambda: model(reading))
    found = omissions.attempt("Levels and branches are", lambda: levels(reading, omissions)) or []
    for level in found:
        for branch in level.branches:
            omissions.attempt(f"Branch {named(level, branch)} is", partial(_branch, reading, branch))
    omissions.attempt("A result is", lambda: _results(reading))
    gone = omissions.attempt("Branches that are gone are", lambda: _gone(reading, found)) or []
    missing = omissions.attempt("Open tasks are", lambda: _open(reading, found)) or []
    return [*omissions.sentences, *gone, *missing]


def _branch(reading: Reading, row: Row) -> None:
    """Raises unless a branch is what was stored; its displacements have no checksum, and are computed again."""
    modal = verified(reading, row)["modal"]
    stored = reading.array(row["task"], "displacement")
    structure = model(reading)
    channels = (channel for element in structure.elements for channel in element.channels)
    dofs = sorted({dof for channel in channels for dof, _ in channel} | set(structure.monitors))
    expected = np.einsum("dm,pmkc->pdkc", structure.shapes[dofs], modal)
    scale = np.abs(expected).max(initial=0.0)
    if stored.shape != expected.shape or not np.allclose(stored, expected, rtol=0.0, atol=_ROUNDING * scale):
        raise Damaged(reading.store.file, "its displacements are not those of the modal amplitudes")


def _results(reading: Reading) -> None:
    """Raises unless results without a branch, fold curves among them, are what was stored: their records are complete."""
    for row in reading.rows("SELECT task, record, sha256 FROM results"):
        record = row["record"]
        is_stored = isinstance(record, bytes) and (sha256(record) == row["sha256"] or _has_branch(record))
        if not is_stored:
            raise Damaged(reading.store.file, f"the result of task {row['task']} is not what was stored")


def _has_branch(record: bytes) -> bool:
    """Whether a result came with a branch, whose numbers are in tables."""
    try:
        return msgpack.unpackb(record)["branch"] is not None
    except (msgpack.UnpackException, ValueError, TypeError, LookupError):
        return False


def _gone(reading: Reading, found: list[Level]) -> list[str]:
    """Branches that tasks found and the table of branches has not."""
    sentences = []
    for level in found:
        sql = "SELECT id, branch FROM tasks WHERE level = ? AND state = 'done' AND branch IS NOT NULL ORDER BY position"
        first: dict[str, str] = {}
        for row in reading.rows(sql, level.number):
            first.setdefault(row["branch"], row["id"])
        names = {named(level, branch) for branch in level.branches}
        for name, task in first.items():
            if f"{level.amplitude}/{name}" not in names:
                sentences.append(f"Branch {level.amplitude}/{name} is gone: task {task} found it.")
    return sentences


def _open(reading: Reading, found: list[Level]) -> list[str]:
    """What the levels still lack."""
    if reading.fact("backbone") is None:
        return ["There is no backbone yet, and so there are no windows and no branches."]

    def counted(number: Callable[[Level], int], sentence: Callable[[int, str], str]) -> list[str]:
        counts = {level.amplitude: number(level) for level in found}
        named = [amplitude for amplitude, count in counts.items() if count]
        more = f" and {len(named) - _NAMED} more" if len(named) > _NAMED else ""
        return [sentence(sum(counts.values()), ", ".join(named[:_NAMED]) + more)] if named else []

    def tasks(states: str) -> Callable[[Level], int]:
        searched = "kind NOT IN ('verify', 'disturb', 'march')"
        sql = f"SELECT count(*) FROM tasks WHERE level = ? AND state IN ({states}) AND {searched}"
        return lambda level: int(reading.column(sql, level.number)[0])

    def number(count: int, one: str, many: str) -> str:
        return f"{count} {one if count == 1 else many}"

    return [
        *counted(
            tasks("'waiting', 'leased'"),
            lambda count, at: f"{number(count, 'task is', 'tasks are')} still to be done, at A = {at}, "
            "verifications and what follows from results not counted.",
        ),
        *counted(
            tasks("'dead'"),
            lambda count, at: (
                f"{number(count, 'task was', 'tasks were')} given up, at A = {at}: see `isola retry-dead`."
            ),
        ),
        *counted(lambda level: not level.branches, lambda _, at: f"No branch is known at A = {at}."),
    ]
