"""Runs that go on, were interrupted, or are damaged."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import sqlite3
import subprocess
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
from runs import MODELS, change, isola, program

import isola_hbm


def whole(run: isola_hbm.StoredRun) -> dict[str, np.ndarray]:
    """The modal amplitudes of all branches that can be read."""
    found = {}
    for name in run:
        try:
            found[name] = run[name]["modal"].values
        except isola_hbm.Damaged:
            continue
    return found


def same_as_exported(folder: Path, to: Path, code: int) -> list[str]:
    """What the program exports of the same run is what is read: names of these branches."""
    isola("export", folder, "--format", "npz", "--to", to, code=code)
    names = []
    for name, modal in whole(isola_hbm.load(folder)).items():
        level, kind = name.split("/")
        kind, _, number = kind.partition(" ")
        with np.load(to / "branches" / f"{level}-{kind}-{number or 1}.npz") as file:
            assert file["modal"].tobytes() == modal.tobytes(), name
        names.append(name)
    assert len(names) == len(list((to / "branches").iterdir()))
    return names


def test_a_run_that_goes_on_and_is_killed(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    study = MODELS / "nonlinear_damper" / "study.toml"
    command = [
        program(),
        "sweep",
        study,
        "--out",
        folder,
        "--amplitudes",
        "0.004:0.012:0.0001",
        "--workers",
        "1",
    ]
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    ) as process:
        try:
            run, deadline = None, time.monotonic() + 60
            while run is None or len(run) < 5:
                assert time.monotonic() < deadline
                assert process.poll() is None
                if run is None and (folder / "run.sqlite").exists():
                    run = isola_hbm.load(folder)
                time.sleep(0.02)
            before = whole(run)
            assert run.stage == "sweep"
            assert any("still to be done, at A = " in sentence for sentence in run.check())
        finally:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait(30)
    assert len(before) >= 5
    names = same_as_exported(folder, tmp_path / "npz", 0)
    assert set(before) <= set(names)
    assert any("still to be done" in sentence for sentence in isola_hbm.load(folder).check())

    # Without permission to write beside the file its log cannot be read.
    if os.geteuid() != 0:
        folder.chmod(0o500)
        (folder / "run.sqlite-shm").unlink(missing_ok=True)
        with pytest.raises(isola_hbm.IsolaError, match="copy its folder to where you may write"):
            isola_hbm.load(folder)
        folder.chmod(0o700)


def test_before_there_is_a_backbone(copy: Path) -> None:
    change(
        copy,
        "DELETE FROM meta WHERE key IN ('backbone', 'backbone_status'); UPDATE meta SET value = 'backbone' WHERE key = 'stage';"
        "DELETE FROM modes; DELETE FROM backbone; DELETE FROM windows; DELETE FROM curve_points; DELETE FROM curves;"
        "DELETE FROM arrays WHERE owner <> 'model'; DELETE FROM points; DELETE FROM branches;"
        "DELETE FROM results; DELETE FROM attempts; DELETE FROM tasks",
    )
    run = isola_hbm.load(copy)
    tables = [run.summary, run.windows, run.folds, run.events, run.backbones, run.points]
    assert [len(table) for table in tables] == [0] * 6
    assert {"omega", "threshold", "mode"} <= set(run.backbones)
    assert run.stage == "backbone"
    assert run.check() == ["There is no backbone yet, and so there are no windows and no branches."]
    with pytest.raises(isola_hbm.NoSuchBranch, match="there is no backbone yet"):
        run.backbone()


@pytest.mark.parametrize("share", [0.9, 0.6, 0.3])
def test_a_file_that_was_cut_short(copy: Path, tmp_path: Path, share: float) -> None:
    file = copy / "run.sqlite"
    names = list(isola_hbm.load(copy))
    os.truncate(file, int(share * file.stat().st_size) // 8192 * 8192)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", isola_hbm.LeftOut)
        run = isola_hbm.load(copy)
        sentences = run.check()
        assert set(same_as_exported(copy, tmp_path / "npz", 3)) <= set(names)
        for read in (
            lambda: run.summary,
            lambda: run.windows,
            lambda: run.folds,
            lambda: run.events,
            lambda: run.backbones,
        ):
            try:
                read()
            except isola_hbm.Damaged as damage:
                assert str(file) in str(damage)
    assert any("left out" in sentence for sentence in sentences)


def test_a_file_of_which_nothing_is_left(copy: Path) -> None:
    os.truncate(copy / "run.sqlite", 8192)
    with pytest.raises(isola_hbm.Damaged, match="the file is damaged .*; restore a copy"):
        isola_hbm.load(copy)


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("UPDATE points SET omega = omega + 1e-9 WHERE branch = {id} AND i = 3", "is not what was stored"),
        (
            "UPDATE arrays SET data = zeroblob(length(data)) WHERE owner = '{task}' AND name = 'modal'",
            "is not what was",
        ),
        (
            "UPDATE arrays SET data = substr(data, 9) WHERE owner = '{task}' AND name = 'modal'",
            "`modal` of {task}",
        ),
        ("UPDATE arrays SET dtype = '>f8' WHERE owner = '{task}' AND name = 'modal'", "has the type `>f8`"),
        ("DELETE FROM arrays WHERE owner = '{task}' AND name = 'argument'", "is not what was stored"),
        ("DELETE FROM results WHERE task = '{task}'", "the result of task {task} is gone"),
        ("UPDATE branches SET omega_max = 7 WHERE id = {id}", "numbers in the table of branches are others"),
        ("UPDATE branches SET kind = 'open', number = 3 WHERE id = {id}", "is another one, isola 1"),
        (
            "UPDATE arrays SET data = zeroblob(length(data)) WHERE owner = '{task}' AND name = 'displacement'",
            "modal amplitudes",
        ),
        ("UPDATE results SET record = x'81' WHERE task = '{task}'", "the result of task {task}"),
    ],
)
def test_damage_of_a_branch_is_found_and_the_others_are_read(copy: Path, script: str, message: str) -> None:
    before = whole(isola_hbm.load(copy))
    with sqlite3.connect(copy / "run.sqlite") as db:
        number, task = db.execute(
            "SELECT id, task FROM branches WHERE amplitude = '0.006' AND kind = 'isola'"
        ).fetchone()
    db.close()
    change(copy, "PRAGMA foreign_keys = OFF;" + script.format(id=number, task=task))
    run = isola_hbm.load(copy)
    (name,) = [name for name in run if name.startswith("0.006/") and name != "0.006/main"]
    (sentence,) = [
        sentence for sentence in run.check() if sentence.startswith(f"Branch {name} is left out: ")
    ]
    assert message.format(task=task) in sentence
    if "displacement" not in script:
        with pytest.raises(isola_hbm.Damaged):
            run[name]["modal"].load()
    after = whole(run)
    for other in before.keys() - {"0.006/isola 1"}:
        np.testing.assert_array_equal(after[other], before[other])


def test_damage_of_what_is_no_branch(copy: Path) -> None:
    change(
        copy,
        "UPDATE results SET record = zeroblob(length(record)) WHERE task = (SELECT task FROM curves);"
        "UPDATE meta SET value = 'another' WHERE key = 'model_sha256'",
    )
    run = isola_hbm.load(copy)
    sentences = run.check()
    assert sentences[0] == "The model is left out: the model is not the one that the run began with."
    assert any("A result is left out: the result of task" in sentence for sentence in sentences)
    with pytest.raises(isola_hbm.Damaged, match="not the one that the run began with"):
        _ = run.model


def test_branches_that_are_gone_are_named(copy: Path) -> None:
    change(copy, "DELETE FROM branches WHERE amplitude = '0.006' AND kind = 'isola'")
    run = isola_hbm.load(copy)
    assert "0.006/isola 1" not in run
    (sentence,) = run.check()
    assert sentence.startswith("Branch 0.006/isola 1 is gone: task ")


def test_a_damaged_model_leaves_the_tables(copy: Path) -> None:
    change(copy, "UPDATE model SET payload = x'c1'")
    run = isola_hbm.load(copy)
    assert len(run.summary) == len(run) > 4
    with pytest.raises(isola_hbm.Damaged, match="the model"):
        run["0.005/main"]
    with pytest.raises(isola_hbm.Damaged, match="the model"):
        _ = run.model


def test_a_folder_with_odd_characters(damper: Path, tmp_path: Path) -> None:
    odd = tmp_path / "50% of #1?"
    shutil.copytree(damper, odd)
    assert isola_hbm.load(odd).summary.equals(isola_hbm.load(damper).summary)


def test_whatever_is_damaged_raises_nothing_else(copy: Path) -> None:
    file = copy / "run.sqlite"
    whole_file = file.read_bytes()
    random = np.random.default_rng(7)
    reads = ("summary", "windows", "folds", "events", "backbones", "points", "stage", "counts", "model")
    for _ in range(12):
        damaged = bytearray(whole_file)
        for place in random.integers(100, len(damaged) - 64, size=random.choice([1, 20, 200])):
            damaged[place : place + 64] = random.bytes(64)
        file.write_bytes(damaged)
        with warnings.catch_warnings(), contextlib.suppress(isola_hbm.IsolaError):
            warnings.simplefilter("ignore", isola_hbm.LeftOut)
            run = isola_hbm.load(copy)
            for name in reads:
                with contextlib.suppress(isola_hbm.IsolaError):
                    getattr(run, name)
            run.check()
            whole(run)


def test_what_is_left_out_of_a_table_is_a_warning(copy: Path) -> None:
    names = list(isola_hbm.load(copy))
    change(copy, "UPDATE branches SET omega_min = 'high' WHERE amplitude = '0.006' AND kind = 'isola'")
    run = isola_hbm.load(copy)
    message = "The branches at A = 0.006 are left out: `omega_min` in the table `branches` is no number"
    with pytest.warns(isola_hbm.LeftOut, match=message) as caught:
        found = list(run.summary.index)
    assert found == [name for name in names if not name.startswith("0.006/")]
    # The warning points at who asked.
    assert caught[0].filename == __file__
    assert message + "." in run.check()
