"""The forced response: amplitude of a monitored dof over frequency."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from .asked import Limits
from .coincidence import is_same
from .counted import listed
from .drawing import (
    MARK,
    SHADE,
    Named,
    Units,
    add_line,
    along,
    along_ramp,
    around,
    by_pieces,
    faded,
    fit_texts,
    legend,
    spread,
    text,
    up_to,
    write_names,
)
from .errors import Damaged, LeftOut
from .live.wire import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

    from .stored.motions import Motions
    from .stored.run import StoredRun

#: A main branch is shown at least where it is higher than this share of its peak.
_HIGH = 0.8
#: And where it has folds that are higher than this one.
_TURNS = 0.1
#: Widths of main branches, of those that branch off others, and of isolas and others.
_THIN, _MEDIUM, _BOLD = 1.0, 1.6, 2.2
#: Kinds of branches beside the main ones, as the program has them in legends.
_KINDS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("isola", "isola", {"linewidth": _BOLD}),
    ("open", "open branch", {"linewidth": _BOLD}),
    ("cut", "cut off by a bound", {"linewidth": _BOLD}),
    ("branched", "branches off another", {"linewidth": _MEDIUM}),
    ("unfinished", "unfinished", {"linewidth": _BOLD}),
)
#: The least width of an isola, and how many times as far apart as they are wide its two strands are, on average, at least.
_FINE, _APART = 0.75, 2.0
#: How what is unstable is drawn.
_DASHES = (0, (2.5, 1.5))
#: Peaks are marked while there are so few, and folds with them; how.
_MARKED = 12
_MARKS: dict[str, dict[str, Any]] = {
    "peak": {"marker": "^", "markersize": 4.5, "markerfacecolor": "white", "linestyle": "none"},
    "fold": {"marker": "o", "markersize": 3.5, "markerfacecolor": "white", "linestyle": "none"},
}
#: Of more levels, neighbours cannot be told apart by their colours: they are named at their peaks, not in the legend.
_NAMED = 6


@dataclass(frozen=True)
class _Branch:
    """A branch as it is drawn."""

    #: Its row of the summary.
    row: pd.Series
    #: Frequencies and amplitudes, in the units shown; the first point once more at the end of a closed one.
    at: Floats
    height: Floats
    #: What is known of the stability of the same points.
    stable: Floats
    #: Frequencies of its points, rad/s.
    omega: Floats
    #: Those that are to be seen, rad/s.
    shown: pd.Series
    #: Names of it and of others that lie on it.
    names: list[str]

    @property
    def is_main(self) -> bool:
        return bool(self.row["kind"] == "main")

    @property
    def is_named(self) -> bool:
        """Whether it is a main branch, and no piece that was found later on of one that is another row."""
        return self.is_main and "known branch" not in str(self.row["status"])

    @property
    def forcing(self) -> str:
        return f"A = {text(self.row['amplitude'])}"

    def is_high_at(self, point: int) -> bool:
        """Whether a point is there and no small part of the branch."""
        return point < len(self.omega) and bool(self.height[point] >= _TURNS * self.height.max())

    def narrowed(self, axes: Axes, full: float) -> float:
        """The width of its line on these axes, points: that given, or less where the strands of an isola would touch."""
        if self.is_main or not self.row["closed"]:
            return full
        x, y = (72.0 / axes.figure.canvas.figure.dpi) * axes.transData.transform(np.column_stack([self.at, self.height])).T
        area = 0.5 * abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
        length = np.hypot(np.diff(x), np.diff(y)).sum()
        return float(min(full, max(_FINE, 2.0 * area / max(length, 1e-9) / _APART)))

    def is_beneath(self, other: _Branch) -> bool:
        """Whether another one of its kind and level lies on it."""
        rows, curves = (self.row, other.row), [np.column_stack([one.at, one.height]) for one in (self, other)]
        return all(rows[0][name] == rows[1][name] for name in ("amplitude", "kind")) and is_same(*curves)

    def name_at_peak(self, color: Any) -> Named:
        """The name of all that lie on it, as ``isola 1 and 2, A = 60``."""
        kind, top = str(self.row["kind"]), self.height.argmax()
        numbers = listed([name.removeprefix(kind).strip() or "1" for name in self.names])
        name = self.forcing if self.is_main else f"{kind} {numbers}, {self.forcing}"
        return Named(name, self.at[top], self.height[top], color)


def forced_response(
    run: StoredRun,
    summary: pd.DataFrame,
    axes: Axes,
    units: Units,
    monitor: int,
    limits: tuple[Limits | None, Limits | None],
    backbone: bool,
) -> Axes:
    """Draws the branches that are these rows of the summary, amplitudes being those of this monitored dof, between these limits of
    the axes (frequencies, amplitudes) or, without, around what happens. Branches whose curves lie on each other are drawn once, under the names of all of them: one's
    solid line would fill the other's dashes."""
    table = _points(run, monitor)
    levels = sorted(summary["amplitude"].unique())
    colors = dict(zip(levels, along_ramp(len(levels))))
    rank = {levels[place]: i for i, place in enumerate(spread(len(levels)))}
    units = units.fitted(float(table["amplitude"][table["name"].isin(summary.index)].max()))
    branches, folds = _branches(summary, table, units), run._folds()
    # Where nothing was verified nothing is pale, and the legend says so.
    told = table["stable"][table["name"].isin(summary.index)]
    is_verified, known = bool((told.notna() & (told != "")).any()), told.isin(["stable", "unstable"])
    has_unstable, has_unknown = False, is_verified and not known.all()
    marks: dict[str, list[tuple[float, float, Any]]] = {"peak": [], "fold": []}
    strands: list[tuple[_Branch, Line2D]] = []
    for branch in branches:
        row, level, at, height = branch.row, branch.row["amplitude"], branch.at, branch.height
        style = {
            "color": colors[level],
            "linewidth": _THIN if branch.is_main else _MEDIUM if row["kind"] == "branched" else _BOLD,
            # What a lower level has lies inside of what a higher one has.
            "zorder": 3.0 - levels.index(level) / len(levels),
        }
        unstable = branch.stable == "unstable"
        unknown = ~(unstable | (branch.stable == "stable")) & is_verified
        # Segments are dashed from one unstable point to the next, and pale beside a point of which nothing is known.
        dashed, pale = unstable[1:] & unstable[:-1], unknown[1:] | unknown[:-1]
        axes.plot([], [], label=branch.forcing if branch.is_named and len(levels) <= _NAMED else None, **style)
        for wanted, look in (
            (~(dashed | pale), {}),
            (dashed, {"linestyle": _DASHES}),
            (pale, {"color": faded(style["color"])}),
        ):
            if wanted.any():
                strands += [(branch, line) for line in axes.plot(*along(wanted, at, height), **{**style, **look})]
        has_unstable |= bool(unstable.any())
        # What is only as far as the branch is known is no peak.
        if row.get("peak_standing") == "at":
            top = height.argmax()
            marks["peak"].append((at[top], height[top], colors[level]))
        places = [i for i in folds.get(str(row.name), []) if i < len(at)]
        marks["fold"] += [(at[i], height[i], colors[level]) for i in places]
    curves = list(axes.get_lines())
    across, up = limits
    if across is not None:
        axes.set_xlim(across)
        _fit_height(axes, curves, across)
    elif branches:
        reach = float(summary["omega_min"].min()), float(summary["omega_max"].max())
        axes.set_xlim(units.frequencies(around(_frequencies(branches, folds), reach)))
    # Amplitudes begin at zero; what is drawn on these axes later may change the limits as before.
    axes.set_ylim(*(up or (0.0, None)), auto=None)
    is_any_narrow = False
    for branch, line in strands:
        width = branch.narrowed(axes, line.get_linewidth())
        is_any_narrow |= width < line.get_linewidth()
        line.set_linewidth(width)
    marked = _mark(axes, marks)
    kinds = set(summary["kind"])
    thinner = ", thinner where narrow" if is_any_narrow else ""
    entries: tuple[tuple[Any, str, dict[str, Any]], ...] = (
        (kinds - {"main"}, "main branch", {"linewidth": _THIN}),
        *((kind in kinds, word + (thinner if kind == "isola" else ""), look) for kind, word, look in _KINDS),
        (has_unstable, "unstable", {"linestyle": _DASHES}),
        (has_unknown, "stability not known", {"linewidth": _BOLD, "color": faded(SHADE)}),
        (branches and not is_verified, "stability not known: nothing was verified", {"linewidth": _BOLD}),
        *((kind in marked, kind, look) for kind, look in _MARKS.items()),
    )
    for wanted, label, how in entries:
        if wanted:
            add_line(axes, [], [], label=label, **{"color": SHADE, **how})
    if backbone:
        _draw_backbones(run, axes, units, monitor)
    axes.set(
        xlabel=units.of_frequency(run.model.forcing_harmonic),
        ylabel=f"amplitude of {run.model.dofs[run.model.monitors[monitor]]} ({units.of_length})",
    )
    fit_texts(axes)
    legend(axes)
    named = [branch for branch in branches if len(levels) > _NAMED or len(branch.names) > 1]
    named.sort(key=lambda branch: (rank[branch.row["amplitude"]], branch.is_main))
    write_names(axes, curves, [branch.name_at_peak(colors[branch.row["amplitude"]]) for branch in named])
    return axes


def _frequencies(branches: Sequence[_Branch], folds: dict[str, list[int]]) -> Floats:
    """Frequencies, rad/s, that are to be seen: all of isolas, the upper parts of main branches, and their folds, without which one looks like
    two; not those of a resonance far from all isolas."""
    shown = np.concatenate([branch.shown for branch in branches])
    low, high = float(shown.min()), float(shown.max())
    far = np.inf if all(branch.is_main for branch in branches) else high - low
    turns = [branch.omega[i] for branch in branches for i in folds.get(str(branch.row.name), []) if branch.is_high_at(i)]
    return np.array([low, high, *(omega for omega in turns if low - far <= omega <= high + far)])


def _branches(summary: pd.DataFrame, table: pd.DataFrame, units: Units) -> list[_Branch]:
    """Curves to be drawn, each once, in the order of the summary."""
    points = table.groupby("name", sort=False)
    found: list[_Branch] = []
    for name, row in summary.iterrows():
        if name not in points.groups:
            continue  # its points are damaged: reading them has warned
        curve = points.get_group(name)
        is_high = curve["amplitude"] >= _HIGH * curve["amplitude"].max()
        shown = curve["omega"][is_high] if row["kind"] == "main" else curve["omega"]
        if row["closed"]:
            curve = pd.concat([curve, curve.iloc[:1]])
        at, height = units.frequencies(curve["omega"]).to_numpy(), units.lengths(curve["amplitude"]).to_numpy()
        omega = curve["omega"].to_numpy()
        branch = _Branch(row, at, height, curve["stable"].to_numpy(), omega, shown, [str(name).partition("/")[2]])
        same = next((one for one in found if one.is_beneath(branch)), None)
        if same is None:
            found.append(branch)
        else:
            same.names.extend(branch.names)
    return found


def _points(run: StoredRun, monitor: int) -> pd.DataFrame:
    """Points of all branches, with what is known of their stability: nothing in runs of the first programs."""
    try:
        points = run.columns("omega", "amplitude", "stable")
    except KeyError:
        points = run.columns("omega", "amplitude").assign(stable="")
    return _of(monitor, points, "name", lambda name: run[name])


def _of(monitor: int, table: pd.DataFrame, by: str, read: Callable[[Any], Motions]) -> pd.DataFrame:
    """The table with the amplitude of this monitored dof: tables of points have that of the first one alone."""
    for name, rows in table.groupby(by, sort=False).groups.items() if monitor else ():
        try:
            table.loc[rows, "amplitude"] = read(name)["amplitude"].values[:, monitor]
        except Damaged as damage:
            warnings.warn(f"{by} {name} is left out: {damage.detail}.", LeftOut, stacklevel=5)
            table = table.drop(rows)
    return table


def _draw_backbones(run: StoredRun, axes: Axes, units: Units, monitor: int) -> None:
    """The backbones, as far up as the axes go: they need not set the scale."""
    table = _of(monitor, run.backbones, "mode", lambda mode: run.backbone(int(mode)))
    (left, right), top = axes.get_xlim(), axes.get_ylim()[1]
    for mode, curve in table.groupby("mode", sort=False):
        label = f"backbone of mode {mode}" if table["mode"].nunique() > 1 else "backbone"
        lengths = by_pieces(curve, units.lengths(curve["amplitude"]))
        at, height = up_to(top, units.frequencies(curve["omega"]).to_numpy(), lengths)
        low, high = np.minimum(at[1:], at[:-1]), np.maximum(at[1:], at[:-1])
        if ((low <= right) & (high >= left) & np.isfinite(height[1:] + height[:-1])).any():
            add_line(axes, at, height, color=SHADE, linestyle="--", linewidth=1.0, zorder=1, label=label)


def _mark(axes: Axes, marks: dict[str, list[tuple[float, float, Any]]]) -> set[str]:
    """Marks peaks and folds within the axes, each with its place and its colour, but no fold that a peak covers; which kinds there are."""
    (left, right), marked = axes.get_xlim(), set()
    places = {kind: [mark for mark in found if left <= mark[0] <= right] for kind, found in marks.items()}
    taken = axes.transData.transform(np.array([mark[:2] for mark in places["peak"]]).reshape(-1, 2))
    for kind, found in places.items() if len(taken) <= _MARKED else ():
        for x, y, color in found:
            if kind == "peak" or np.hypot(*(taken - axes.transData.transform((x, y))).T).min(initial=np.inf) > MARK:
                add_line(axes, [x], [y], color=color, zorder=4, **_MARKS[kind])
                marked.add(kind)
    return marked


def _fit_height(axes: Axes, curves: Sequence[Line2D], limits: tuple[float, float]) -> None:
    """The axis upwards as far as curves go between these limits."""
    places = [np.asarray(line.get_xydata(), dtype=float) for line in curves]
    heights = [place[(place[:, 0] >= limits[0]) & (place[:, 0] <= limits[1]), 1] for place in places]
    shown = np.concatenate([np.zeros(0), *heights])
    shown = shown[np.isfinite(shown)]
    if len(shown) and shown.max() > 0.0:
        axes.set_ylim(0.0, 1.08 * shown.max())
