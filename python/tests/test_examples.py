"""The examples in docstrings: that they run as they stand, and give what they say."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import shutil
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import pytest
from runs import MODELS, program

import isola_hbm

#: What examples are of that needs a run that goes on.
LIVE = "isola_hbm.connect("


def described() -> dict[str, list[doctest.Example]]:
    """Docstrings with examples, by the names of what they describe."""
    modules = [isola_hbm] + [
        importlib.import_module(found.name)
        for found in pkgutil.walk_packages(isola_hbm.__path__, "isola_hbm.")
        if not found.name.endswith("__main__")
    ]
    finder = doctest.DocTestFinder(exclude_empty=True)
    found = {test.name: test.examples for module in modules for test in finder.find(module) if test.examples}
    return {name: examples for name, examples in found.items() if examples}


def test_there_are_examples() -> None:
    there = described()
    assert {"isola_hbm", "isola_hbm.sweeps.sweep", "isola_hbm.laws.Law", "isola_hbm.stored.run.load"} <= set(there)
    assert any(LIVE in example.source for example in there["isola_hbm"])


@pytest.mark.needs_program
@pytest.mark.filterwarnings("error::UserWarning")
@pytest.mark.parametrize("name", described())
def test_an_example(
    name: str, damper: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ISOLA_BIN", str(program().absolute()))
    monkeypatch.chdir(tmp_path)
    # Some go on with it: a copy.
    shutil.copytree(damper, tmp_path / "runs" / "damper")
    shutil.copytree(MODELS / "duffing", tmp_path / "models" / "duffing")
    # Those of methods begin with a run.
    scope: dict[str, object] = {"run": isola_hbm.load("runs/damper")}
    for example in described()[name]:
        if LIVE in example.source:
            continue
        exec(compile(example.source, name, "single"), scope)  # noqa: S102
        said = capsys.readouterr().out
        assert not example.want or said == example.want
    plt.close("all")
    if name == "isola_hbm":
        run = scope["run"]
        assert isinstance(run, isola_hbm.StoredRun)
        # The resonance leans: larger, and at higher frequencies, with every level.
        assert list(run) == ["0.02/main", "0.05/main", "0.07/main", "0.1/main"]
        peaks = run.summary[["amplitude_max", "omega_at_max"]]
        assert (peaks.diff().dropna() > 0).all(axis=None)
        assert run["0.1/main"].attrs["folds"]
