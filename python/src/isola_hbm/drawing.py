"""What figures share: units, axes, limits, colours, legends and names beside curves."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .live.wire import Floats

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D
    from numpy.typing import ArrayLike, NDArray

#: Colours as in the figures of the program, of what is not a branch.
INK, SHADE, ISOLA, FOLDS, WORK = "#1a2027", "#8b96a1", "#d55e00", "#b0508a", "#7a3300"
#: Colours of levels from the lowest to the highest, as in the figures of the program.
_RAMP = ["#e08a2e", "#d9604f", "#bc3a72", "#8c1f8a", "#561a8f", "#1c0f63"]
#: How much of a colour is in what is faded.
_FADED = 0.4
#: Room beside what is shown, as a share of its width.
_ROOM = 0.25
#: What is left free beside the ends of everything, as a share of the width.
_EDGE = 0.025
#: Room where the figure goes on beside what is shown, as that of the map does.
_MARGIN = 0.05
#: Where a legend may stand inside of the axes, the first that is free.
_FREE: tuple[Any, ...] = ("upper right", "upper left", "lower left", "lower right", "center right", "center left")
#: How far marks reach, pixels; a share of the height that curves have at least below a legend.
MARK, _LEAST = 6.0, 0.3
#: Where the name of a curve may stand beside its peak, points: above it, else at the end of a line to one side.
_PLACES = [((0, 3), "center")] + [
    ((way * far, 0), align) for far in (8, 20, 36, 60) for way, align in ((1, "left"), (-1, "right"))
]


@dataclass(frozen=True)
class Units:
    """Units of lengths and frequencies, as of ``isola sweep --units``."""

    length: str = "m"
    frequency: str = "rad/s"

    LENGTHS: ClassVar = {"m": 1.0, "mm": 1e3, "um": 1e6}
    FREQUENCIES: ClassVar = {"rad/s": 1.0, "Hz": 0.5 / np.pi}

    @classmethod
    def read(cls, text: str) -> Units:
        """``mm,Hz``, ``mm`` or ``Hz``; what is not named is SI."""
        chosen = [part.strip() for part in text.split(",")]
        lengths = [part for part in chosen if part in cls.LENGTHS]
        frequencies = [part for part in chosen if part in cls.FREQUENCIES]
        if len(lengths) > 1 or len(frequencies) > 1 or len(lengths) + len(frequencies) < len(chosen):
            raise ValueError(f"units = {text!r}: one of m, mm, um and one of rad/s, Hz, as in 'mm,Hz'")
        return cls(*(lengths or ["m"]), *(frequencies or ["rad/s"]))

    def lengths(self, values: Any) -> Any:
        """Lengths in m in these units."""
        return values * self.LENGTHS[self.length]

    def frequencies(self, values: Any) -> Any:
        """Frequencies in rad/s in these units."""
        return values * self.FREQUENCIES[self.frequency]

    def of_frequency(self, harmonic: int = 1) -> str:
        """The label of an axis: of the frequency of a response whose harmonic of this number is forced."""
        name = "ω" if self.frequency == "rad/s" else "f"
        force = f" of the response, 1/{harmonic} of the force's" if harmonic > 1 else ""
        return f"frequency {name}{force} ({self.frequency})"


def axes_of(ax: Axes | None) -> Axes:
    """The axes to draw on; new ones if there are none."""
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("figures need matplotlib: pip install 'isola-hbm[plot]'") from error
    return plt.subplots(layout="constrained")[1]


def add_line(axes: Axes, x: Any, y: Any, **look: Any) -> None:
    """Draws a line as `axes.plot` does, but leaves the limits of the axes as they are."""
    from matplotlib.lines import Line2D

    axes.add_artist(Line2D(x, y, **look))


def logarithmic(axes: Axes) -> None:
    """A logarithmic axis upwards whose ticks are plain numbers: 0.1, 0.2, 0.5 where it spans less than two decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 100 * low else (1.0,)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: text(value)))
    axes.yaxis.set_minor_formatter(NullFormatter())


def around(shown: Floats, reach: tuple[float, float]) -> Floats:
    """Limits around what is shown, with room beside it, within reach and a little more."""
    low, high = float(np.min(shown)), float(np.max(shown))
    room = _ROOM * (high - low)
    limits = np.array([max(low - room, reach[0]), min(high + room, reach[1])])
    limits = limits if limits[1] > limits[0] else np.array(reach)
    # What ends at a limit, as the tip of an isola, is not cut in two.
    return limits + _EDGE * (limits[1] - limits[0]) * np.array([-1.0, 1.0])


def limits_of(frequency: tuple[float, float] | None) -> tuple[float, float] | None:
    """The limits of an axis of frequencies that were asked for.

    Raises:
        ValueError: They are no range.
    """
    if frequency is None:
        return None
    try:
        low, high = (float(end) for end in frequency)
    except (TypeError, ValueError):
        low = high = np.nan
    if not (np.isfinite([low, high]).all() and low < high):
        raise ValueError(f"frequency = {frequency!r}: the lowest and the highest one shown, as in (2400.0, 2500.0)")
    return low, high


def beside(shown: Floats) -> Floats:
    """Limits around what is shown, with as much room beside it as in figures of the program."""
    low, high = float(np.min(shown)), float(np.max(shown))
    # One frequency alone has a figure around it as well.
    room = _MARGIN * ((high - low) or abs(high) or 1.0)
    return np.array([low - room, high + room])


def along_ramp(count: int) -> list[Any]:
    """Colours of so many levels."""
    from matplotlib.colors import LinearSegmentedColormap

    ramp = LinearSegmentedColormap.from_list("levels", _RAMP)
    return [ramp(share) for share in np.linspace(0.0, 1.0, count)] if count > 1 else [_RAMP[-1]] * count


def faded(color: Any) -> Any:
    """The colour of what is not known of a curve of this one, as in the figures of the program."""
    from matplotlib.colors import to_rgb

    return tuple(1.0 + _FADED * (channel - 1.0) for channel in to_rgb(color))


def along(wanted: NDArray[np.bool_], at: Floats, height: Floats) -> tuple[Floats, Floats]:
    """Those segments of a curve, each from a point to the next, that are wanted, with gaps between them."""
    starts = np.flatnonzero(wanted[1:] & ~wanted[:-1]) + 1
    is_shown = np.append(wanted, False) | np.insert(wanted, 0, False)
    # One that is not wanted between two that are lies between points that are shown.
    at, height = np.where(is_shown, at, np.nan), np.where(is_shown, height, np.nan)
    return np.insert(at, starts, np.nan), np.insert(height, starts, np.nan)


def legend(axes: Axes) -> None:
    """A legend, if there is anything to tell: inside of the axes where it covers nothing, else beside them where the figure makes
    room for what stands there, else above all curves, which then end below it."""
    handles, labels = axes.get_legend_handles_labels()
    if not labels:
        return
    # Places are known once all else is laid out; the root of subfigures does that.
    root = axes.figure.canvas.figure
    drawn = _Drawn(axes)
    for place in _FREE:
        found = axes.legend(handles, labels, fontsize="small", loc=place)
        root.draw_without_rendering()
        if drawn.is_free(found.get_window_extent()):
            return
    if axes.figure.get_layout_engine() is not None:
        if axes.get_title():
            beside: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)}
        else:
            beside = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncols": 2 if len(labels) < 7 else 3}
        axes.legend(handles, labels, fontsize="small", **beside)
        return
    found = axes.legend(handles, labels, fontsize="small", loc="upper center", ncols=2)
    root.draw_without_rendering()
    share = (found.get_window_extent().y0 - 2.0 - axes.bbox.y0) / axes.bbox.height
    if share > _LEAST:
        low, high = axes.transData.inverted().transform(axes.transAxes.transform([(0.0, 0.0), (0.0, 1.0 / share)]))[:, 1]
        axes.set_ylim(low, high)


class _Drawn:
    """What is drawn on axes, where a legend would cover it."""

    def __init__(self, axes: Axes) -> None:
        self._axes = axes

    def is_free(self, box: Any) -> bool:
        """Whether nothing is drawn in a box, in pixels."""
        for line in self._axes.get_lines():
            path = line.get_path().transformed(line.get_transform())
            if line.get_linestyle() != "None" and path.intersects_bbox(box, filled=False):
                return False
            if line.get_marker() not in ("None", "", None) and box.padded(MARK).count_contains(path.vertices):
                return False
        for collection in self._axes.collections:
            for path in collection.get_paths():
                outline = path.transformed(collection.get_transform())
                if outline.intersects_bbox(box, filled=bool(len(collection.get_facecolor()))):
                    return False
        return True


def spread(count: int) -> list[int]:
    """The order in which so many levels are named: last, first, middle, quarters, …"""
    order = [count - 1, 0] if count > 1 else list(range(count))
    parts = 2
    while len(order) < count:
        places = [k * count // parts for k in range(1, parts)]
        order += [place for place in dict.fromkeys(places) if place not in order]
        parts *= 2
    return order


def name_curves(axes: Axes, curves: Iterable[Line2D], names: Iterable[tuple[str, float, float, Any]]) -> None:
    """Names at points, each with its place and its colour, where they cover neither these curves nor the legend nor each other: the
    first ones first."""
    from matplotlib.patheffects import withStroke

    # Places are known once all else is laid out; the root of subfigures does that.
    axes.figure.canvas.figure.draw_without_rendering()
    left, right = axes.get_xlim()
    paths = [line.get_path().transformed(line.get_transform()) for line in curves]
    halo = [withStroke(linewidth=2, foreground="white")]
    legend = axes.get_legend()
    taken: list[Any] = [legend.get_window_extent()] if legend else []
    for name, x, y, color in names:
        for offset, align in _PLACES if left <= x <= right else ():
            vertical = "baseline" if align == "center" else "center"
            place: dict[str, Any] = {"xy": (x, y), "xytext": offset, "textcoords": "offset points"}
            written = axes.annotate(name, **place, color=color, fontsize="small", ha=align, va=vertical)
            written.set(in_layout=False, path_effects=halo)
            box = written.get_window_extent().padded(1)
            is_inside = axes.bbox.x0 < box.x0 and box.x1 < axes.bbox.x1
            is_free = not box.count_overlaps(taken) and not any(
                path.intersects_bbox(box, filled=False) for path in paths
            )
            if is_inside and is_free:
                taken.append(box)
                if align != "center":
                    axes.annotate(
                        "", **place, arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.5}
                    )
                break
            written.remove()


def text(value: float) -> str:
    """A number as people write it."""
    return f"{value:g}"


def by_pieces(curve: pd.DataFrame | xr.Dataset, values: ArrayLike) -> Floats:
    """Values along a backbone, NaN at the first point of every piece but one: lines break there."""
    values = np.array(values, dtype=float)
    # Runs of before have one piece.
    if "piece" in curve and len(values):
        values[1:][np.diff(curve["piece"].to_numpy()) != 0] = np.nan
    return values


def up_to(top: float, at: Floats, height: Floats) -> tuple[Floats, Floats]:
    """A curve as far up as `top`, to where it gets there between two of its points; NaN beyond."""
    is_shown = height <= top
    crossings = np.flatnonzero(is_shown[1:] != is_shown[:-1])
    share = (top - height[crossings]) / (height[crossings + 1] - height[crossings])
    between = at[crossings] + share * (at[crossings + 1] - at[crossings])
    at, height = np.insert(at, crossings + 1, between), np.insert(height, crossings + 1, top)
    return at, np.where(height <= top, height, np.nan)
