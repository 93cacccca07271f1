"""Figures of a run on disk, with matplotlib: on axes of yours, or on new ones."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from .asked import Levels, Limits, checked, is_axes, is_flag, levels_of, limits_of
from .drawing import (
    INK,
    ISOLA,
    WORK,
    Units,
    axes_of,
    by_pieces,
    fit_texts,
    legend,
    logarithmic,
    text,
)
from .drawn import Drawn
from .errors import NoSuchBranch
from .isolas import mode_of_isola, windows_of_isolas
from .maps import isola_map
from .responses import forced_response
from .stored.motions import index_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .stored.run import Key, StoredRun

#: With fewer points a piece of a backbone says nothing: all of it is shown.
_FEWEST = 4
#: Energies below this share of the largest are not shown.
_FLOOR = 1e-6


class Plots(Drawn):
    """The figures of a run. Each takes `ax`, matplotlib axes to draw on (by default new ones), and returns them."""

    def __init__(self, run: StoredRun) -> None:
        self._run = run

    def _units(self, chosen: str | None) -> Units:
        return Units.kept(self._run._kept_units()) if chosen is None else Units.read(chosen)

    @checked
    def response(
        self,
        levels: Levels | None = None,
        *,
        monitor: str | None = None,
        ax: Axes | None = None,
        units: str | None = None,
        backbone: bool = True,
        frequency: Limits | None = None,
        response: Limits | None = None,
        amplitudes: Levels | None = None,
    ) -> Axes:
        """Amplitude of a monitored dof over frequency: main branches thin, isolas and others bold, what time marching found
        unstable dashed, and pale what of their stability is not known. Branches whose curves lie on each
        other (mirror images) are drawn once, under the names of all of them. Peaks and folds are marked, unless there are many branches; more
        than six levels are named at their peaks.

        Args:
            levels: Forcing levels shown: numbers, or a text as after ``isola plot --levels`` (``"20:60:20"``); by default all.
            monitor: Monitored dof whose amplitude is shown; by default the first one.
            ax: Axes to draw on.
            units: ``m``, ``mm`` or ``um`` and ``rad/s`` or ``Hz``, as in ``"mm,Hz"``; by default those that the run keeps, lengths
                of which it keeps none in the unit in which they are read best.
            backbone: Whether the backbone is drawn as well.
            frequency: Lowest and highest frequency shown, in the unit of the axis; by default where something happens.
            response: Lowest and highest amplitude of the response shown, in the unit of the axis; by default from zero on.
            amplitudes: The same as `levels`.

        Raises:
            ValueError: There is no branch at these levels, no such monitored dof or unit: with those there are. Limits are no
                range.
            TypeError: An argument is of another type, or there is no such argument.
        """
        if levels is not None and amplitudes is not None:
            raise TypeError("response: levels and amplitudes are the same; give one of them")
        limits = limits_of("frequency", frequency), limits_of("response", response)
        measured, number, has_backbone = self._units(units), self._number(monitor), is_flag("backbone", backbone)
        summary = self._branches(amplitudes if levels is None else levels)
        return forced_response(self._run, summary, axes_of(is_axes(ax)), measured, number, limits, has_backbone)

    def _monitors(self) -> list[str]:
        """Names of the monitored dofs."""
        return [self._run.model.dofs[dof] for dof in self._run.model.monitors]

    def _number(self, monitor: str | None) -> int:
        """Which of the monitored dofs this is."""
        names = self._monitors()
        if monitor is not None and monitor not in names:
            raise ValueError(f"monitor = {monitor!r}: the run monitors no such dof, but {', '.join(names)}")
        return 0 if monitor is None else names.index(monitor)

    @checked
    def map(
        self,
        levels: Levels | None = None,
        *,
        ax: Axes | None = None,
        units: str | None = None,
        frequency: Limits | None = None,
        forcing: Limits | None = None,
    ) -> Axes:
        """Which responses exist at which forcing: branches of every level, the threshold A* along the backbones, fold
        curves, births and merges as predicted and as computed. Drawn around the branches apart from the main ones; curves of other
        modes may go on beyond.

        Args:
            levels: Forcing levels whose branches are shown, as of :meth:`response`; by default all.
            ax: Axes to draw on.
            units: ``rad/s`` or ``Hz``; by default that of the run.
            frequency: Lowest and highest frequency shown, in the unit of the axis; by default where something happens.
            forcing: Lowest and highest forcing amplitude shown; by default where something happens.

        Raises:
            ValueError: There is no branch at these levels, or no such unit. Limits are no range.
            TypeError: An argument is of another type, or there is no such argument.
        """
        limits = limits_of("frequency", frequency), limits_of("forcing", forcing, is_positive=True)
        measured, summary = self._units(units), self._branches(levels)
        return isola_map(self._run, summary, axes_of(is_axes(ax)), measured, limits)

    @checked
    def balance(
        self, amplitude: float | None = None, *, mode: int | None = None, ax: Axes | None = None
    ) -> Axes:
        """Energies along a backbone: what has to be supplied against the work of the forcing. Where that is larger, a
        response is predicted.

        Drawn as far as levels come near the threshold.

        Args:
            amplitude: Any forcing amplitude A, for the balance is that of all of them; by default the lowest level at which a window led
                to an isola of its frequencies, else the lowest with an isola, else the middle one.
            mode: Mode of the backbone, from 1; by default that of the window that led to an isola of its frequencies at this amplitude
                or, if none did, at the lowest level, else the primary one.
            ax: Axes to draw on.

        Raises:
            ValueError: The amplitude is no number above zero.
            TypeError: The axes are none of matplotlib, or there is no such argument.
            NoSuchBranch: There is no backbone of this mode.
        """
        summary = self._run.summary
        levels = sorted(summary["amplitude"].unique())
        if amplitude is None:
            others = summary[summary["kind"] != "main"]["amplitude"]
            middle = levels[len(levels) // 2 : len(levels) // 2 + 1]
            predicted = windows_of_isolas(self._run)["amplitude"]
            amplitude = float(min(predicted, default=min(others, default=sum(middle) or 1.0)))
        elif isinstance(amplitude, bool) or not isinstance(amplitude, Real) or not 0.0 < amplitude < np.inf:
            raise ValueError(f"amplitude = {amplitude!r}: a number above zero is needed")
        mode = mode_of_isola(self._run, float(amplitude)) if mode is None else mode
        curve = self._run.backbone(mode)
        # Beyond the last threshold of twice the highest level nothing is predicted for any of them.
        near = np.flatnonzero(curve["threshold"].to_numpy() <= 2.0 * max([*levels, float(amplitude)]))
        curve = curve.isel(point=slice(near[-1] + 1)) if len(near) and near[-1] >= _FEWEST else curve
        axes = axes_of(is_axes(ax))
        arc, work = curve["arc"].to_numpy(), float(amplitude) * curve["work_per_amplitude"].to_numpy()
        work = by_pieces(curve, work)
        # A* is infinite where the forcing does no work.
        with np.errstate(invalid="ignore"):
            needed = by_pieces(curve, curve["threshold"] * curve["work_per_amplitude"])
        # Where the forcing does no work, rounding does.
        floor = _FLOOR * np.nanmax([*needed, *work], initial=0.0)
        work, needed = np.where(work > floor, work, np.nan), np.where(needed > floor, needed, np.nan)
        axes.plot(arc, needed, color=INK, label="to be supplied, A*·W")
        axes.plot(arc, work, color=WORK, linestyle="--", label="supplied, A·W")
        # Windows of one or two points have a width as well.
        is_window = (work > needed).tolist()
        axes.fill_between(
            arc,
            needed,
            work,
            where=is_window,
            interpolate=True,
            color=ISOLA,
            alpha=0.2,
            label="supply is larger: windows" if any(is_window) else None,
        )
        beside = "" if amplitude in levels else " (no level of the run)"
        title = f"A = {text(amplitude)}{beside}, mode {curve.attrs['mode']}"
        across = ", then along curves beside it" if "piece" in curve and curve["piece"].max() > 0 else ""
        axes.set(xlabel=f"arc length along the backbone{across} (scaled)", ylabel="energy per period (J)", title=title)
        fit_texts(axes)
        logarithmic(axes)
        legend(axes)
        return axes

    @checked
    def motion(
        self,
        branch: Key | None = None,
        *,
        point: int | str = "peak",
        dofs: Sequence[str] | str | None = None,
        variable: str = "displacement",
        ax: Axes | None = None,
        units: str | None = None,
    ) -> Axes:
        """One period at a point of a branch.

        Args:
            branch: Name of the branch, ``"60/isola 1"``; by default the highest isola, else the highest branch that is not open.
            point: Index of the point from 0, ``"peak"`` or ``"start"``.
            dofs: Names of dofs; by default the monitored ones. Of ``variable="argument"`` names of laws and contacts, or of one of
                their arguments (``"tip 1"``); by default all.
            variable: ``displacement``; ``argument``: of the laws, for contacts the predicted pressure in N.
            ax: Axes to draw on.
            units: ``m``, ``mm`` or ``um``, of displacements, and ``rad/s`` or ``Hz``, of the frequency in the title; by default as of
                :meth:`response`.

        Raises:
            NoSuchBranch: There is no such branch.
            IndexError: It has no such point.
            KeyError: There is no such dof.
            ValueError: The variable is another one, or there is no such unit.
            TypeError: An argument is of another type, or there is no such argument.
        """
        if variable not in ("displacement", "argument"):
            raise ValueError(f"variable = {variable!r}: displacement or argument is drawn; run[branch].time() has others")
        names = [dofs] if isinstance(dofs, str) else [] if dofs is None else dofs
        if not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
            raise TypeError(f"dofs = {dofs!r}: the name of a dof or a list of them is needed")
        measured, curve = self._units(units), self._run[self._highest() if branch is None else branch]
        index = index_of(curve, point)
        series = curve.isel(point=index).time(variable, samples=512).load()
        along = next(str(axis) for axis in series.dims if axis != "time")
        is_length = variable == "displacement"
        there = [str(name) for name in series[along].values]
        shown = list(names or (curve["monitor"].values if is_length else there))
        # A law has one argument or three, which are numbered.
        shown = [one for name in shown for one in (_arguments(name, there) if not is_length else []) or [name]]
        if unknown := [name for name in shown if name not in there]:
            raise KeyError(
                f"no `{unknown[0]}` among what is stored of a motion; there are {', '.join(there)}"
            )
        axes = axes_of(is_axes(ax))
        if is_length:
            measured = measured.fitted(float(np.abs(series.sel({along: shown})).max()))
        for name in shown:
            values = series.sel({along: name})
            axes.plot(series["time"], measured.lengths(values) if is_length else values, label=str(name))
        # What contacts have for an argument is a pressure, and what others have is a length.
        of_laws = series.sel({along: shown}).coords.get("unit", series.attrs["units"])
        quantity = (
            f"displacement ({measured.of_length})"
            if is_length
            else f"argument of the law ({', '.join(dict.fromkeys(np.atleast_1d(of_laws).tolist()))})"
        )
        at = f"{measured.frequencies(float(curve['omega'][index])):.6g} {measured.frequency}"
        title = f"A = {curve.attrs['level']}, {curve.attrs['name']}, point {index}, {at}"
        axes.set(xlabel="time (periods)", ylabel=quantity, title=title)
        fit_texts(axes)
        legend(axes)
        return axes

    def _highest(self) -> str:
        """Name of the highest isola, else of the highest branch but those that leave through both ends, else of the highest of all."""
        summary = self._branches(None)
        if not len(summary):
            raise NoSuchBranch("the run has no branch yet")
        kinds = (summary["kind"] == "isola", summary["kind"] != "open", summary["kind"].notna())
        chosen = next(summary[of_kind] for of_kind in kinds if of_kind.any())
        return str(chosen["amplitude_max"].astype(float).idxmax())

    def _branches(self, levels: Levels | None) -> pd.DataFrame:
        """Rows of the summary, of these levels, that are branches."""
        summary = self._run.summary
        summary = summary[summary["points"].notna()]
        if levels is None:
            return summary
        return summary[summary["amplitude"].isin(levels_of(levels, sorted(summary["amplitude"].unique())))]


def _arguments(name: str, there: Sequence[str]) -> list[str]:
    """The arguments of a law or contact of this name, unless it is one of them."""
    return [] if name in there else [one for one in there if one.rpartition(" ")[0] == name]
