"""Tables of a run as data frames: columns have the names of the CSV files; what the store has besides follows them."""

from __future__ import annotations

import json
from collections.abc import Collection
from functools import partial
from itertools import pairwise

import numpy as np
import pandas as pd

from ..errors import Damaged
from ..live.wire import Floats
from . import levels as of_levels
from .levels import Level, Omissions, join_families, named, primary_mode
from .store import Reading, Row, Values
from .verified import quoted, table

SUMMARY = [
    # What is looked at first: a printed table hides what stands in the middle.
    *("amplitude", "branch", "kind", "omega_min", "omega_max", "amplitude_max", "omega_at_max", "stable"),
    *("status", "points", "contact_omega_min", "contact_omega_max"),
    *("peak_standing", "family", "penetration", "pressure_beyond", "amplitude_2h", "shift_2h"),
    *("omega_min_2h", "omega_max_2h", "change_2h", "change_omega_2h", "slowest_sliding"),
]
WINDOWS = [
    *("amplitude", "window", "omega_min", "omega_max", "omega_best", "threshold"),
    *("outcome", "branch", "reason", "mode"),
]
BIFURCATIONS = ["forcing", "branch", "kind", "omega", "amplitude"]
MOTIONS = [
    *("forcing", "branch", "point", "omega", "motion", "repeats", "onto", "amplitude_min", "amplitude_max"),
    "growth",
]
PUSHES = [
    *("forcing", "branch", "mode", "omega", "monitor", "motions", "largest", "impulse", "below", "velocity", "phase"),
    *("confirmed", "energy", "from_rest"),
]
FOLDS = ["curve", "forcing", "omega", "amplitude", "kind"]
EVENTS = [
    *("kind", "source", "forcing", "omega", "amplitude", "mode", "curve", "backbone"),
    *("forcing_2h", "omega_2h", "outcome"),
]
#: Columns of the table of branches that say where something is in the file, or stand under another name.
_INTERNAL = {"id", "level", "special", "number"}
#: Columns of text; integers that may be missing; all others are real.
_TEXTS = {"kind", "status", "peak_standing", "outcome", "reason", "source", "task"}
_INTEGERS = {"points", "family", "window", "mode", "first", "last", "best", "rejections", "curve", "backbone"}
#: Relative distance up to which what happens along two curves is one thing, as the program has it.
_SAME = 1e-5
#: Relative height below which an extremum of the threshold curve is noise.
_PROMINENCE = 1e-3
#: Thresholds below the first of these are rounding, those farther from the levels than the second factor are not theirs, and a
#: balance of energies this much smaller than the dissipation is rounding again; as the program has it.
_NOTHING, _FAR, _ROUND_OFF = 1e-9, 1e3, 1e-6


def summary(reading: Reading, omissions: Omissions) -> pd.DataFrame:
    """A row a branch, by its name in the run; as ``summary.csv``."""
    levels = of_levels.levels(reading, omissions)
    curves = omissions.attempt("What fold curves join is", lambda: _curves(reading)) or []
    families = join_families(levels, curves)
    stable = omissions.attempt("What is stable is", lambda: _stable(reading)) or {}
    rows: dict[str, Row] = {}
    for level in levels:
        if level.main_failure is not None:
            failure = {"branch": 1, "kind": "main", "status": level.main_failure}
            rows[f"{level.amplitude}/main"] = {"amplitude": level.value, **failure}
        for branch in level.branches:
            row = {name: value for name, value in branch.items() if name not in _INTERNAL}
            row |= {"amplitude": level.value, "branch": branch["number"], "closed": bool(branch["closed"])}
            verified = {"family": families.get(branch["id"]), "stable": stable.get(branch["id"])}
            rows[named(level, branch)] = {**row, **verified}
    return _frame(SUMMARY, list(rows.values()), integers={"branch"}).set_axis(pd.Index(rows, name="name"))


def _stable(reading: Reading) -> dict[int, float]:
    """Shares of branches that are known to be stable, by their ids, of those that were verified from end to end."""
    if reading.version < 4:
        return {}
    rows = reading.rows("SELECT branch, stable FROM verifications WHERE stretch = 'whole'")
    return {row["branch"]: row["stable"] for row in rows}


def motions(reading: Reading) -> pd.DataFrame:
    """What unstable motions turn into; as ``motions.csv``."""
    if reading.version < 5:
        return _frame(MOTIONS, [])
    sql = """
        SELECT levels.value AS forcing, kind, number, i AS point, omega, motion, repeats, onto, amplitude_min,
            motions.amplitude_max, growth, periods
        FROM motions JOIN branches ON branches.id = branch JOIN levels USING (level)
        ORDER BY branches.level, branches.id, i
    """
    rows = reading.rows(sql)
    for row in rows:
        kind, number = row.pop("kind"), row.pop("number")
        row["branch"] = kind if (kind, number) == ("main", 1) else f"{kind} {number}"
    texts = {"branch", "motion", "onto"}
    return _frame(MOTIONS, rows, texts=texts, integers={"point", "repeats", "periods"})


def pushes(reading: Reading) -> pd.DataFrame:
    """The smallest impulses found that throw the structure from its main branch onto another one; as ``pushes.csv``."""
    if reading.version < 4:
        return _frame(PUSHES, [])
    from_rest = "from_rest" if reading.version >= 13 else "NULL AS from_rest"
    sql = f"""
        SELECT levels.value AS forcing, kind, number, mode, omega, monitor, motions, largest, impulse, below, velocity, phase,
            confirmed, reason, 0.5 * impulse * abs(velocity) AS energy, {from_rest}
        FROM pushes JOIN branches ON branches.id = branch JOIN levels USING (level)
        ORDER BY branches.level, branches.id, mode
    """
    rows, names = reading.rows(sql), reading.one("SELECT monitors FROM model")
    monitors = json.loads(names["monitors"]) if names else []
    for row in rows:
        kind, number = row.pop("kind"), row.pop("number")
        row["branch"] = kind if (kind, number) == ("main", 1) else f"{kind} {number}"
        row["monitor"] = monitors[row["monitor"]] if row["monitor"] < len(monitors) else ""
        row["confirmed"] = None if row["confirmed"] is None else bool(row["confirmed"])
    frame = _frame(PUSHES, rows, texts={"branch", "monitor", "reason", "from_rest"}, integers={"motions"})
    return frame.astype({"confirmed": "boolean"})


def bifurcations(reading: Reading) -> pd.DataFrame:
    """Where marched orbits of branches lose or regain stability; as ``bifurcations.csv``."""
    if reading.version < 4:
        return _frame(BIFURCATIONS, [])
    sql = """
        SELECT levels.value AS forcing, branches.kind AS branch_kind, branches.number AS branch_number, bifurcations.kind,
            bifurcations.omega, bifurcations.amplitude
        FROM bifurcations JOIN verifications USING (task) JOIN branches ON branches.id = branch JOIN levels USING (level)
        WHERE stretch = 'whole' OR NOT EXISTS (
            SELECT 1 FROM verifications AS other WHERE other.branch = branches.id AND other.stretch = 'whole'
        )
        ORDER BY branches.level, branches.id, bifurcations.number
    """
    rows = reading.rows(sql)
    for row in rows:
        kind, number = row.pop("branch_kind"), row.pop("branch_number")
        row["branch"] = kind if (kind, number) == ("main", 1) else f"{kind} {number}"
    return _frame(BIFURCATIONS, rows, texts={"branch"})


def windows(reading: Reading, omissions: Omissions) -> pd.DataFrame:
    """A row for every window that the energy balance predicts; as ``windows.csv``."""

    def of(level: Level) -> list[Row]:
        what = f"The windows at A = {level.amplitude} are"
        rows = omissions.attempt(what, lambda: of_levels.windows(reading, level)) or []
        return [{**row, "amplitude": level.value} for row in rows]

    rows = [row for level in of_levels.levels(reading, omissions) for row in of(level)]
    return _frame(WINDOWS, rows, texts={"branch"}).drop(columns="level", errors="ignore")


def folds(reading: Reading) -> pd.DataFrame:
    """Points of fold curves; as ``folds.csv``. A closed curve ends with its first point again."""
    return _frame(FOLDS, [row for points in _curves(reading) for row in points]).drop(columns="i", errors="ignore")


def _curves(reading: Reading) -> list[list[Row]]:
    """Points of fold curves, curve by curve; a closed one ends with its first point again."""
    if not reading.columns("curve_points"):
        return []
    closed = set(reading.column("SELECT number FROM curves WHERE closed"))
    # Those of responses at one frequency are of no fold.
    others = set(reading.column("SELECT number FROM curves WHERE kind = 'response'"))
    curves: dict[int, list[Row]] = {}
    for row in reading.rows_of("curve_points", "ORDER BY curve, i"):
        if row["curve"] in others:
            continue
        row["kind"] = row.pop("event") or "fold"
        curves.setdefault(row["curve"], []).append(row)
    for number, points in curves.items():
        if number in closed:
            points.append({**points[0], "kind": "fold"})
    return list(curves.values())


def events(reading: Reading, omissions: Omissions) -> pd.DataFrame:
    """Births, deaths and merges of isolas, computed along fold curves and predicted by the energy balance; as
    ``events.csv``: `mode` is the one that contributes most beside that of the `backbone`."""
    rows: list[Row] = []
    if known := reading.columns("curve_points"):
        doubled = [name for name in ("forcing_2h", "omega_2h") if name in known]
        sql = "SELECT event AS kind, 'computed' AS source, " + ", ".join(
            ["forcing", "omega", "amplitude", "curve", *doubled]
        )
        sql += " FROM curve_points WHERE event IS NOT NULL ORDER BY curve, i"
        rows = _once(omissions.attempt("Computed events are", lambda: reading.rows(sql)) or [])
    for mode in modes(reading):
        what = f"Events predicted along the backbone of mode {mode['mode']} are"
        rows += omissions.attempt(what, partial(_predicted, reading, mode)) or []
    return _frame(EVENTS, rows)


def _once(events: list[Row]) -> list[Row]:
    """Computed events; what two curves share stands once, at the first of them, with what twice the harmonics make of it if any has it."""

    def is_near(one: Row, other: Row, name: str) -> bool:
        a, b = one[name], other[name]
        return a is not None and b is not None and abs(a - b) <= _SAME * max(abs(a), abs(b))

    kept: list[Row] = []
    for event in events:
        same = [
            other
            for other in kept
            if event["kind"] == other["kind"] and is_near(event, other, "forcing") and is_near(event, other, "omega")
        ]
        if not same:
            kept.append(event)
        elif same[0].get("forcing_2h") is None and "forcing_2h" in event:
            same[0].update(forcing_2h=event["forcing_2h"], omega_2h=event["omega_2h"])
    return kept


def _predicted(reading: Reading, row: Row) -> list[Row]:
    """Births and merges along a backbone: extrema of its threshold A*, as far as they mean something for the levels."""
    mode = row["mode"]
    # Runs of before have one piece.
    pieces = ["piece"] if "piece" in reading.columns("backbone") else []
    columns = ["threshold", "omega", "amplitude", "r_lin", "r_nl", *pieces]
    points = table(reading, "backbone", "mode", mode, columns)
    if not len(points["omega"]):
        return []
    contributions = reading.array(row["owner"], "contributions").copy()
    if len(contributions) != len(points["omega"]):
        raise Damaged(reading.store.file, f"contributions of {len(contributions)} points of the backbone")
    contributions[:, mode - 1] = -np.inf
    # The last one of equals, as the program has it.
    others = contributions.shape[1] - np.argmax(contributions[:, ::-1], axis=1)
    threshold = points["threshold"]
    with np.errstate(divide="ignore"):
        logarithms = np.log(threshold)
    breaks = np.flatnonzero(np.diff(points["piece"])) if pieces else np.zeros(0, dtype=int)
    inner = []
    for begin, end in pairwise([0, *(1 + breaks).tolist(), len(threshold)]):
        extrema = turning_points(logarithms[begin:end], _PROMINENCE)
        inner += [(begin + i, is_maximum) for i, is_maximum in extrema if 0 < i < end - begin - 1]
    levels = [float(value) for value in reading.column("SELECT value FROM levels")]
    low = max(_NOTHING, min(levels, default=np.inf) / _FAR)
    high = max(levels, default=0.0) * _FAR
    linear, balance = points["r_lin"], points["r_lin"] + points["r_nl"]

    def cancels(index: int, is_maximum: bool) -> bool:
        """Whether a threshold is so small since energies that are more than rounding cancel."""
        near = balance[index - 1 : index + 2]
        is_real = (np.abs(near[[0, 2]]) > _ROUND_OFF * linear[index]).all()
        return bool(not is_maximum and linear[index] > 0.0 and near.min() < 0.0 <= near.max() and is_real)

    return [
        {
            "kind": "merge" if is_maximum else "birth",
            "source": "predicted",
            "forcing": threshold[index],
            "omega": points["omega"][index],
            "amplitude": points["amplitude"][index],
            "mode": int(others[index]) if contributions.shape[1] > 1 else None,
            "backbone": mode,
        }
        for index, is_maximum in inner
        if low <= threshold[index] <= high or cancels(index, is_maximum)
    ]


def turning_points(values: Floats, prominence: float) -> list[tuple[int, bool]]:
    """Indices of alternating minima and maxima (True) of a sequence, ignoring wiggles lower than `prominence`; the ends
    count as extrema."""
    found: list[tuple[int, bool]] = []
    low = high = 0
    rising: bool | None = None
    for i, value in enumerate(values):
        high = i if value > values[high] else high
        low = i if value < values[low] else low
        if rising is not True and value > values[low] + prominence:
            found.append((low, False))
            rising, high = True, i
        elif rising is not False and value < values[high] - prominence:
            found.append((high, True))
            rising, low = False, i
    if rising is not None:
        found.append((high, True) if rising else (low, False))
    return found


def modes(reading: Reading) -> list[Row]:
    """Modes that have a backbone, the primary one first: mode (from 1), owner of its arrays, outcome."""
    if reading.version >= 3:
        rows = reading.rows("SELECT mode, place, outcome FROM modes WHERE place IS NOT NULL ORDER BY place")
    elif reading.fact("backbone") is not None:
        rows = [{"mode": primary_mode(reading), "place": 0, "outcome": reading.fact("backbone_status") or ""}]
    else:
        rows = []
    return [{**row, "owner": f"backbone/{row['mode']}" if row["place"] else "backbone"} for row in rows]


def backbones(reading: Reading, omissions: Omissions) -> pd.DataFrame:
    """Points of the backbones of all modes followed, one after the other; names as in ``backbone.csv``."""

    def of(row: Row) -> pd.DataFrame:
        columns = table(reading, "backbone", "mode", row["mode"], _columns(reading, "backbone"))
        for name, shape in reading.shapes(row["owner"]).items():
            # Numbers that no column can hold (NaN, -0).
            if name in columns and len(shape) == 1:
                columns[name] = reading.array(row["owner"], name)
        shares = reading.array(row["owner"], "contributions")
        if len(shares) != len(columns["omega"]):
            raise Damaged(reading.store.file, f"contributions of {len(shares)} points")
        columns |= {f"contribution_{mode}": shares[:, mode - 1] for mode in range(1, shares.shape[1] + 1)}
        return pd.DataFrame({**columns, "mode": row["mode"]})

    frames = [
        omissions.attempt(f"The backbone of mode {row['mode']} is", partial(of, row))
        for row in modes(reading)
    ]
    found = [frame for frame in frames if frame is not None and len(frame)]
    if not found:
        return pd.DataFrame(columns=[*_columns(reading, "backbone"), "mode"], dtype=float)
    return pd.concat(found, ignore_index=True)


def points(reading: Reading, omissions: Omissions, columns: Collection[str] = ()) -> pd.DataFrame:
    """Points of all branches, one after the other: name of the branch, forcing amplitude, and `columns` (by default all) of
    the store, one number each (of the first monitored dof; the largest over the contacts)."""
    names = list(columns) or _columns(reading, "points")
    found: dict[str, tuple[float, dict[str, Values]]] = {}
    for level in of_levels.levels(reading, omissions):
        for branch in level.branches:
            name, of = named(level, branch), branch["id"]
            values = omissions.attempt(
                f"Branch {name} is", partial(table, reading, "points", "branch", of, names)
            )
            if values is not None:
                found[name] = level.value, values
    counts = [len(values[names[0]]) for _, values in found.values()]
    parts = [values for _, values in found.values()] or [{name: np.zeros(0) for name in names}]
    joined = {name: np.concatenate([values[name] for values in parts]) for name in names}
    of_branch = {
        "name": np.repeat(np.array(list(found), dtype=object), counts),
        "forcing": np.repeat([value for value, _ in found.values()], counts),
    }
    return pd.DataFrame({**of_branch, **joined})


def table_of(reading: Reading, name: str) -> pd.DataFrame:
    """A table of the store as it is, without what is meant for the program itself (bytes).

    Raises:
        KeyError: There is no such table.
    """
    names = reading.column("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name")
    if name not in names:
        raise KeyError(f"no table `{name}`; there are {', '.join(names)}")
    rows = reading.rows(f"SELECT * FROM {quoted(name)}")
    binary = {column for row in rows for column, value in row.items() if isinstance(value, bytes)}
    return pd.DataFrame.from_records(rows, columns=reading.columns(name), exclude=sorted(binary))


def _columns(reading: Reading, name: str) -> list[str]:
    """Names of the columns of a table of points, but for those that number them."""
    return [column for column in reading.columns(name) if column not in ("branch", "mode", "i")]


def _frame(
    names: list[str], rows: list[Row], *, texts: Collection[str] = (), integers: Collection[str] = ()
) -> pd.DataFrame:
    """Rows as a data frame with these columns first, and whatever else the rows have."""
    others = dict.fromkeys(name for row in rows for name in row if name not in names)
    frame = pd.DataFrame(index=range(len(rows)))
    for name in [*names, *others]:
        values = [row.get(name) for row in rows]
        if name in _TEXTS or name in texts:
            frame[name] = pd.Series([value or "" for value in values], dtype=str)
        elif name in _INTEGERS or name in integers:
            frame[name] = pd.Series(values, dtype="Int64")
        elif name in names:
            frame[name] = pd.Series(values, dtype=float)
        else:
            frame[name] = pd.Series(values)
    frame.attrs["units"] = {name: unit for name in frame if (unit := _unit(str(name), "forcing" in names))}
    return frame


def _unit(name: str, has_forcing: bool) -> str:
    """The SI unit of a column, by its name; empty where it has none, or that of the forcing, which the model gives. `amplitude` is the
    forcing where no other column is."""
    if name.startswith(("omega", "contact_omega", "change_omega")):
        return "rad/s"
    return "m" if name in ("amplitude_max", "amplitude_min", "amplitude_2h") or (name == "amplitude" and has_forcing) else ""
