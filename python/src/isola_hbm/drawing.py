"""What figures share: units, axes, limits, colours, legends and names beside curves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .live.wire import Floats

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.collections import Collection
    from matplotlib.lines import Line2D
    from matplotlib.path import Path
    from numpy.typing import ArrayLike, NDArray

    from .live.types import Model

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
#: A share of the height of the figure that axes below a legend have at least.
_CURVES = 0.5
#: A share of the width of the figure that texts along axes take at most: axes stand a little to the right.
_ACROSS = 0.8
#: How far above or below its point a name stands, points; else at the end of a line that leads so far to a side, and up or down.
_BESIDE = 3.0
_AWAY = [(way * far, up) for far in (8, 20, 36, 60) for up in (0, 12, -12, 26, -26) for way in (1, -1)]


@dataclass(frozen=True)
class Units:
    """Units of lengths and frequencies, as of ``isola sweep --units``."""

    #: None if it is the one in which the lengths of a figure are read best.
    length: str | None = "m"
    frequency: str = "rad/s"

    LENGTHS: ClassVar = {"m": 1.0, "mm": 1e3, "um": 1e6}
    #: Lengths from which on each unit is read best, m, as in figures of the program.
    READ_FROM: ClassVar = {"m": 1.0, "mm": 1e-4, "um": 1e-7}
    FREQUENCIES: ClassVar = {"rad/s": 1.0, "Hz": 0.5 / np.pi}

    @classmethod
    def read(cls, text: str) -> Units:
        """``mm,Hz``, ``mm`` or ``Hz``; what is not named is SI.

        Raises:
            ValueError: There is no such unit.
            TypeError: They are no text.
        """
        if not isinstance(text, str):
            raise TypeError(f"units = {text!r}: a text is needed, one of m, mm, um and one of rad/s, Hz, as in 'mm,Hz'")
        chosen = [part.strip() for part in text.split(",")]
        lengths = [part for part in chosen if part in cls.LENGTHS]
        frequencies = [part for part in chosen if part in cls.FREQUENCIES]
        if len(lengths) > 1 or len(frequencies) > 1 or len(lengths) + len(frequencies) < len(chosen):
            raise ValueError(f"units = {text!r}: one of m, mm, um and one of rad/s, Hz, as in 'mm,Hz'")
        return cls(*(lengths or ["m"]), *(frequencies or ["rad/s"]))

    @classmethod
    def kept(cls, text: str) -> Units:
        """Those that a run keeps, in which lengths need not be named."""
        units = cls.read(text) if text else cls()
        has_length = any(part.strip() in cls.LENGTHS for part in text.split(","))
        return units if has_length else replace(units, length=None)

    def fitted(self, largest: float) -> Units:
        """These for lengths up to this one, m."""
        if self.length is not None:
            return self
        is_none = largest == 0.0 or not np.isfinite(largest)
        fitting = "m" if is_none else next((unit for unit, least in self.READ_FROM.items() if largest >= least), "nm")
        return replace(self, length=fitting)

    def lengths(self, values: Any) -> Any:
        """Lengths in m in these units."""
        return values * (1e9 if self.length == "nm" else self.LENGTHS[self.length or "m"])

    def frequencies(self, values: Any) -> Any:
        """Frequencies in rad/s in these units."""
        return values * self.FREQUENCIES[self.frequency]

    def of_frequency(self, harmonic: int = 1) -> str:
        """The label of an axis: of the frequency of a response whose harmonic of this number is forced."""
        # ω is in rad/s.
        name = "frequency ω" if self.frequency == "rad/s" else "frequency"
        force = f" of the response, 1/{harmonic} of the force's" if harmonic > 1 else ""
        return f"{name}{force} ({self.frequency})"

    @property
    def of_length(self) -> str:
        """The unit of lengths as figures have it."""
        return (self.length or "m").replace("um", "µm")


def of_forcing(model: Model) -> str:
    """What follows the label of an axis of forcing amplitudes: the unit, if the force acts on one dof, as figures of the program have it."""
    (acting,) = np.nonzero(model.forcing)
    if len(acting) != 1:
        return ""
    force = model.forcing[acting[0]]
    return f" ({'' if force == 1.0 else f'units of {text(force)} '}N at {model.dofs[acting[0]]})"


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
    """A legend, if there is anything to tell: inside of the axes where it covers nothing, else above them where the figure makes
    room for what stands there, else above all curves, which then end below it."""
    from matplotlib.transforms import Bbox, TransformedBbox

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
    # A title stands where such a legend would.
    if axes.figure.get_layout_engine() is not None and not axes.get_title():
        _legend_above(axes, handles, labels)
        return
    found = axes.legend(handles, labels, fontsize="small", loc="upper center", ncols=2)
    root.draw_without_rendering()
    share = (found.get_window_extent().y0 - 2.0 - axes.bbox.y0) / axes.bbox.height
    if share > _LEAST:
        low, high = axes.transData.inverted().transform(axes.transAxes.transform([(0.0, 0.0), (0.0, 1.0 / share)]))[:, 1]
        axes.set_ylim(low, high)
        # What goes on beyond what is shown is cut below the legend, as it was at the frame.
        below = TransformedBbox(Bbox([[0.0, 0.0], [1.0, share]]), axes.transAxes)
        for line in axes.get_lines():
            line.set_clip_box(below)


def _legend_above(axes: Axes, handles: list[Any], labels: list[str]) -> None:
    """A legend above axes, in as many columns, and if need be as small, as leave all of it in the figure."""
    root = axes.figure.canvas.figure
    place: dict[str, Any] = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "columnspacing": 1.2, "handlelength": 1.6}
    for size in ("small", "x-small", "xx-small"):
        for count in (3, 2, 1):
            found = axes.legend(handles, labels, fontsize=size, ncols=count, **place)
            # What is too wide would leave the axes no room.
            if found.get_window_extent().width > root.bbox.width:
                found.remove()
                continue
            root.draw_without_rendering()
            box = found.get_window_extent()
            if box.x0 < 0.0 or box.x1 > root.bbox.x1:
                continue
            # Most of the room is that of the curves; fewer columns would take more of it.
            if box.y1 <= root.bbox.y1 and axes.bbox.height > _CURVES * root.bbox.height:
                return
            break


def fit_texts(axes: Axes) -> None:
    """Makes the title and what is written along both axes as small as has room in the figure."""
    for written in (axes.title, axes.xaxis.label, axes.yaxis.label):
        # What stands along the axis upwards is turned.
        way = "height" if written is axes.yaxis.label else "width"
        for size in ("medium", "small", "x-small", "xx-small"):
            if getattr(written.get_window_extent(), way) <= _ACROSS * getattr(axes.figure.bbox, way):
                break
            written.set_fontsize(size)


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


@dataclass(frozen=True)
class Named:
    """A name at a point, with its colour; where it stands best."""

    name: str
    x: float
    y: float
    color: Any
    is_below: bool = False


def write_names(
    axes: Axes,
    curves: Iterable[Line2D | Collection],
    names: Iterable[Named],
    mark: float = 0.0,
    faint: Sequence[Iterable[Line2D | Collection]] = (),
) -> None:
    """Names where they cover neither these curves nor the legend nor each other, nor marks at their points, which reach so far (points),
    nor faint curves if that can be, of several groups rather the last ones: the first ones first."""
    from matplotlib.patheffects import withStroke
    from matplotlib.transforms import Bbox

    # Places are known once all else is laid out; the root of subfigures does that.
    root, names = axes.figure.canvas.figure, list(names)
    root.draw_without_rendering()
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    firm, *thin = ([path for curve in some for path in _paths(curve)] for some in (curves, *faint))
    # What is not written over: all curves, then ever fewer groups of the faint ones.
    avoided = [firm + [path for some in thin[:count] for path in some] for count in range(len(thin), -1, -1)]
    rivals = avoided[min(1, len(thin))]
    halo = [withStroke(linewidth=2, foreground="white")]
    legend, reach, beside = axes.get_legend(), mark * root.dpi / 72.0, (_BESIDE + mark) * root.dpi / 72.0
    taken: list[Any] = [legend.get_window_extent()] if legend else []
    for named in names if mark else ():
        x, y = axes.transData.transform((named.x, named.y))
        taken.append(Bbox.from_extents(x - reach, y - reach, x + reach, y + reach))
    for named in names:
        is_shown = left <= named.x <= right and low <= named.y <= high
        places = list(_places(named.is_below, mark)) if is_shown else []
        x, y = axes.transData.transform((named.x, named.y))
        here = Bbox.from_extents(x - MARK, y - MARK, x + MARK, y + MARK)
        others = [path for path in rivals if not path.intersects_bbox(here, filled=False)]
        for paths, (offset, align, vertical) in product(avoided, places):
            place: dict[str, Any] = {"xy": (named.x, named.y), "xytext": offset, "textcoords": "offset points"}
            written = axes.annotate(named.name, **place, color=named.color, fontsize="small", ha=align, va=vertical)
            written.set(in_layout=False, path_effects=halo)
            box = written.get_window_extent().padded(1)
            is_inside = axes.bbox.x0 < box.x0 and box.x1 < axes.bbox.x1 and axes.bbox.y0 < box.y0 and box.y1 < axes.bbox.y1
            # Without a line that leads there it is nearest to its own curve.
            is_own = align != "center" or not any(path.intersects_bbox(box.padded(beside), filled=False) for path in others)
            is_free = is_own and not box.count_overlaps(taken) and not any(
                path.intersects_bbox(box, filled=False) for path in paths
            )
            if is_inside and is_free:
                taken.append(box)
                if align != "center":
                    arrow = {"arrowstyle": "-", "color": named.color, "linewidth": 0.5}
                    axes.annotate("", **place, arrowprops=arrow)
                break
            written.remove()


def _places(is_below: bool, mark: float) -> Iterator[tuple[tuple[float, float], str, str]]:
    """Where a name may stand: offset from its point, and what of it is there."""
    beside = [((0.0, _BESIDE + mark), "center", "bottom"), ((0.0, -_BESIDE - mark), "center", "top")]
    yield from beside[::-1] if is_below else beside
    yield from (((right, up), "left" if right > 0 else "right", "center") for right, up in _AWAY if abs(right) > mark)


def _paths(curve: Line2D | Collection) -> list[Path]:
    """What is drawn of a curve, in pixels."""
    own = curve.get_paths() if hasattr(curve, "get_paths") else [curve.get_path()]
    return [path.transformed(curve.get_transform()) for path in own]


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
