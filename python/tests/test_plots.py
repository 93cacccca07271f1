"""Figures: that they show the numbers of the run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest
from runs import change

import isola_hbm


@pytest.fixture(autouse=True)
def _figures() -> Iterator[None]:
    yield
    plt.close("all")


#: What the legend says of dashes.
UNSTABLE = "unstable (solid: stable, or not known)"


def labels(axes: plt.Axes) -> list[str]:
    """Texts of the legend."""
    return axes.get_legend_handles_labels()[1]


def test_response(damper: Path) -> None:
    run = isola_hbm.load(damper)
    axes = run.plot.response(units="mm,Hz")
    # What is unstable is dashed, as backbones are.
    drawn = [line for line in axes.get_lines() if line.get_linestyle() == "-"]
    assert len(drawn) == len(run)
    isola = run["0.006/isola 1"]
    line = drawn[list(run).index("0.006/isola 1")]
    # A closed branch ends where it began; between points that are both unstable there is a gap.
    at, height = (values[np.isfinite(values)] for values in line.get_data())
    np.testing.assert_allclose(height[:-1], 1e3 * isola["amplitude"][:, 0])
    np.testing.assert_allclose(at[:-1], isola["omega"] / (2 * np.pi))
    assert at[0] == at[-1]
    unstable = run.columns("stable").query("name == '0.006/isola 1'")["stable"].to_numpy() == "unstable"
    unstable = np.append(unstable, unstable[0])
    assert np.isnan(line.get_xdata()).sum() == (unstable[1:] & unstable[:-1]).sum()
    assert labels(axes) == ["A = 0.004", "A = 0.005", "A = 0.006", "A = 0.007", UNSTABLE, "backbone"]
    assert axes.get_xlabel() == "frequency f (Hz)"
    assert axes.get_ylabel() == "largest |x1| (mm)"
    low, high = axes.get_xlim()
    assert low < float(isola["omega"].min()) / (2 * np.pi) < float(isola["omega"].max()) / (2 * np.pi) < high


def test_levels_are_chosen_and_axes_given(damper: Path) -> None:
    run = isola_hbm.load(damper)
    _, mine = plt.subplots()
    assert labels(run.plot.response(0.006)) == labels(run.plot.response(["0.006"]))
    axes = run.plot.response(["0.006", 0.007], ax=mine, backbone=False)
    assert axes is mine
    assert labels(axes) == ["A = 0.006", "A = 0.007", UNSTABLE]
    with pytest.raises(ValueError, match=r"no branch at A = 0.3; there are branches at A = 0.004, 0.005"):
        run.plot.response([0.3])
    with pytest.raises(ValueError, match="one of m, mm, um and one of rad/s, Hz"):
        run.plot.response(units="mm,inch")


def test_map(damper: Path) -> None:
    axes = isola_hbm.load(damper).plot.map()
    expected = {
        "main branches",
        "isolas and others",
        "threshold A*",
        "folds",
        "births, computed",
        "births, predicted",
    }
    assert expected <= set(labels(axes))
    (mains, isolas) = axes.collections
    assert len(mains.get_segments()) == 4
    heights = [segment[0][1] for segment in isolas.get_segments()]
    assert heights == [0.005, 0.006, 0.007]
    axes.figure.canvas.draw()
    low, high = axes.get_ylim()
    ticks = [label.get_text() for label in axes.get_yticklabels()]
    assert {"0.002", "0.005", "0.01"} <= set(ticks) and low < 0.005 < high, ticks


def test_balance(damper: Path) -> None:
    run = isola_hbm.load(damper)
    axes = run.plot.balance()
    needed, supplied = axes.get_lines()
    assert axes.get_title() == "A = 0.005, mode 1"
    # A response is predicted where more is supplied than needed: where A* is below A.
    backbone = run.backbone()
    predicted = supplied.get_ydata() > needed.get_ydata()
    np.testing.assert_array_equal(predicted, backbone["threshold"] < 0.005)
    assert 0 < predicted.sum() < len(predicted)
    with pytest.raises(isola_hbm.NoSuchBranch, match="no backbone of mode 5"):
        run.plot.balance(0.005, mode=5)


def test_motion(blade: Path) -> None:
    run = isola_hbm.load(blade)
    axes = run.plot.motion("20/main", units="mm")
    (line,) = axes.get_lines()
    branch = run["20/main"]
    peak = branch.attrs["peak"]
    assert np.abs(line.get_ydata()).max() == pytest.approx(
        1e3 * float(branch["amplitude"][peak, 0]), rel=1e-3
    )
    assert f"point {peak}" in axes.get_title()
    axes = run.plot.motion((20, "main"), point=3, dofs=["b0.r", "b1.theta"])
    assert labels(axes) == ["b0.r", "b1.theta"]
    axes = run.plot.motion("20/main", variable="argument", dofs=["b0 1"])
    assert axes.get_ylabel().startswith("argument")
    with pytest.raises(IndexError, match="point 999 of 121"):
        run.plot.motion("20/main", point=999)
    assert labels(run.plot.motion("20/main", dofs="b0.r")) == ["b0.r"]
    with pytest.raises(KeyError, match="no `b9.r` among what is stored of a motion; there are b0.r, "):
        run.plot.motion("20/main", dofs=["b9.r"])


def test_a_run_without_branches_has_empty_figures(copy: Path) -> None:
    change(copy, "DELETE FROM points; DELETE FROM branches; DELETE FROM curve_points; DELETE FROM curves")
    run = isola_hbm.load(copy)
    assert labels(run.plot.response(backbone=False)) == []
    assert "threshold A*" in labels(run.plot.map())
