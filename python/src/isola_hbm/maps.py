"""The isola map: which responses exist at which forcing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from .drawing import FOLDS, INK, ISOLA, SHADE, WORK, Units, beside, by_pieces, legend, logarithmic, text
from .live.wire import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .stored.run import StoredRun

#: Marks of events by kind, as in the figures of the program: mark, whether it is hollow, name. Cusps are not marked.
_MARKS = {
    "birth": ("^", False, "births"),
    "merge": ("v", True, "merges or partings"),
    "death": ("x", False, "ends of isolas"),
}
#: What their labels say, unless there are more than so many events; where they stand, points; how.
_MARKED = {"birth": "born at", "merge": "merge or part at", "death": "ends at"}
_BELOW = {"birth": (0, -14), "merge": (0, 7), "death": (0, 7)}
_LABELLED = 8
_NOTE: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "fontsize": "small"}
#: What happens from the lowest level divided by the first to the highest one times the second, as folds are followed, is shown.
_NEAR = (4.0, 2.0)
#: Where nothing happens beyond the levels, thresholds are shown this factor below and above them.
_ROOM = 1.5
#: What happens from the lowest level divided by the first of these to the highest one times the second is what the map is about.
_AMONG = (2.0, 1.25)
#: Curves are shown this far on each side of that, as a share of its range.
_BESIDE = 1.0
#: How the map draws branches of each kind, as that of the program: what branches off an isola lies within its bar.
_BARS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("main", "main branches", {"color": SHADE, "linewidth": 0.6}),
    ("open", "open branches", {"color": ISOLA, "linewidth": 0.6, "linestyle": "--"}),
    ("isola", "isolas", {"color": ISOLA, "linewidth": 3.0}),
    ("cut", "cut off by a bound", {"color": ISOLA, "linewidth": 2.2, "linestyle": (0, (4.0, 1.5))}),
    ("unfinished", "unfinished", {"color": ISOLA, "linewidth": 2.2, "linestyle": ":"}),
    ("branched", "branches off another", {"color": WORK, "linewidth": 1.3}),
)


def isola_map(
    run: StoredRun, summary: pd.DataFrame, axes: Axes, units: Units, limits: tuple[float, float] | None
) -> Axes:
    """Draws branches of every level, which are these rows of the summary, thresholds along the backbones, fold curves and
    events, between these frequencies of the axis or, without, around what happens."""
    for kind, label, look in _BARS:
        rows = summary[summary["kind"] == kind]
        ends = units.frequencies(rows[["omega_min", "omega_max"]]).to_numpy(float).T
        if len(rows):
            axes.hlines(rows["amplitude"].to_numpy(float), *ends, label=label, **look)
    levels = list(summary["amplitude"])
    thresholds = _draw_thresholds(run, axes, units, levels)
    events, folds = _draw_folds(run, axes, units, levels)
    # Main and open branches go from one end of the frequencies to the other.
    others = summary[~summary["kind"].isin(["main", "open"])]
    ends = np.concatenate([others["omega_min"], others["omega_max"]])
    happens = run.events[run.events["kind"].isin(list(_MARKS))] if levels else run.events[:0]
    among: Any = happens["forcing"].between(min(levels) / _AMONG[0], max(levels) * _AMONG[1]) if levels else []
    core = np.concatenate([ends, happens["omega"][among].to_numpy(float)])
    shown = _around(core, np.concatenate([events, folds, thresholds]))
    if limits is not None:
        axes.set_xlim(limits)
    elif len(shown):
        axes.set_xlim(units.frequencies(beside(shown)))
    axes.set(xlabel=units.of_frequency(run.model.forcing_harmonic), ylabel="forcing amplitude A, threshold A*")
    logarithmic(axes)
    legend(axes)
    return axes


def _around(core: Floats, others: Floats) -> Floats:
    """Frequencies of what the map is about, and others as far as they lie beside these; without any, the others."""
    core, others = core[np.isfinite(core)], others[np.isfinite(others)]
    if not len(core):
        return others
    # One frequency alone has a figure around it as well, as in the program.
    low, high = core.min(), core.max()
    low, high = (low, high) if high - low > 1e-9 * high else (0.95 * low, 1.05 * high)
    room = _BESIDE * (high - low)
    return np.concatenate([core, np.clip(others, low - room, high + room)])


def _draw_thresholds(run: StoredRun, axes: Axes, units: Units, levels: list[float]) -> Floats:
    """The thresholds near the levels: elsewhere they say nothing. Their frequencies, rad/s."""
    table = run.backbones
    near = _near(run, levels) if levels else (0.0, np.inf)
    shown = []
    for i, (_, curve) in enumerate(table.groupby("mode", sort=False)):
        threshold = pd.Series(by_pieces(curve, curve["threshold"].where(curve["threshold"].between(*near))), curve.index)
        if i and not threshold.notna().any():
            continue
        # The primary mode comes first; the others stand back.
        label = ("threshold A*", "threshold A* of further modes", None)[min(i, 2)]
        width = 0.75 if i else 1.2
        axes.plot(units.frequencies(curve["omega"]), threshold, color=INK, linewidth=width, label=label)
        shown.append(curve["omega"][threshold.notna()].to_numpy())
    return np.concatenate([np.zeros(0), *shown])


def _near(run: StoredRun, levels: list[float]) -> tuple[float, float]:
    """Forcing amplitudes about the levels, and as far beyond as something happens near them."""
    forcing = run.events["forcing"][run.events["kind"].isin(list(_MARKS))]
    happens = forcing[forcing.between(min(levels) / _NEAR[0], max(levels) * _NEAR[1])]
    return min([min(levels) / _ROOM, *happens]), max([max(levels) * _ROOM, *happens])


def _draw_folds(run: StoredRun, axes: Axes, units: Units, levels: list[float]) -> tuple[Floats, Floats]:
    """Fold curves and events, where they are near the levels. Frequencies, rad/s: of computed events, and of folds among the levels."""
    low, high = axes.get_ylim()
    folds, events = run.folds, run.events
    for i, (_, curve) in enumerate(folds.groupby("curve", sort=False)):
        forcing = curve["forcing"].where(curve["forcing"].between(low, high))
        label = "folds" if i == 0 else None
        axes.plot(units.frequencies(curve["omega"]), forcing, color=FOLDS, linewidth=1.2, label=label)
    shown = events[events["forcing"].between(low, high)]
    for (source, kind), group in shown.groupby(["source", "kind"], sort=False):
        if kind not in _MARKS:
            continue
        mark, is_hollow, name = _MARKS[str(kind)]
        color = FOLDS if source == "computed" else INK
        axes.plot(
            units.frequencies(group["omega"]),
            group["forcing"],
            mark,
            color=color,
            markerfacecolor="none" if is_hollow else color,
            label=f"{name}, {source}",
        )
        for x, y in zip(units.frequencies(group["omega"]), group["forcing"]) if len(shown) <= _LABELLED else ():
            axes.annotate(f"{_MARKED[str(kind)]} {text(float(f'{y:.3g}'))}", (x, y), _BELOW[str(kind)], **_NOTE, color=color)
    is_marked = (shown["source"] == "computed") & shown["kind"].isin(list(_MARKS))
    among = folds["forcing"].between(min(levels), max(levels)) if levels else folds["forcing"].isna()
    return shown["omega"][is_marked].to_numpy(float), folds["omega"][among].to_numpy(float)
