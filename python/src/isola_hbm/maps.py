"""The isola map: which responses exist at which forcing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from .asked import Limits
from .counted import digits
from .drawing import (
    FOLDS,
    INK,
    ISOLA,
    SHADE,
    WORK,
    Named,
    Units,
    add_line,
    beside,
    by_pieces,
    fit_texts,
    legend,
    logarithmic,
    of_forcing,
    write_names,
)
from .isolas import mode_of_isola
from .live.wire import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

    from .stored.run import StoredRun

@dataclass(frozen=True)
class _Event:
    """How a kind of events is marked and worded, as in the figures of the program."""

    mark: str
    is_hollow: bool
    #: In the legend.
    many: str
    #: On labels.
    word: str
    #: How large marks are, points: those of what is predicted show behind those of the same thing as computed, which lie over them.
    size: float
    order: float


#: Events by source and kind. Where A* has a maximum windows merge; along a fold curve branches may part as well.
_EVENTS = {
    ("computed", "birth"): _Event("^", False, "births", "born", 5.0, 2.6),
    ("computed", "death"): _Event("x", False, "deaths", "dies", 5.0, 2.6),
    ("computed", "merge"): _Event("v", True, "merges or partings", "merge or part", 5.0, 2.6),
    ("predicted", "birth"): _Event("^", False, "births", "born", 9.0, 2.5),
    ("predicted", "merge"): _Event("v", True, "merges", "merge", 9.0, 2.5),
}
#: Cusps are neither births nor ends: they are marked, but have no labels, and the map is not about them.
_CUSP = _Event("s", True, "cusps, computed (two folds meet)", "", 4.4, 2.6)
#: Of more events none has a label; how far marks reach, points.
_LABELLED, _MARK = 8, 5.0
#: Digits of a forcing that have to agree with those of twice the harmonics, which are told otherwise.
_AGREED = 3
#: What the legend says where a label has a number that is another one with twice the harmonics.
_TWICE = "2H: with twice the harmonics"
#: Bars are at most so thick, as a share of the distance between levels, and at least, points.
_SHARE, _FINE = 0.5, 0.6
#: Bars from this width on are not written over.
_THICK = 1.0
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
    run: StoredRun, summary: pd.DataFrame, axes: Axes, units: Units, limits: tuple[Limits | None, Limits | None]
) -> Axes:
    """Draws branches of every level, which are these rows of the summary, thresholds along the backbones, fold curves and
    events, between these limits of the axes (frequencies, forcing amplitudes) or, without, around what happens."""
    across, up = limits
    for kind, label, look in _BARS:
        rows = summary[summary["kind"] == kind]
        ends = units.frequencies(rows[["omega_min", "omega_max"]]).to_numpy(float).T
        if len(rows):
            axes.hlines(rows["amplitude"].to_numpy(float), *ends, label=label, **look)
    levels = list(summary["amplitude"])
    thresholds = _draw_thresholds(run, axes, units, levels)
    if up is not None:
        axes.set_ylim(up)
    logarithmic(axes)
    events, folds, names = _draw_folds(run, axes, units, levels)
    # Main and open branches go from one end of the frequencies to the other.
    others = summary[~summary["kind"].isin(["main", "open"])]
    ends = np.concatenate([others["omega_min"], others["omega_max"]])
    happens = _marked(run.events) if levels else run.events[:0]
    among: Any = happens["forcing"].between(min(levels) / _AMONG[0], max(levels) * _AMONG[1]) if levels else []
    core = np.concatenate([ends, happens["omega"][among].to_numpy(float)])
    shown = _around(core, np.concatenate([events, folds, thresholds]))
    if across is not None:
        axes.set_xlim(across)
    elif len(shown):
        axes.set_xlim(units.frequencies(beside(shown)))
    axes.set(xlabel=units.of_frequency(run.model.forcing_harmonic), ylabel=f"forcing amplitude A, threshold A*{of_forcing(run.model)}")
    fit_texts(axes)
    for line in axes.get_lines():
        if line.get_label() != _TWICE and not _is_in_sight(axes, line):
            # The legend passes over names that begin like this.
            line.set_label("_beyond")
    # Lines from end to end are thin, and may be written over.
    bars = [bars for bars in axes.collections if np.max(bars.get_linewidth()) >= _THICK]
    faint = [lines for lines in axes.collections if lines not in bars]
    most = _room_of_bars(axes, levels)
    for lines in bars:
        lines.set_linewidth(float(min(np.max(lines.get_linewidth()), most)))
    legend(axes)
    curves = [line for line in axes.get_lines() if line.get_linestyle() != "None"]
    written = names if len(names) <= _LABELLED else []
    # Where there is no room between curves a name stands over them, as in the figures of the program.
    write_names(axes, bars, written, _MARK, [curves, faint])
    return axes


def _is_in_sight(axes: Axes, line: Line2D) -> bool:
    """Whether any of a curve or of marks lies within the frame."""
    path = line.get_path().transformed(axes.transData)
    if line.get_linestyle() == "None":
        return bool(axes.bbox.count_contains(path.vertices))
    return bool(path.intersects_bbox(axes.bbox, filled=False))


def _room_of_bars(axes: Axes, levels: list[float]) -> float:
    """How thick bars are at most, points: a share of the distance between levels, but for a few that lie closer."""
    places = axes.transData.transform([(axes.get_xlim()[0], level) for level in sorted(set(levels))] or [(0.0, 1.0)])[:, 1]
    distances = np.sort(np.diff(places)) * 72.0 / axes.figure.canvas.figure.dpi
    return max(_FINE, _SHARE * distances[len(distances) // 4]) if len(distances) else np.inf


def _marked(events: pd.DataFrame) -> pd.DataFrame:
    """Those events that have marks."""
    return events[[key in _EVENTS for key in zip(events["source"], events["kind"])]]


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
    """The thresholds: the axis upwards is that of those near the levels. Frequencies of these, rad/s."""
    table, about = run.backbones, mode_of_isola(run)
    # The mode that figures are about comes first, as a rule the primary one; the others stand back.
    modes = sorted(table["mode"].unique().tolist(), key=lambda mode: about is not None and mode != about)
    near = _near(run, levels) if levels else (0.0, np.inf)
    shown = []
    for i, mode in enumerate(modes):
        curve = table[table["mode"] == mode]
        is_near = curve["threshold"].between(*near).to_numpy()
        if i and not is_near.any():
            continue
        # A* is infinite where the forcing does no work.
        threshold = by_pieces(curve, curve["threshold"].where(np.isfinite(curve["threshold"])))
        omega = units.frequencies(curve["omega"].to_numpy())
        first = f"threshold A* of mode {mode}" if len(modes) > 1 else "threshold A* of the backbone"
        label = (first, "threshold A* of further modes", None)[min(i, 2)]
        width = 0.75 if i else 1.2
        add_line(axes, omega, threshold, color=INK, linewidth=width, label=label)
        axes.update_datalim(np.column_stack([omega, curve["threshold"]])[is_near])
        shown.append(curve["omega"].to_numpy()[is_near])
    # Of a further order of motions there may be events beyond its levels and no thresholds up to them.
    happens = _marked(run.events)
    happens = happens[happens["forcing"].between(*near)] if levels else happens[:0]
    if len(happens):
        axes.update_datalim(np.column_stack([units.frequencies(happens["omega"]), happens["forcing"]]))
    axes.autoscale_view()
    return np.concatenate([np.zeros(0), *shown])


def _near(run: StoredRun, levels: list[float]) -> tuple[float, float]:
    """Forcing amplitudes about the levels, and as far beyond as something happens near them."""
    forcing = _marked(run.events)["forcing"]
    happens = forcing[forcing.between(min(levels) / _NEAR[0], max(levels) * _NEAR[1])]
    return min([min(levels) / _ROOM, *happens]), max([max(levels) * _ROOM, *happens])


def _name(event: _Event, row: Any) -> str:
    """What happens, and at which forcing, in the words and the digits of the program: those that twice the harmonics leave as they are."""
    if row.source == "predicted":
        return f"{event.word} at {digits(row.forcing, _AGREED)}"
    own, doubled = ([digits(value, _AGREED + more) for more in (1, 0)] for value in (row.forcing, row.forcing_2h))
    same = next((one for one, other in zip(own, doubled) if one == other), None)
    doubt = "not found" if np.isnan(row.forcing_2h) else doubled[0]
    return f"{row.outcome or event.word} at {same or f'{own[0]} (2H: {doubt})'}"


def _draw_folds(
    run: StoredRun, axes: Axes, units: Units, levels: list[float]
) -> tuple[Floats, Floats, list[Named]]:
    """Fold curves and events, where they are near the levels. Frequencies, rad/s: of computed events, and of folds among the levels; then
    names of events, the computed ones first."""
    low, high = axes.get_ylim()
    folds, events, names = run.folds, _marked(run.events), []
    is_met = folds.groupby("curve")["forcing"].transform(lambda forcing: low <= forcing.max() and forcing.min() <= high)
    for i, (_, curve) in enumerate(folds[is_met.astype(bool)].groupby("curve", sort=False)):
        label = "folds, computed" if i == 0 else None
        add_line(axes, units.frequencies(curve["omega"]), curve["forcing"], color=FOLDS, linewidth=1.2, label=label)
    shown = events[events["forcing"].between(low, high)]
    for (source, kind), group in shown.groupby(["source", "kind"]):
        event, color = _EVENTS[str(source), str(kind)], FOLDS if source == "computed" else INK
        own = [_name(event, row) for row in group.itertuples()]
        axes.plot(
            units.frequencies(group["omega"]),
            group["forcing"],
            event.mark,
            color=color,
            markerfacecolor="none" if event.is_hollow else color,
            markersize=event.size,
            zorder=event.order,
            label=f"{event.many}, {source}",
        )
        for name, x, y in zip(own, units.frequencies(group["omega"]), group["forcing"]):
            names.append(Named(name, x, y, color, kind == "birth"))
    cusps = run.events[(run.events["kind"] == "cusp") & run.events["forcing"].between(low, high)]
    if len(cusps):
        at = units.frequencies(cusps["omega"])
        look = {"color": FOLDS, "markerfacecolor": "none", "markersize": _CUSP.size, "zorder": _CUSP.order}
        axes.plot(at, cusps["forcing"], _CUSP.mark, label=_CUSP.many, **look)
    if any("2H" in named.name for named in names):
        axes.plot([], [], linestyle="none", label=_TWICE)
    computed = shown["omega"][shown["source"] == "computed"].to_numpy(float)
    among = folds["forcing"].between(min(levels), max(levels)) if levels else folds["forcing"].isna()
    return computed, folds["omega"][among].to_numpy(float), names
