"""Runs that look for motions of several orders: each order is told of as a run of its own."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from runs import MODELS, isola, program

import isola_hbm


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Motions of the period of the force and of three of them."""
    folder = tmp_path_factory.mktemp("orders") / "run"
    study, brief = MODELS / "duffing_subharmonic" / "study.toml", ("--search", "none", "--verify", "none")
    bounds = ("--set", "frequency.min=0.6", "--set", "frequency.max=7.5")
    isola("sweep", study, "--out", folder, "--orders", "1,3", "--amplitudes", "1.5,2", *bounds, *brief)
    return folder


@pytest.mark.parametrize(("order", "files"), [(None, "."), (1, "."), (3, "m3")])
def test_an_order_is_told_of_as_its_files_have_it(run: Path, order: int | None, files: str) -> None:
    told = isola_hbm.load(run, order)
    assert told.orders == [1, 3]
    assert told.model.forcing_harmonic == (order or 1)
    summary = pd.read_csv(run / files / "summary.csv")
    assert len(summary) and list(told.summary["kind"]) == list(summary["kind"])
    for column in ("amplitude", "omega_min", "omega_max", "amplitude_max"):
        assert np.array_equal(told.summary[column], summary[column])
    windows = pd.read_csv(run / files / "windows.csv")
    assert np.array_equal(told.windows["omega_best"], windows["omega_best"])
    for name in told:
        file = run / files / "branches" / f"{name.replace('/', '-').replace(' ', '-')}.csv"
        file = file if file.exists() else file.with_stem(f"{file.stem}-1")
        assert np.array_equal(told[name]["omega"], pd.read_csv(file)["omega"])
    assert told.check() == []
    told.plot.response()


def test_a_further_order_has_no_backbone_of_the_first(run: Path) -> None:
    first, further = isola_hbm.load(run), isola_hbm.load(run, order=3)
    assert len(first.backbones) and not len(further.backbones)
    with pytest.raises(isola_hbm.NoSuchBranch, match="there is no backbone yet"):
        further.backbone()
    assert set(further) == {"1.5/isola 1", "2/isola 1"}
    assert set(further).isdisjoint(first)


def test_branches_of_a_further_order_are_hinted_at(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ISOLA_BIN", str(program().absolute()))
    first = isola_hbm.load(run)
    assert repr(first).endswith(f"motions of 3 periods of the force (2 isolas): isola_hbm.load('{run}', order=3)>")
    assert "load(" not in repr(isola_hbm.load(run, order=3))
    with pytest.raises(isola_hbm.NoSuchBranch, match=r'those of load\(folder, order=3\), there "2/isola 1"'):
        first["2-m3/isola 1"]
    with pytest.raises(isola_hbm.NoSuchBranch, match=r"there is one of order 3: load\(folder, order=3\)$"):
        first["2/isola 1"]
    with pytest.raises(isola_hbm.NoSuchBranch, match=r"there is one of the first order: load\(folder\)$"):
        isola_hbm.load(run, order=3)[2, "main"]
    # Of the order that is told of, and of one that there is not, there is nothing to hint at.
    for told, name, there in [
        (isola_hbm.load(run, order=3), "2-m3/isola 9", "; there are isola 1"),
        (first, "2-m5/isola 1", "; levels are 1.5, 2"),
    ]:
        with pytest.raises(isola_hbm.NoSuchBranch, match=f"{re.escape(there)}$"):
            told[name]
    for told, is_first in [(first, "true"), (isola_hbm.load(run, order=3), "false")]:
        pages = told.explore().html.split('"orders":[')[1].split("]")[0]
        # One that is shown alone has no others beside it.
        assert pages.count('"is_first"') == 1 and f'"is_first":{is_first},"file":null' in pages


def test_a_run_that_is_extended_tells_of_the_same_order(run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ISOLA_BIN", str(program().absolute()))
    shutil.copytree(run, folder := tmp_path / "run")
    longer = isola_hbm.extend(isola_hbm.load(folder, order=3), [1.75], workers=1, progress=False)
    assert set(longer) == {"1.5/isola 1", "1.75/isola 1", "2/isola 1"}
    assert "1.75/main" in isola_hbm.load(folder)


def test_an_order_that_is_not_looked_for(run: Path, damper: Path) -> None:
    with pytest.raises(isola_hbm.NoSuchRun, match="there are no motions of order 2 in it, but of 1, 3"):
        isola_hbm.load(run, order=2)
    assert isola_hbm.load(damper).orders == [1]
    with pytest.raises(isola_hbm.NoSuchRun, match="of order 3 in it, but of 1"):
        isola_hbm.load(damper, order=3)
