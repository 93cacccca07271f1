"""Figures of a run on disk, with matplotlib: on axes of yours, or on new ones."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pandas as pd

from .live.wire import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .stored.run import Key, StoredRun

#: Colours as in the figures of the program: levels from the lowest to the highest, and what is not a branch.
_RAMP = ["#e08a2e", "#d9604f", "#bc3a72", "#8c1f8a", "#561a8f", "#1c0f63"]
_INK, _SHADE, _ISOLA, _FOLDS, _WORK = "#1a2027", "#8b96a1", "#d55e00", "#b0508a", "#7a3300"
#: Marks of events by kind.
_MARKS = {
    "birth": ("^", "births"),
    "merge": ("v", "merges"),
    "death": ("x", "deaths"),
    "cusp": (".", "cusps"),
}
#: A main branch is shown at least where it is higher than this share of its peak, with this room beside, as a share of the width.
_HIGH, _ROOM = 0.8, 0.25
#: Thresholds are shown from the lowest level divided by the first to the highest one times the second, as folds are followed.
_NEAR = (4.0, 2.0)
#: Most entries of a legend of levels.
_NAMED = 12


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

    def of_frequency(self) -> str:
        """The label of an axis."""
        return f"frequency {'ω' if self.frequency == 'rad/s' else 'f'} ({self.frequency})"


class Plots:
    """The figures of a run. Each takes `ax`, matplotlib axes to draw on (by default new ones), and returns them."""

    def __init__(self, run: StoredRun) -> None:
        self._run = run

    def response(
        self,
        amplitudes: Iterable[str | float] | str | float | None = None,
        *,
        ax: Axes | None = None,
        units: str = "m,rad/s",
        backbone: bool = True,
    ) -> Axes:
        """Amplitude of the first monitored dof over frequency: main branches thin, isolas and others bold, what time marching
        found unstable dashed.

        Args:
            amplitudes: Forcing amplitudes shown; by default all.
            ax: Axes to draw on.
            units: ``m``, ``mm`` or ``um`` and ``rad/s`` or ``Hz``, as in ``"mm,Hz"``.
            backbone: Whether the backbone is drawn as well.
        """
        measured, axes = Units.read(units), _axes(ax)
        summary = self._branches(amplitudes)
        points = self._points().groupby("name", sort=False)
        levels = sorted(summary["amplitude"].unique())
        colors = dict(zip(levels, _along_ramp(len(levels))))
        shown, has_unstable = [], False
        for name, row in summary.iterrows():
            if name not in points.groups:
                continue  # its points are damaged: reading them has warned
            curve = points.get_group(name)
            is_high = curve["amplitude"] >= _HIGH * curve["amplitude"].max()
            shown.append(curve["omega"][is_high] if row["kind"] == "main" else curve["omega"])
            if row["closed"]:
                curve = pd.concat([curve, curve.iloc[:1]])
            is_main = row["kind"] == "main"
            label = f"A = {_text(row['amplitude'])}" if is_main and len(levels) <= _NAMED else None
            style = {
                "color": colors[row["amplitude"]],
                "linewidth": 1.0 if is_main else 2.2,
                # What a lower level has lies inside of what a higher one has.
                "zorder": 3.0 - levels.index(row["amplitude"]) / len(levels),
            }
            at = measured.frequencies(curve["omega"]).to_numpy()
            height = measured.lengths(curve["amplitude"]).to_numpy()
            unstable = (curve["stable"] == "unstable").to_numpy()
            # From one unstable point to the next the solid line has a gap, and there are dashes.
            gaps = np.flatnonzero(unstable[1:] & unstable[:-1]) + 1
            axes.plot(np.insert(at, gaps, np.nan), np.insert(height, gaps, np.nan), label=label, **style)
            if unstable.any():
                axes.plot(at, np.where(unstable, height, np.nan), linestyle=(0, (2.5, 1.5)), **style)
                has_unstable = True
        if has_unstable:
            label = "unstable (solid: stable, or not known)"
            axes.plot([], [], color=_SHADE, linestyle=(0, (2.5, 1.5)), label=label)
        if shown:
            axes.set_xlim(measured.frequencies(_around(np.concatenate(shown), self._reach(summary))))
        self._draw_backbone(axes, measured, backbone)
        monitor = self._run.model.dofs[self._run.model.monitors[0]]
        axes.set(xlabel=measured.of_frequency(), ylabel=f"largest |{monitor}| ({measured.length})")
        _legend(axes)
        return axes

    def _points(self) -> pd.DataFrame:
        """Points of all branches, with what is known of their stability: nothing in runs of the first programs."""
        try:
            return self._run.columns("omega", "amplitude", "stable")
        except KeyError:
            return self._run.columns("omega", "amplitude").assign(stable="")

    def _draw_backbone(self, axes: Axes, units: Units, wanted: bool) -> None:
        """The backbones as far up as there are branches: they need not set the scale."""
        table = self._run.backbones
        if not wanted or table.empty:
            return
        (left, right), top = axes.get_xlim(), axes.get_ylim()[1]
        for mode, curve in table.groupby("mode", sort=False):
            label = f"backbone of mode {mode}" if table["mode"].nunique() > 1 else "backbone"
            height, at = units.lengths(curve["amplitude"]), units.frequencies(curve["omega"])
            if not at.between(left, right).any():
                continue
            axes.plot(
                at,
                height.where(height <= top),
                color=_SHADE,
                linestyle="--",
                linewidth=1.0,
                zorder=1,
                label=label,
            )

    def map(self, *, ax: Axes | None = None, units: str = "m,rad/s") -> Axes:
        """Which responses exist at which forcing: branches of every level, the threshold A* along the backbones, fold
        curves, births and merges as predicted and as computed.

        Args:
            ax: Axes to draw on.
            units: ``rad/s`` or ``Hz``.
        """
        measured, axes = Units.read(units), _axes(ax)
        summary = self._branches(None)
        mains = summary["kind"] == "main"
        for rows, label, color, width in (
            (summary[mains], "main branches", _SHADE, 0.6),
            (summary[~mains], "isolas and others", _ISOLA, 3.0),
        ):
            ends = measured.frequencies(rows[["omega_min", "omega_max"]]).to_numpy(float).T
            levels = rows["amplitude"].to_numpy(float)
            if len(rows):
                axes.hlines(levels, *ends, color=color, linewidth=width, label=label)
        shown = self._draw_thresholds(axes, measured, list(summary["amplitude"]))
        self._draw_folds(axes, measured)
        shown = np.concatenate([shown, summary[~mains]["omega_min"], summary[~mains]["omega_max"]])
        if len(shown) and len(summary):
            axes.set_xlim(measured.frequencies(_around(shown, self._reach(summary))))
        axes.set(xlabel=measured.of_frequency(), ylabel="forcing amplitude A, threshold A*")
        _logarithmic(axes)
        _legend(axes)
        return axes

    def _draw_thresholds(self, axes: Axes, units: Units, levels: list[float]) -> Floats:
        """The thresholds near the levels: elsewhere they say nothing. Their frequencies, rad/s."""
        table = self._run.backbones
        near = (min(levels) / _NEAR[0], max(levels) * _NEAR[1]) if levels else (0.0, np.inf)
        shown = []
        for i, (_, curve) in enumerate(table.groupby("mode", sort=False)):
            threshold = curve["threshold"].where(curve["threshold"].between(*near))
            label = "threshold A*" if i == 0 else None
            axes.plot(units.frequencies(curve["omega"]), threshold, color=_INK, linewidth=1.2, label=label)
            shown.append(curve["omega"][threshold.notna()].to_numpy())
        return np.concatenate([np.zeros(0), *shown])

    def _draw_folds(self, axes: Axes, units: Units) -> None:
        low, high = axes.get_ylim()
        folds, events = self._run.folds, self._run.events
        for i, (_, curve) in enumerate(folds.groupby("curve", sort=False)):
            forcing = curve["forcing"].where(curve["forcing"].between(low, high))
            label = "folds" if i == 0 else None
            axes.plot(units.frequencies(curve["omega"]), forcing, color=_FOLDS, linewidth=1.2, label=label)
        shown = events[events["forcing"].between(low, high)]
        for (source, kind), group in shown.groupby(["source", "kind"], sort=False):
            mark, name = _MARKS.get(str(kind), ("o", str(kind)))
            color = _FOLDS if source == "computed" else _INK
            at = units.frequencies(group["omega"])
            axes.plot(at, group["forcing"], mark, color=color, label=f"{name}, {source}")

    def balance(
        self, amplitude: float | None = None, *, mode: int | None = None, ax: Axes | None = None
    ) -> Axes:
        """Energies along a backbone: what has to be supplied against the work of the forcing. Where that is larger, a
        response is predicted.

        Args:
            amplitude: Forcing amplitude A; by default the lowest with an isola, else the lowest of all.
            mode: Mode of the backbone, from 1; by default the primary one.
            ax: Axes to draw on.
        """
        axes, curve = _axes(ax), self._run.backbone(mode)
        if amplitude is None:
            summary = self._run.summary
            isolas = summary[summary["kind"] == "isola"]
            levels = (isolas if len(isolas) else summary)["amplitude"]
            amplitude = float(levels.min()) if len(levels) else 1.0
        arc, work = curve["arc"].to_numpy(), float(amplitude) * curve["work_per_amplitude"].to_numpy()
        # A* is infinite where the forcing does no work.
        with np.errstate(invalid="ignore"):
            needed = (curve["threshold"] * curve["work_per_amplitude"]).to_numpy()
        axes.plot(arc, needed, color=_INK, label="to be supplied, A*·W")
        axes.plot(arc, work, color=_WORK, linestyle="--", label="supplied, A·W")
        # Windows of one or two points have a width as well.
        is_window = (work > needed).tolist()
        axes.fill_between(
            arc,
            needed,
            work,
            where=is_window,
            interpolate=True,
            color=_ISOLA,
            alpha=0.2,
            label="windows",
        )
        title = f"A = {_text(amplitude)}, mode {curve.attrs['mode']}"
        axes.set(xlabel="arc length (scaled)", ylabel="energy a period (J)", title=title)
        _logarithmic(axes)
        _legend(axes)
        return axes

    def motion(
        self,
        branch: Key,
        *,
        point: int | str = "peak",
        dofs: Sequence[str] | str | None = None,
        variable: str = "displacement",
        ax: Axes | None = None,
        units: str = "m,rad/s",
    ) -> Axes:
        """One period at a point of a branch.

        Args:
            branch: Name of the branch, ``"60/isola 1"``.
            point: Index of the point from 0, ``"peak"`` or ``"start"``.
            dofs: Names of dofs; by default the monitored ones. Of ``variable="argument"`` names of arguments.
            variable: ``displacement``; ``argument``: of the laws, for contacts the predicted pressure in N.
            ax: Axes to draw on.
            units: ``m``, ``mm`` or ``um``, of displacements.

        Raises:
            NoSuchBranch: There is no such branch.
            IndexError: It has no such point.
            KeyError: There is no such dof.
        """
        measured, axes, curve = Units.read(units), _axes(ax), self._run[branch]
        count = curve.sizes["point"]
        index = curve.attrs.get(point) if isinstance(point, str) else point
        if index is None or not -count <= index < count:
            raise IndexError(f"point {point!r} of {count}: give an index from 0, 'peak' or 'start'")
        series = curve.isel(point=index).time(variable, samples=512).load()
        along = next(str(axis) for axis in series.dims if axis != "time")
        is_length = variable == "displacement"
        there = [str(name) for name in series[along].values]
        shown = [dofs] if isinstance(dofs, str) else list(dofs or (curve["monitor"].values if is_length else there))
        if unknown := [name for name in shown if name not in there]:
            raise KeyError(f"no `{unknown[0]}` among what is stored of a motion; there are {', '.join(there)}")
        for name in shown:
            values = series.sel({along: name})
            axes.plot(series["time"], measured.lengths(values) if is_length else values, label=str(name))
        quantity = (
            f"displacement ({measured.length})" if is_length else f"{variable} ({series.attrs['units']})"
        )
        at = f"{measured.frequencies(float(curve['omega'][index])):.6g} {measured.frequency}"
        title = f"A = {curve.attrs['level']}, {curve.attrs['name']}, point {index}, {at}"
        axes.set(xlabel="time (periods)", ylabel=quantity, title=title)
        _legend(axes)
        return axes

    @staticmethod
    def _reach(summary: pd.DataFrame) -> tuple[float, float]:
        """Lowest and highest frequency of any branch, rad/s."""
        return float(summary["omega_min"].min()), float(summary["omega_max"].max())

    def _branches(self, amplitudes: Iterable[str | float] | str | float | None) -> pd.DataFrame:
        """Rows of the summary, of these levels, that are branches."""
        summary = self._run.summary
        summary = summary[summary["points"].notna()]
        if amplitudes is None:
            return summary
        if isinstance(amplitudes, str) or not isinstance(amplitudes, Iterable):
            amplitudes = [amplitudes]
        chosen = {float(amplitude) for amplitude in amplitudes}
        unknown = chosen - set(summary["amplitude"])
        if unknown:
            there = ", ".join(_text(value) for value in sorted(summary["amplitude"].unique()))
            raise ValueError(f"no branch at A = {_text(min(unknown))}; there are branches at A = {there}")
        return summary[summary["amplitude"].isin(chosen)]


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("figures need matplotlib: pip install 'isola-hbm[plot]'") from error
    return plt.subplots(layout="constrained")[1]


def _logarithmic(axes: Axes) -> None:
    """A logarithmic axis upwards whose ticks are plain numbers: 0.1, 0.2, 0.5 where it spans less than two decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 100 * low else (1.0,)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _text(value)))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _around(shown: Floats, reach: tuple[float, float]) -> Floats:
    """Limits around what is shown, with room beside it, within reach."""
    low, high = float(np.min(shown)), float(np.max(shown))
    room = _ROOM * (high - low)
    limits = np.array([max(low - room, reach[0]), min(high + room, reach[1])])
    return limits if limits[1] > limits[0] else np.array(reach)


def _along_ramp(count: int) -> list[Any]:
    from matplotlib.colors import LinearSegmentedColormap

    ramp = LinearSegmentedColormap.from_list("levels", _RAMP)
    return [ramp(share) for share in np.linspace(0.0, 1.0, count)] if count > 1 else [_RAMP[-1]] * count


def _legend(axes: Axes) -> None:
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize="small")


def _text(value: float) -> str:
    return f"{value:g}"
