"""Levels of a run: their branches, their windows and what became of them, why main branches are missing."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeVar

import msgpack

from ..errors import Damaged
from .store import Reading, Row
from .verified import name_of

T = TypeVar("T")

#: Kinds of branches in the order of tables.
KINDS = ("main", "isola", "open", "cut", "branched", "unfinished")
#: How far from an end of an isola's range a fold curve may cross its level, as a share of its width.
AT_END = 0.05


@dataclass
class Omissions:
    """What a reading has to leave out, in sentences."""

    sentences: list[str] = field(default_factory=list)

    def attempt(self, what: str, read: Callable[[], T]) -> T | None:
        """What `read` returns; None if it cannot be read, and a sentence that begins with `what`."""
        try:
            return read()
        except Damaged as damage:
            self.sentences.append(f"{what} left out: {damage.detail}.")
            return None


@dataclass
class Level:
    """A forcing level: what was found there."""

    #: Number in the file, from 1.
    number: int
    #: Forcing amplitude as typed.
    amplitude: str
    #: Forcing amplitude A.
    value: float
    #: Rows of the table of branches, main ones first.
    branches: list[Row]
    #: Why no main branch starts at one side, if one was tried there and none is known.
    main_failure: str | None


def levels(reading: Reading, omissions: Omissions) -> list[Level]:
    """All levels by amplitude, with what can be read of them."""
    rows = reading.rows_of("levels", "ORDER BY value, level")
    return [_level(reading, omissions, row) for row in rows]


def _level(reading: Reading, omissions: Omissions, row: Row) -> Level:
    number, text = row["level"], row["amplitude"]
    branches = omissions.attempt(f"The branches at A = {text} are", lambda: _branches(reading, number)) or []
    failure = None
    if not any(branch["kind"] == "main" for branch in branches):
        what = f"The failure of the main branch at A = {text} is"
        failure = omissions.attempt(what, lambda: _main_failure(reading, number))
    return Level(number, text, row["value"], branches, failure)


def _branches(reading: Reading, level: int) -> list[Row]:
    """Branches of a level, kind by kind: main ones first."""
    rows = reading.rows_of("branches", "WHERE level = ? ORDER BY number", level)
    place = {kind: i for i, kind in enumerate(KINDS)}
    return sorted(rows, key=lambda row: place.get(row["kind"], len(KINDS)))


def named(level: Level, branch: Row) -> str:
    """The name by which a run gives a branch: ``60/isola 1``."""
    return f"{level.amplitude}/{name_of(branch)}"


def _main_failure(reading: Reading, level: int) -> str | None:
    row = reading.one(
        "SELECT state, outcome, (SELECT reason FROM attempts WHERE task = id AND reason IS NOT NULL "
        "ORDER BY attempt DESC LIMIT 1) AS reason FROM tasks "
        "WHERE level = ? AND kind = 'main' AND (state = 'dead' OR state = 'done' AND NOT found) "
        "ORDER BY position LIMIT 1",
        level,
    )
    if row is None:
        return None
    return _given_up(row["reason"]) if row["state"] == "dead" else row["outcome"] or ""


def _given_up(reason: str | None) -> str:
    return f"given up: {reason}" if reason else "given up"


def windows(reading: Reading, level: Level) -> list[Row]:
    """Windows of a level, in the order of the backbones, with what became of them."""
    seeds = _seeds(reading, level.number)
    rows = reading.rows_of("windows", "WHERE level = ? ORDER BY window", level.number)
    for row in rows:
        of_window = [seed for seed in seeds if seed["window"] == row["window"]]
        row["outcome"], row["branch"], row["reason"] = _outcome(of_window)
        if row["outcome"] == "found" and not any(_is_there(level, row, name) for name in row["branch"].split("; ")):
            row["outcome"] = "elsewhere"
        # Runs of earlier programs followed one mode.
        row.setdefault("mode", primary_mode(reading))
    return rows


def _is_there(level: Level, window: Row, name: str) -> bool:
    """Whether a branch to which a window led has frequencies of it, as far as is known. Main branches go past all frequencies."""
    row = next((row for row in level.branches if name_of(row) == name), None)
    if row is None or row["kind"] == "main":
        return True
    ends = [row["omega_min"], row["omega_max"], window["omega_min"], window["omega_max"]]
    return None not in ends and bool(ends[0] <= ends[3] and ends[1] >= ends[2])


def _seeds(reading: Reading, level: int) -> list[Row]:
    """Tasks that start from windows; those of landings that failed stand for what would have followed."""
    return reading.rows(
        "SELECT window, state, outcome, branch, (SELECT reason FROM attempts WHERE task = id "
        "AND reason IS NOT NULL ORDER BY attempt DESC LIMIT 1) AS reason "
        "FROM tasks WHERE level = ? AND (kind = 'seed' "
        "OR kind = 'land' AND (state = 'dead' OR state = 'done' AND NOT found)) ORDER BY position",
        level,
    )


def _outcome(seeds: list[Row]) -> tuple[str, str, str]:
    """What became of a window, the branches that its seeds led to or that pass by, the reasons why to none."""
    # What a seed landed on is all that is said of it.
    passed = [seed for seed in seeds if seed["branch"] not in (None, seed["outcome"])]
    found = _distinct(seed["branch"] for seed in seeds if seed not in passed)
    if found:
        return "found", found, ""
    if all(seed["state"] in ("done", "skipped") for seed in seeds):
        if passed:
            nearest = min((seed["outcome"] or "" for seed in passed), key=lambda told: told.split(" ")[-1])
            told = f"no seed landed near it, but {nearest}: an isola nearby is not excluded"
            return "passed", _distinct(seed["branch"] for seed in passed), told
        return "not_found", "", _distinct(seed["outcome"] for seed in seeds)
    dead = (seed for seed in seeds if seed["state"] == "dead")
    return "pending", "", _distinct(_given_up(seed["reason"]) for seed in dead)


def _distinct(texts: Iterable[str | None]) -> str:
    """Texts without repetition."""
    return "; ".join(dict.fromkeys(text for text in texts if text is not None))


def primary_mode(reading: Reading) -> int:
    """The mode of the first backbone, from 1."""
    if reading.version >= 3:
        found = reading.column("SELECT mode FROM modes WHERE place = 0")
        return int(found[0]) if found else 1
    # The backbone without its numbers, as a message.
    record = reading.fact("backbone")
    try:
        return 1 if record is None else int(msgpack.unpackb(record)["mode"]) + 1
    except (msgpack.UnpackException, ValueError, TypeError, LookupError) as error:
        raise Damaged(reading.store.file, f"the backbone: {error}") from error


def join_families(levels: list[Level], curves: list[list[Row]]) -> dict[int, int]:
    """Families of the branches beside the main ones, by their `id`: which of neighbouring levels are the same thing at
    another forcing, numbered from 1.

    Two of neighbouring levels are of one family if their frequency ranges overlap by more than half of the smaller one,
    or else if a fold curve (its points in order) leads from an end of the one to the same end of the other. Where families split or merge, the larger overlap keeps its number.
    """
    families: dict[int, int] = {}
    count, earlier, value = 0, list[Row](), math.nan
    for level in levels:
        now = [branch for branch in level.branches if branch["kind"] != "main"]
        # What branches off another lies within its range.
        alike = (
            (one, other)
            for one in earlier
            for other in now
            if (one["kind"] == "branched") == (other["kind"] == "branched")
        )
        pairs = [(_overlap(one, other), one["id"], other["id"]) for one, other in alike]
        # The sort is stable: of equal overlaps the first counts.
        pairs.sort(key=lambda pair: -pair[0])
        continued: set[int] = set()
        for width, one, other in pairs:
            if width > 0 and one not in continued and other not in families:
                continued.add(one)
                families[other] = families[one]
        for start, stop in _passages(curves, value, level.value):
            ends = ((one["id"], _end_at(one, start)) for one in earlier if one["id"] not in continued)
            one, end = next(((one, end) for one, end in ends if end is not None), (0, None))
            free = (row["id"] for row in now if row["id"] not in families and _end_at(row, stop) == end)
            other = None if end is None else next(free, None)
            if other is not None:
                continued.add(one)
                families[other] = families[one]
        for branch in now:
            if branch["id"] not in families:
                count += 1
                families[branch["id"]] = count
        earlier, value = now, level.value
    return families


def _passages(curves: list[list[Row]], low: float, high: float) -> Iterator[tuple[float, float]]:
    """Frequencies at two forcing amplitudes between which fold curves lead from the one to the other without leaving them."""
    for points in curves:
        last: tuple[int, float] | None = None
        for a, b in pairwise(points):
            crossed = sorted(
                ((level - a["forcing"]) / (b["forcing"] - a["forcing"]), which)
                for which, level in enumerate((low, high))
                if (a["forcing"] < level) != (b["forcing"] < level)
            )
            for share, which in crossed:
                omega = a["omega"] + share * (b["omega"] - a["omega"])
                if last is not None and last[0] != which:
                    yield (last[1], omega) if which else (omega, last[1])
                last = which, omega


def _end_at(row: Row, omega: float) -> int | None:
    """Which end of an isola's range this is, 0 for the lower one."""
    low, high = row["omega_min"], row["omega_max"]
    if row["kind"] != "isola" or low is None or high is None:
        return None
    return next((i for i, end in enumerate((low, high)) if abs(omega - end) <= AT_END * (high - low)), None)


def _overlap(a: Row, b: Row) -> float:
    """Width of the overlap of two frequency ranges, if it is more than half of the smaller one; else 0."""
    ends = [a["omega_min"], a["omega_max"], b["omega_min"], b["omega_max"]]
    if any(omega is None for omega in ends):
        return 0.0
    width = min(a["omega_max"], b["omega_max"]) - max(a["omega_min"], b["omega_min"])
    smaller = min(a["omega_max"] - a["omega_min"], b["omega_max"] - b["omega_min"])
    return float(width) if 2 * width > smaller else 0.0
