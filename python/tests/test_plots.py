"""Figures: that they show the numbers of the run."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest
from runs import MODELS, ROOT, change, isola

import isola_hbm
from isola_hbm.asked import instead, levels_of
from isola_hbm.counted import digits
from isola_hbm.drawing import Named, Units, along_ramp, faded, spread, write_names
from isola_hbm.isolas import mode_of_isola
from isola_hbm.maps import _EVENTS
from isola_hbm.responses import _mark


@pytest.fixture(autouse=True)
def _figures() -> Iterator[None]:
    yield
    plt.close("all")


#: What the legend says of stability.
UNSTABLE, UNKNOWN = "unstable", "stability not known"


def labels(axes: plt.Axes) -> list[str]:
    """Texts of the legend."""
    return axes.get_legend_handles_labels()[1]


def test_units_are_those_of_the_run(damper: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = isola_hbm.load(damper)
    assert run.units == "m,rad/s"
    monkeypatch.setattr(type(run), "study", property(lambda _: 'units = "µm,Hz"'))
    assert run.units == "um,Hz"
    texts = [(axes.get_xlabel(), axes.get_ylabel()) for axes in (run.plot.response(), run.plot.response(units="mm"))]
    assert "Hz" in texts[0][0] and "µm" in texts[0][1] + texts[0][1].replace("um", "µm")
    assert "rad/s" in texts[1][0] and "mm" in texts[1][1]


def test_lengths_of_no_kept_unit_are_those_of_the_program(
    damper: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = isola_hbm.load(damper)
    assert "units" not in run.study
    axes = run.plot.response()
    drawn = run.plot.figure("response").svg
    [unit] = [unit for unit in ("m", "mm", "µm", "nm") if f"amplitude of x1 ({unit})" in drawn]
    assert axes.get_ylabel() == f"amplitude of x1 ({unit})"
    motion = run.plot.motion("0.006/isola 1")
    # Frequencies alone are kept.
    monkeypatch.setattr(type(run), "study", property(lambda _: 'units = "Hz"'))
    both = run.plot.response()
    assert (both.get_ylabel(), both.get_xlabel()) == (axes.get_ylabel(), "frequency (Hz)")
    assert run.plot.motion("0.006/isola 1").get_ylabel() == motion.get_ylabel()
    for largest, unit in [(0.0, "m"), (1.0, "m"), (0.9, "mm"), (9e-5, "um"), (9e-8, "nm")]:
        fitted = Units.kept("").fitted(largest)
        assert fitted.length == unit
        assert fitted.lengths(1e-9) == pytest.approx(1e-9 / {"m": 1, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}[unit])
    assert Units.kept("m").fitted(1e-6).length == "m"


def test_response(damper: Path) -> None:
    run = isola_hbm.load(damper)
    axes = run.plot.response(units="mm,Hz")
    # Every segment of a branch is drawn once: dashed where it is unstable, pale beside a point of which nothing is known. A closed
    # branch ends where it began.
    looks = segments(axes)
    stable = run.columns("stable")
    for name, kinds in {"0.006/isola 1": {"solid", "dashed"}, "0.006/main": {"solid", "pale"}}.items():
        branch = run[name]
        at = (branch["omega"] / (2 * np.pi)).to_numpy()
        height = 1e3 * branch["amplitude"][:, 0].to_numpy()
        known = stable.query("name == @name")["stable"].to_numpy()
        if branch.attrs["closed"]:
            at, height, known = (np.append(values, values[0]) for values in (at, height, known))
        told = {"stable": "solid", "unstable": "dashed"}
        seen = set()
        for k in range(len(at) - 1):
            ends = {told.get(str(word), "pale") for word in known[k : k + 2]}
            expected = "pale" if "pale" in ends else "dashed" if ends == {"dashed"} else "solid"
            assert looks[segment(at, height, k)] == [expected], (name, k)
            seen.add(expected)
        assert seen >= kinds, name
    isola = run["0.006/isola 1"]
    levels = ["A = 0.004", "A = 0.005", "A = 0.006", "A = 0.007"]
    assert labels(axes) == [*levels, "main branch", "isola", UNSTABLE, UNKNOWN, "peak", "fold", "backbone"]
    widths = {line.get_label(): line.get_linewidth() for line in axes.get_lines()}
    assert widths["A = 0.006"] == widths["main branch"] < widths["isola"]
    assert list(axes.texts) == []
    assert axes.get_xlabel() == "frequency (Hz)"
    assert axes.get_ylabel() == "amplitude of x1 (mm)"
    # Curves between the bounds of the figure do not end at its frame.
    assert axes.get_ylim()[0] == 0.0
    low, high = axes.get_xlim()
    assert low < float(isola["omega"].min()) / (2 * np.pi) < float(isola["omega"].max()) / (2 * np.pi) < high


def segment(at: np.ndarray, height: np.ndarray, k: int) -> tuple[str, ...]:
    """A segment of a line, by its ends."""
    return tuple(f"{value:.9g}" for value in (at[k], height[k], at[k + 1], height[k + 1]))


def segments(axes: plt.Axes) -> dict[tuple[str, ...], list[str]]:
    """Segments of lines, with how they look: solid, dashed or pale."""
    looks: dict[tuple[str, ...], list[str]] = {}
    full = {along_ramp(4)[k] for k in range(4)}
    for line in axes.get_lines():
        is_pale = line.get_color() in {faded(color) for color in full}
        look = "pale" if is_pale else "solid" if line.get_linestyle() == "-" else "dashed"
        at, height = line.get_data()
        for k in range(len(at) - 1):
            if np.isfinite([*at[k : k + 2], *height[k : k + 2]]).all():
                looks.setdefault(segment(at, height, k), []).append(look)
    return looks


def test_levels_are_chosen_and_axes_given(damper: Path) -> None:
    run = isola_hbm.load(damper)
    _, mine = plt.subplots()
    assert labels(run.plot.response(0.006)) == labels(run.plot.response(["0.006"]))
    axes = run.plot.response(["0.006", 0.007], ax=mine, backbone=False)
    assert axes is mine
    assert labels(axes) == ["A = 0.006", "A = 0.007", "main branch", "isola", UNSTABLE, UNKNOWN, "peak", "fold"]
    # Of main branches alone none need be told from others.
    assert labels(run.plot.response(0.004, backbone=False)) == ["A = 0.004", UNKNOWN, "peak"]
    with pytest.raises(ValueError, match=r"no branch at A = 0.3; there are branches at A = 0.004, 0.005"):
        run.plot.response([0.3])
    with pytest.raises(ValueError, match="one of m, mm, um and one of rad/s, Hz"):
        run.plot.response(units="mm,inch")
    for levels, what in (("x", "'x'"), (["0.006", "x"], "['0.006', 'x']"), ([None], "None"), ("0.1:0.2", "")):
        message = rf"levels = {re.escape(what)}.*: give numbers, .*; there are branches at A = 0.004, "
        with pytest.raises(ValueError, match=message) as caught:
            run.plot.response(levels)  # type: ignore[arg-type]
        assert caught.value.__suppress_context__
    # As after `isola plot --levels`, and under the name of before.
    assert labels(run.plot.response("0.006:0.007:0.001", backbone=False)) == labels(axes)
    assert labels(run.plot.response("0.006, 0.007", backbone=False)) == labels(axes)
    assert labels(run.plot.response(amplitudes=[0.006, 0.007], backbone=False)) == labels(axes)
    isolas = [lines for lines in run.plot.map(0.006).collections if lines.get_label() == "isolas"]
    assert {y for path in isolas[0].get_paths() for y in path.vertices[:, 1]} == {0.006}


def test_ranges_are_chosen(damper: Path) -> None:
    run = isola_hbm.load(damper)
    axes = run.plot.response(units="mm", frequency=(0.9, 1.1), response=(100, 300))
    assert (axes.get_xlim(), axes.get_ylim()) == ((0.9, 1.1), (100, 300))
    axes = run.plot.map(forcing=(0.001, 0.01), frequency=(0.9, 1.1))
    assert (axes.get_xlim(), axes.get_ylim()) == ((0.9, 1.1), (0.001, 0.01))
    drawn = run.plot.figure("response", levels=[0.006, 0.007], frequency=(0.9, 1.1), response=(0.1, 0.3))
    assert drawn.svg == run.plot.figure("response", levels="0.006,0.007", frequency=(0.9, 1.1), response=(0.1, 0.3)).svg


@pytest.mark.parametrize(
    ("figure", "wrong", "kind", "message"),
    [
        ("response", {"level": 1}, TypeError, "response: no argument `level`; did you mean `levels`? there are levels, monitor, "),
        ("response", {"levels": 1, "amplitudes": 1}, TypeError, "levels and amplitudes are the same"),
        ("response", {"response": (2, 1)}, ValueError, "response = (2, 1): the lowest and the highest one shown"),
        ("response", {"frequency": "23"}, ValueError, "frequency = '23': the lowest and the highest one shown"),
        ("response", {"ax": 5}, TypeError, "ax = 5: axes of matplotlib are needed"),
        ("response", {"ax": plt.Figure()}, TypeError, ": axes of matplotlib are needed"),
        ("response", {"units": 5}, TypeError, "units = 5: a text is needed"),
        ("response", {"backbone": "no"}, TypeError, "backbone = 'no': True or False is needed"),
        ("response", {"monitor": 3}, ValueError, "monitor = 3: the run monitors no such dof, but x1"),
        ("map", {"forcing": (0, 1)}, ValueError, "forcing = (0, 1): the lowest and the highest one shown, both above zero"),
        ("map", {"monitor": "x1"}, TypeError, "map: no argument `monitor`; there are levels, ax, units, frequency, forcing"),
        ("map", {"levels": 0.3}, ValueError, "levels: no branch at A = 0.3; there are branches at A = 0.004"),
        ("balance", {"modes": 1}, TypeError, "balance: no argument `modes`; did you mean `mode`?"),
        ("balance", {"ax": [1]}, TypeError, "ax = [1]: axes of matplotlib are needed"),
        ("motion", {"dofs": 5}, TypeError, "dofs = 5: the name of a dof or a list of them is needed"),
        ("motion", {"dofs": [5]}, TypeError, "dofs = [5]: the name of a dof or a list of them is needed"),
        ("motion", {"point": 1.5}, TypeError, "point = 1.5: an index from 0, 'peak' or 'start' is needed"),
        ("motion", {"units": None, "at": 1}, TypeError, "motion: no argument `at`"),
    ],
)
def test_wrong_arguments_are_named(
    damper: Path, figure: str, wrong: dict[str, object], kind: type[Exception], message: str
) -> None:
    run = isola_hbm.load(damper)
    with pytest.raises(kind, match=re.escape(message)):
        getattr(run.plot, figure)(**wrong)
    # What is refused leaves no empty figure behind.
    assert plt.get_fignums() == []


def test_levels_beside_others_are_named() -> None:
    assert instead([3.0], [1.0, 2.0]) == "1, 2"
    many = [10.0 * k for k in range(1, 21)]
    assert instead([25.0], many) == "20, 30 nearby (20 levels from 10 to 200)"
    assert instead([1.0, 25.0, 35.0, 999.0], many) == "10, 20, 30, 40, 200 nearby (20 levels from 10 to 200)"
    with pytest.raises(ValueError, match=r"^levels: no branch at A = 25; there are branches at A = 20, 30 nearby "):
        levels_of("20,25", many)
    assert levels_of("20:40:10, 50", many) == {20.0, 30.0, 40.0, 50.0}


def test_response_of_another_dof(tmp_path: Path) -> None:
    study = MODELS / "two_masses_stop" / "study.toml"
    options = ("--amplitudes", "0.005,0.01", "--search", "none", "--verify", "none", "--workers", 1)
    isola("sweep", study, "--out", tmp_path / "run", *options, "--set", 'monitors=["x2","x1"]')
    run = isola_hbm.load(tmp_path / "run")
    axes = run.plot.response(monitor="x1", units="um")
    assert axes.get_ylabel() == "amplitude of x1 (µm)"
    drawn = {line.get_label(): line.get_ydata() for line in axes.get_lines()}
    # Without verification nothing is dashed or pale, and the legend says what that means.
    assert "stability not known: nothing was verified" in labels(axes) and UNKNOWN not in labels(axes)
    curves = [line.get_ydata() for line in axes.get_lines() if line.get_linestyle() == "-" and len(line.get_ydata())]
    for name, curve in zip(run, curves[: len(run)], strict=True):
        np.testing.assert_allclose(curve, 1e6 * run[name]["amplitude"].sel(monitor="x1"))
    backbone = 1e6 * run.backbone(2)["amplitude"].sel(monitor="x1").to_numpy()
    shown = drawn["backbone of mode 2"][np.isfinite(drawn["backbone of mode 2"])]
    below = backbone[: len(shown) - 1]
    # It ends where it leaves the figure, between two points; the limits are those of branches.
    assert len(below) and below[-1] < shown[-1] < backbone[len(below)]
    np.testing.assert_allclose(shown[:-1], below)
    top = max(height.max() for height in curves[: len(run)])
    assert top < axes.get_ylim()[1] < 1.1 * top
    assert shown[-1] == pytest.approx(axes.get_ylim()[1])
    first, same = (run.plot.response(monitor=monitor) for monitor in (None, "x2"))
    assert first.get_ylabel() == same.get_ylabel() == "amplitude of x2 (mm)"
    np.testing.assert_array_equal(first.get_lines()[1].get_ydata(), same.get_lines()[1].get_ydata())
    with pytest.raises(ValueError, match="monitor = 'x3': the run monitors no such dof, but x2, x1$"):
        run.plot.response(monitor="x3")
    # What is damaged is left out, as in figures of the first dof.
    damage = "UPDATE arrays SET data = substr(data, 9) WHERE owner IN ('backbone', '0.01-0') AND name = 'amplitude'"
    change(tmp_path / "run", damage)
    with pytest.warns(isola_hbm.LeftOut, match="is left out: ") as warned:
        axes = isola_hbm.load(tmp_path / "run").plot.response(monitor="x1")
    assert any("0.01/main" in str(warning.message) for warning in warned)
    assert "A = 0.005" in labels(axes) and "A = 0.01" not in labels(axes)


def test_many_levels_are_named_at_their_peaks(damper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = MODELS / "duffing" / "study.toml"
    options = ("--amplitudes", "0.01:0.08:0.01", "--search", "none", "--workers", 1, "--set", "harmonics.count=3")
    isola("sweep", study, "--out", tmp_path / "run", *options)
    run = isola_hbm.load(tmp_path / "run")
    axes = run.plot.response()
    assert "A = 0.01" not in labels(axes)
    names = [text for text in axes.texts if text.get_text()]
    assert {text.get_text() for text in names} == {f"A = 0.0{i}" for i in range(1, 9)}
    boxes = [text.get_window_extent() for text in names]
    assert not any(box.count_overlaps([*boxes[:i], axes.get_legend().get_window_extent()]) for i, box in enumerate(boxes))
    for text in names:
        branch = run[f"{text.get_text().removeprefix('A = ')}/main"]
        assert text.xy == (branch["omega"][branch.attrs["peak"]], branch["amplitude"][branch.attrs["peak"], 0])
    # Isolas are named as well, in figures with parts of their own, too.
    monkeypatch.setattr("isola_hbm.responses._NAMED", 2)
    part = plt.figure(figsize=(12, 5)).subfigures(1, 2)[0].subplots()
    axes = isola_hbm.load(damper).plot.response(ax=part)
    assert {"A = 0.007", "isola 1, A = 0.006"} <= {text.get_text() for text in axes.texts}


@pytest.mark.parametrize(("count", "order"), [(0, []), (1, [0]), (2, [1, 0]), (5, [4, 0, 2, 1, 3])])
def test_levels_are_named_from_the_ends_inwards(count: int, order: list[int]) -> None:
    assert spread(count) == order
    assert sorted(spread(12)) == list(range(12))


def test_map(damper: Path) -> None:
    axes = isola_hbm.load(damper).plot.map()
    expected = {
        "main branches",
        "isolas",
        "threshold A* of the backbone",
        "folds, computed",
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
    # No bar of an isola ends at the edge.
    ends = np.concatenate([segment[:, 0] for segment in isolas.get_segments()])
    left, right = axes.get_xlim()
    assert left < ends.min() - 0.04 * (right - left) and ends.max() + 0.04 * (right - left) < right


def in_words(axes: plt.Axes) -> list[mpl.text.Text]:
    """What stands at points."""
    return [text for text in axes.texts if text.get_text()]


def test_events_are_worded_as_elsewhere() -> None:
    lines = (ROOT / "results" / "COLUMNS.md").read_text(encoding="utf-8").splitlines()
    (words,) = [line for line in lines if line.startswith("| birth, death, merge |")]
    assert all(event.word in words for event in _EVENTS.values())
    assert {kind for _, kind in _EVENTS} == {"birth", "death", "merge"}


def test_curves_of_a_map_run_to_its_frame(copy: Path) -> None:
    change(copy, "UPDATE curve_points SET forcing = 1e3 * forcing WHERE event IS NULL")
    run = isola_hbm.load(copy)
    axes = run.plot.map()
    drawn = {line.get_label(): line.get_ydata() for line in axes.get_lines()}
    bottom, top = axes.get_ylim()
    # They are cut there, and do not set the scale.
    assert top < 0.1 and np.nanmax(drawn["folds, computed"]) > 1e2 * top
    threshold = run.backbone()["threshold"].to_numpy()
    np.testing.assert_array_equal(drawn["threshold A* of the backbone"], np.where(np.isfinite(threshold), threshold, np.nan))
    assert np.nanmin(drawn["threshold A* of the backbone"]) < bottom < top < np.nanmax(drawn["threshold A* of the backbone"])


def test_merges_are_told_as_by_the_program(copy: Path) -> None:
    change(copy, "UPDATE curve_points SET event = 'merge', forcing_2h = forcing WHERE event = 'birth'")
    run = isola_hbm.load(copy)
    computed = run.events.query("source == 'computed' and kind == 'merge'")
    assert (computed["outcome"] == "").all()
    (forcing, *_), said = computed["forcing"], lambda: {text.get_text() for text in in_words(run.plot.map())}
    assert f"merge or part at {digits(forcing, 4)}" in said()
    # What is known beyond the store is in the file.
    computed.assign(outcome="part").to_csv(copy / "events.csv", index=False)
    assert f"part at {digits(forcing, 4)}" in said()
    change(copy, "UPDATE curve_points SET forcing_2h = NULL")
    assert f"part at {digits(forcing, 4)} (2H: not found)" in said()
    assert {"merges or partings, computed", "2H: with twice the harmonics"} <= set(labels(run.plot.map()))


def test_a_map_has_the_unit_and_the_cusps_of_the_program(copy: Path) -> None:
    change(copy, "UPDATE curve_points SET event = 'cusp' WHERE event = 'birth'")
    axes = isola_hbm.load(copy).plot.map()
    assert axes.get_ylabel() == "forcing amplitude A, threshold A* (N at x1)"
    (cusps,) = [line for line in axes.get_lines() if line.get_label() == "cusps, computed (two folds meet)"]
    assert cusps.get_marker() == "s" and len(cusps.get_xdata()) > 0


def test_what_lies_beyond_the_frame_is_not_in_the_legend(damper: Path) -> None:
    run = isola_hbm.load(damper)
    omega = run.events.query("kind == 'birth'")["omega"]
    axes = run.plot.map(frequency=(1.2 * omega.max(), 2.0 * omega.max()))
    assert not any(label.startswith("births") for label in labels(axes))
    assert any(label.startswith("births") for label in labels(run.plot.map()))


@pytest.mark.parametrize("is_crossed", [False, True])
def test_names_stand_over_curves_where_there_is_no_room(is_crossed: bool) -> None:
    axes = plt.subplots(layout="constrained")[1]
    # So many lines across that every place of a name is on one.
    curves = [axes.plot([i / 40, i / 40], [0.0, 1.0])[0] for i in range(41)]
    names = [Named("dies at 356.5 (2H: 356.4)", 0.5, 0.5, "black")]
    write_names(axes, *([[], names, 5.0, [curves, []]] if is_crossed else [curves, names, 5.0]))
    assert len(in_words(axes)) == is_crossed


def test_numbers_are_written_as_by_the_program() -> None:
    written = [digits(value, 3) for value in (0.12466, 14.8261, 3.3, 1200.0, 1.5e-5, 0.0)]
    assert written == ["0.125", "14.8", "3.3", "1200", "1.50e-5", "0"]


def test_figures_are_about_the_mode_that_led_to_an_isola(damper: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = isola_hbm.load(damper)
    isola = run.summary.query("kind == 'isola'").iloc[0]
    window = run.windows[run.windows["branch"].str.contains("isola")].iloc[[0]]
    found = window.assign(mode=2, branch="isola 1; main", amplitude=isola["amplitude"], outcome="found")
    there = found.assign(omega_min=isola["omega_min"], omega_max=isola["omega_max"])
    # Seeds may come upon an isola that lies elsewhere.
    elsewhere = found.assign(omega_min=2 * isola["omega_max"], omega_max=3 * isola["omega_max"])
    for windows, mode in ((there, 2), (elsewhere, None)):
        monkeypatch.setattr(type(run), "windows", property(lambda _, windows=windows: windows))
        assert mode_of_isola(run) == mode


def test_lines_of_narrow_isolas_are_thin(copy: Path) -> None:
    def width(axes: plt.Axes) -> float:
        return max(line.get_linewidth() for line in axes.get_lines() if line.get_label().startswith("_") and len(line.get_xdata()) > 2)

    axes = isola_hbm.load(copy).plot.response(0.006, backbone=False)
    assert width(axes) == 2.2 and "isola" in labels(axes)
    of_isola = "branch = (SELECT id FROM branches WHERE kind = 'isola' AND amplitude = '0.006')"
    change(copy, f"UPDATE points SET amplitude = 1 + 0.01 * amplitude WHERE {of_isola}")
    axes = isola_hbm.load(copy).plot.response(0.006, backbone=False)
    assert width(axes) < 1.5 and "isola, thinner where narrow" in labels(axes)


def test_names_are_nearest_to_their_own_curves() -> None:
    axes = plt.subplots()[1]
    axes.plot([0.0, 1.0], [0.5, 0.5])
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))

    def written() -> tuple[float, float]:
        write_names(axes, axes.get_lines(), [Named("own", 0.5, 0.5, "k")])
        (text,) = in_words(axes)
        box = text.get_window_extent()
        text.remove()
        (_, low), (_, high) = axes.transData.inverted().transform([(box.x0, box.y0 - 2.0), (box.x1, box.y1 + 2.0)])
        return low, high

    low, high = written()
    assert 0.5 < low
    # There is room below another one, which is nearer.
    axes.plot([0.0, 1.0], [high, high])
    assert written()[1] < 0.5


@pytest.mark.parametrize("size", [(4, 3), (8, 5)])
def test_texts_of_a_map_have_room(damper: Path, copy: Path, size: tuple[float, float]) -> None:
    # Events of both sources at one point, and longer texts along the axis.
    change(copy, "UPDATE curve_points SET event = 'merge' WHERE event = 'birth'")
    for run in map(isola_hbm.load, (damper, copy)):
        axes = run.plot.map(ax=plt.subplots(figsize=size, layout="constrained")[1], units="Hz")
        axes.figure.draw_without_rendering()
        figure, names = axes.figure.bbox, in_words(axes)
        assert len(names) > 1 and all(" at 0.0" in text.get_text() for text in names)
        boxes = [part.get_window_extent() for part in (*names, axes.get_legend(), axes.xaxis.label)]
        assert not any(box.count_overlaps(boxes[:i]) for i, box in enumerate(boxes))
        assert all(figure.x0 <= box.x0 and box.x1 <= figure.x1 and box.y1 <= figure.y1 for box in boxes)


@pytest.mark.parametrize("draw", ["response", "balance", "motion"])
def test_texts_have_room_in_small_figures(damper: Path, draw: str) -> None:
    axes = plt.subplots(figsize=(4, 3), layout="constrained")[1]
    getattr(isola_hbm.load(damper).plot, draw)(ax=axes)
    axes.figure.draw_without_rendering()
    figure = axes.figure.bbox
    for part in (axes.get_legend(), axes.title, axes.xaxis.label):
        box = part.get_window_extent()
        assert figure.x0 <= box.x0 and box.x1 <= figure.x1 and box.y1 <= figure.y1, part
    assert axes.bbox.width > 0.6 * figure.width and axes.bbox.height > 0.4 * figure.height


def test_curves_that_lie_on_each_other_are_drawn_once(copy: Path) -> None:
    before = isola_hbm.load(copy).plot.response()
    change(
        copy,
        "CREATE TABLE image AS SELECT * FROM branches WHERE amplitude = '0.006' AND kind = 'isola';"
        "UPDATE image SET number = 2, id = id + 1000, task = 'image'; INSERT INTO branches SELECT * FROM image; DROP TABLE image;"
        "CREATE TABLE image AS SELECT * FROM points WHERE branch = (SELECT id - 1000 FROM branches WHERE number = 2);"
        "UPDATE image SET branch = branch + 1000, stable = NULL; INSERT INTO points SELECT * FROM image; DROP TABLE image",
    )
    run = isola_hbm.load(copy)
    assert "0.006/isola 2" in run
    axes = run.plot.response()
    # The image, whose stability is not known, would be pale, and fill the dashes.
    assert segments(axes) == segments(before)
    assert [text.get_text() for text in in_words(axes)] == ["isola 1 and 2, A = 0.006"] and not in_words(before)
    # What differs by more than the width of a line is drawn.
    change(copy, "UPDATE points SET amplitude = 1.1 * amplitude WHERE branch > 1000")
    assert segments(isola_hbm.load(copy).plot.response()) != segments(before)


def test_the_map_is_about_isolas(copy: Path) -> None:
    run = isola_hbm.load(copy)
    before, rows = run.plot.map().get_xlim(), run.summary.query("kind == 'isola'")
    low, high = rows["omega_min"].min(), rows["omega_max"].max()
    change(copy, "UPDATE curve_points SET omega = 9 * omega WHERE event IS NULL")
    left, right = isola_hbm.load(copy).plot.map().get_xlim()
    assert left <= before[0] < low < high < before[1] <= right
    assert right - left < 3.5 * (high - low)


def test_peaks_and_folds_are_marked(damper: Path) -> None:
    run = isola_hbm.load(damper)
    axes = run.plot.response()
    marks = [line for line in axes.get_lines() if line.get_marker() in "^o" and len(line.get_xdata())]
    marked = {mark: {line.get_xydata()[0].tobytes() for line in marks if line.get_marker() == mark} for mark in "^o"}
    places: dict[str, set[bytes]] = {"^": set(), "o": set()}
    for branch in run.values():
        for mark, indices in (("^", [branch.attrs["peak"]]), ("o", branch.attrs["folds"])):
            places[mark] |= {np.array([branch["omega"][i], branch["amplitude"][i, 0]]).tobytes() for i in indices}
    assert marked["^"] == places["^"] and len(marked["^"]) == len(run)
    assert marked["o"] == places["o"] and len(marked["o"]) == 6
    # Beyond what is shown nothing is told of; a peak covers a fold.
    assert not {"peak", "fold"} & set(labels(run.plot.response(frequency=(0.5, 0.6))))
    axes = plt.subplots()[1]
    assert _mark(axes, {"peak": [(0.5, 0.5, "k")], "fold": [(0.5, 0.501, "k"), (2.0, 0.5, "k")]}) == {"peak"}
    assert _mark(axes, {"peak": [(0.5, 0.5, "k")], "fold": [(0.5, 0.6, "k")]}) == {"peak", "fold"}


def test_a_backbone_leaves_the_figure_above_the_peak(damper: Path) -> None:
    run = isola_hbm.load(damper)
    for frequency in (None, (0.98, 1.02)):
        axes = run.plot.response(frequency=frequency)
        (backbone,) = [line for line in axes.get_lines() if line.get_label() == "backbone"]
        top = np.nanmax(backbone.get_ydata())
        assert top == pytest.approx(axes.get_ylim()[1]) and top > run.points["amplitude"].max()


def test_a_second_run_fits_on_the_same_axes(damper: Path) -> None:
    run = isola_hbm.load(damper)
    axes = run.plot.response(0.004)
    before = axes.get_ylim()[1]
    assert run.plot.response(0.007, ax=axes).get_ylim()[1] > before


def test_frequencies_are_chosen(damper: Path) -> None:
    run = isola_hbm.load(damper)
    assert run.plot.map(frequency=(0.9, 1.1)).get_xlim() == (0.9, 1.1)
    assert run.plot.map(units="Hz", frequency=(0.15, 0.16)).get_xlim() == (0.15, 0.16)
    whole, beside = run.plot.response(), run.plot.response(frequency=(1.05, 1.1))
    assert beside.get_xlim() == (1.05, 1.1)
    points = run.points[run.points["omega"].between(1.05, 1.1)]
    assert len(points) and beside.get_ylim()[1] < whole.get_ylim()[1]
    assert beside.get_ylim() == (0.0, pytest.approx(1.08 * points["amplitude"].max()))
    for wrong in [(2.0, 1.0), (1.0,), "all", (0.0, float("inf"))]:
        with pytest.raises(ValueError, match="the lowest and the highest one shown"):
            run.plot.map(frequency=wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("layout", ["constrained", None])
def test_legends_cover_no_curve(damper: Path, layout: str | None) -> None:
    run = isola_hbm.load(damper)
    draws = [
        lambda ax: run.plot.response(ax=ax),
        lambda ax: run.plot.response(frequency=(0.99, 1.01), ax=ax),
        lambda ax: run.plot.map(ax=ax),
        lambda ax: run.plot.balance(ax=ax),
        lambda ax: run.plot.motion("0.006/isola 1", ax=ax),
    ]
    for i, draw in enumerate(draws):
        axes = draw(plt.subplots(figsize=(5, 3.5), layout=layout)[1])
        axes.figure.draw_without_rendering()
        box = axes.get_legend().get_window_extent()
        # What goes on beyond what is shown is cut below a legend.
        above = [line for line in axes.get_lines() if line.get_clip_box().y1 > box.y0]
        lines = [line for line in above if line.get_linestyle() != "None"]
        covered = [
            line for line in lines if line.get_path().transformed(line.get_transform()).intersects_bbox(box, filled=False)
        ]
        # What leaves the axes is cut there.
        inside = box.y0 < axes.bbox.y1 and box.x0 < axes.bbox.x1
        assert not (inside and covered), (i, layout, covered)


def test_kinds_of_branches_differ_on_the_map(copy: Path) -> None:
    kinds = {"0.005": "branched", "0.006": "cut", "0.007": "unfinished"}
    for level, kind in kinds.items():
        change(copy, f"UPDATE branches SET kind = '{kind}' WHERE kind = 'isola' AND amplitude = '{level}'")
    axes = isola_hbm.load(copy).plot.map()
    drawn = {bars.get_label(): bars for bars in axes.collections}
    assert list(drawn) == ["main branches", "cut off by a bound", "unfinished", "branches off another"]
    looks = {label: (bars.get_linewidth()[0], bars.get_linestyle()[0][1]) for label, bars in drawn.items()}
    assert looks["branches off another"][1] is None and looks["cut off by a bound"][1] is not None
    assert looks["unfinished"][1] not in (None, looks["cut off by a bound"][1])


def test_balance(damper: Path) -> None:
    run = isola_hbm.load(damper)
    axes = run.plot.balance()
    needed, supplied = axes.get_lines()
    assert axes.get_title() == "A = 0.005, mode 1"
    # A response is predicted where more is supplied than needed: where A* is below A.
    backbone = run.backbone()
    predicted = supplied.get_ydata() > needed.get_ydata()
    np.testing.assert_array_equal(predicted, (backbone["threshold"] < 0.005)[: len(predicted)])
    # It ends where no level comes near the threshold any more.
    rest = backbone["threshold"][len(predicted) :]
    assert len(rest) and (rest > 2 * 0.007).all() and backbone["threshold"][len(predicted) - 1] <= 2 * 0.007
    assert 0 < predicted.sum() < len(predicted)
    assert "supply is larger: windows" in labels(axes)
    # It is that of every forcing amplitude, whether the run has it or not; a low one has no windows.
    assert "supply is larger: windows" not in labels(run.plot.balance(1e-12))
    assert run.plot.balance(0.3).get_title() == "A = 0.3 (no level of the run), mode 1"
    plt.close("all")
    for mode, shown in ((5, "5"), ("1", "'1'")):
        with pytest.raises(isola_hbm.NoSuchBranch, match=f"no backbone of mode {shown}; modes followed: 1$"):
            run.plot.balance(0.005, mode=mode)  # type: ignore[arg-type]
    for amplitude in (0, -1.0, np.nan, "0.005", True):
        with pytest.raises(ValueError, match=r"^amplitude = .*: a number above zero is needed$"):
            run.plot.balance(amplitude)  # type: ignore[arg-type]
    # What is refused leaves no empty figure behind.
    with pytest.raises(isola_hbm.NoSuchBranch):
        run.plot.motion("0.005/isola 9")
    assert plt.get_fignums() == []


def test_motion(blade: Path) -> None:
    run = isola_hbm.load(blade)
    # Of several modes followed each has its balance.
    modes = run.backbones["mode"].unique().tolist()
    assert len(modes) == 2
    assert [run.plot.balance(20, mode=mode).get_title() for mode in modes] == [f"A = 20, mode {mode}" for mode in modes]
    # The highest of what is not open, where there is no isola.
    assert run.plot.motion().get_title() == run.plot.motion("40/main").get_title()
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
    assert axes.get_ylabel() == "argument of the law (N)"
    # A law of several arguments has them all under its name.
    assert labels(run.plot.motion("20/main", variable="argument", dofs="b0")) == ["b0 1", "b0 2", "b0 3"]
    assert run.plot.motion("20/main", variable="argument", dofs=["b0 1", "b0 2"]).get_ylabel() == "argument of the law (N, m)"
    with pytest.raises(ValueError, match="variable = 'modal': displacement or argument is drawn"):
        run.plot.motion("20/main", variable="modal")
    with pytest.raises(IndexError, match=f"point 999 of {run['20/main'].sizes['point']}: give"):
        run.plot.motion("20/main", point=999)
    assert labels(run.plot.motion("20/main", dofs="b0.r")) == ["b0.r"]
    with pytest.raises(KeyError, match="no `b9.r` among what is stored of a motion; there are b0.r, "):
        run.plot.motion("20/main", dofs=["b9.r"])


def test_a_run_without_branches_has_empty_figures(copy: Path) -> None:
    change(copy, "DELETE FROM points; DELETE FROM branches; DELETE FROM curve_points; DELETE FROM curves")
    run = isola_hbm.load(copy)
    assert labels(run.plot.response(backbone=False)) == []
    assert "threshold A* of the backbone" in labels(run.plot.map())


@pytest.mark.needs_program
def test_figures_of_the_program(damper: Path, tmp_path: Path) -> None:
    plot = isola_hbm.load(damper).plot
    for name in ("backbone", "balance", "resonance"):
        drawn = plot.figure(name)
        assert drawn.svg.startswith("<svg") and drawn._repr_svg_() == drawn.svg, name
    whole, part = plot.figure("response"), plot.figure("response", frequency=(0.99, 1.01))
    assert part.save(tmp_path / "response.svg").read_text(encoding="utf-8") == part.svg != whole.svg
    # What the program refuses is passed on in its words.
    with pytest.raises(isola_hbm.ProgramFailed, match="one mode alone"):
        plot.figure("modes")
    with pytest.raises(isola_hbm.ProgramFailed, match="folds"):
        plot.figure("bode")
