"""What figures of Python and of the program call the same things."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import pytest
from runs import change, isola

import isola_hbm


@pytest.fixture(autouse=True)
def _closed() -> Any:
    yield
    plt.close("all")


def figures(run: Path, tmp_path: Path) -> dict[str, Any]:
    """The figures of the page of a run."""
    page = tmp_path / "page.html"
    isola("report", run, "-o", page)
    data = page.read_text(encoding="utf-8").split('<script type="application/json" id="data">')[1]
    return dict(json.loads(data.split("</script>")[0])["figures"])


def test_legends_and_axes_have_the_same_words(damper: Path, tmp_path: Path) -> None:
    drawn, run = figures(damper, tmp_path), isola_hbm.load(damper)
    for name, own in {"response": {"A = "}, "map": set(), "balance": set()}.items():
        axes = getattr(run.plot, name)()
        entries = [entry["text"] for entry in drawn[name]["legend"]]
        # In files there is no amplitude that is chosen; the program has more kinds of marks.
        labels = [label for label in axes.get_legend_handles_labels()[1] if not label.startswith(tuple(own) or ("\0",))]
        assert labels
        for label in labels:
            assert any(entry == label or entry.startswith(label + ",") for entry in entries), (label, entries)
        panel = drawn[name]["panels"][0]
        titles = [f"{axis['title']} ({axis['unit']['name']})".replace(" ()", "") for axis in (panel["x"][0], panel["y"][0])]
        shown = [axes.get_xlabel(), axes.get_ylabel()]
        assert [text.rsplit(" (", 1)[0] for text in shown] == [text.rsplit(" (", 1)[0] for text in titles]


def test_kinds_of_branches_are_called_the_same(damper: Path, tmp_path: Path) -> None:
    words = {"open": "open branch", "cut": "cut off by a bound", "branched": "branches off another", "unfinished": "unfinished"}
    for kind, word in words.items():
        copy = tmp_path / kind
        copy.mkdir()
        (copy / "run.sqlite").write_bytes((damper / "run.sqlite").read_bytes())
        change(copy, f"UPDATE branches SET kind = '{kind}' WHERE kind = 'isola'")
        axes = isola_hbm.load(copy).plot.response()
        labels = axes.get_legend_handles_labels()[1]
        assert word in labels and not any(label.startswith("isola") for label in labels), labels


def test_bars_of_maps_are_as_thin_as_levels_lie_close(damper: Path) -> None:
    run = isola_hbm.load(damper)

    def width(**options: Any) -> float:
        bars = next(lines for lines in run.plot.map(**options).collections if lines.get_label() == "isolas")
        return float(max(bars.get_linewidth()))

    assert width() == 3.0
    # The same levels, closer together.
    assert 0.6 <= width(forcing=(1e-9, 1e6)) < 2.0


def test_what_no_file_tells_of_merges_is_said(damper: Path, tmp_path: Path) -> None:
    (tmp_path / "run.sqlite").write_bytes((damper / "run.sqlite").read_bytes())
    events = isola_hbm.load(damper).events
    merges = events[(events["source"] == "computed") & (events["kind"] == "merge")]
    if not len(merges):
        change(tmp_path, "UPDATE curve_points SET event = 'merge' WHERE event = 'birth'")
    run = isola_hbm.load(tmp_path)
    with pytest.warns(isola_hbm.errors.LeftOut, match=r"\(outcome\) is not known: events.csv is not there; `isola export "):
        assert (run.events["outcome"] == "").all()
    (tmp_path / "events.csv").write_text("kind,source,forcing,omega\n", encoding="utf-8")
    with pytest.warns(isola_hbm.errors.LeftOut, match="events.csv is of an earlier program"):
        run.plot.map()
