"""The client against the program itself: one study, read from its beginning, from half way, after its end, and frozen."""

from __future__ import annotations

import asyncio
import csv
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from fake import free_port
from runs import MODELS, ROOT, program

import isola_hbm

STUDY = MODELS / "nonlinear_damper" / "study.toml"
HARMONICS = 20
STEP = 2e-4
PATIENCE = 300.0


def wait_for(what: str, condition: Callable[[], bool], seconds: float = PATIENCE) -> None:
    """Waits."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"no {what} in {seconds} s"
        time.sleep(0.02)


class Live:
    """A run that is under way."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.endpoint = f"tcp/127.0.0.1:{free_port()}"
        self.log = (directory.parent / "log").open("w+")
        # More levels and harmonics and shorter steps than the study's, so that there is a half way.
        settings = [
            f"harmonics.count={HARMONICS}",
            "continuation.max_step=0.005",
            "continuation.initial_step=0.002",
        ]
        changes = [argument for setting in settings for argument in ("--set", setting)]
        levels = ["--amplitudes", f"0.004:0.012:{STEP}", "--search", "none", "--verify", "none"]
        self.start("sweep", STUDY, "--out", directory, *levels, *changes)

    def start(self, *command: str | Path) -> None:
        """Starts the program, and waits until it is on the bus."""
        options = ["--listen", self.endpoint, "--workers", "1", "--stay"]
        # A group of its own: its workers are killed with it.
        self.process = subprocess.Popen(
            [program(), *command, *options],
            stdout=self.log,
            stderr=self.log,
            cwd=ROOT,
            start_new_session=True,
        )
        try:
            wait_for("coordinator", lambda: self.is_alive() and self.is_reachable(), 60)
        except BaseException:
            self.kill()
            raise

    @property
    def secret(self) -> Path:
        """Where its secret is."""
        return self.directory / "secret"

    def is_reachable(self) -> bool:
        """Whether somebody listens."""
        try:
            with isola_hbm.connect(self.endpoint, secret_file=self.secret) as bus:
                return len(bus.runs()) == 1
        except (isola_hbm.Unreachable, FileNotFoundError):
            return False

    def is_alive(self) -> bool:
        """True, or an error with what it printed."""
        if self.process.poll() is not None:
            self.log.seek(0)
            pytest.fail(f"isola ended with {self.process.returncode}:\n{self.log.read()}")
        return True

    def end(self) -> int:
        """Interrupts it; its exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(30)

    def kill(self) -> None:
        """Kills it and its workers, which have no time for anything."""
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait(30)


@pytest.fixture
def live(tmp_path: Path) -> Iterator[Live]:
    run = Live(tmp_path / "run")
    try:
        yield run
    finally:
        run.kill()
        run.log.close()


class Reader(threading.Thread):
    """Follows a run on a connection of its own."""

    def __init__(self, address: Path | str, secret_file: Path | None = None) -> None:
        super().__init__(daemon=True)
        self.address = address
        self.secret_file = secret_file
        self.branches: list[isola_hbm.Branch] = []
        self.error: isola_hbm.IsolaError | None = None
        self.start()

    def run(self) -> None:
        try:
            with isola_hbm.connect(self.address, secret_file=self.secret_file) as bus:
                for branch in bus.run().follow():
                    self.branches.append(branch)
        except isola_hbm.IsolaError as error:
            self.error = error

    def finish(self) -> list[isola_hbm.Branch]:
        """All branches, once the run is over."""
        self.join(PATIENCE)
        assert not self.is_alive()
        assert self.error is None, self.error
        return self.branches


class AsyncReader(Reader):
    """The same in an event loop."""

    def run(self) -> None:
        async def read() -> None:
            bus = await asyncio.to_thread(isola_hbm.connect, self.address, secret_file=self.secret_file)
            with bus:
                async for branch in (await asyncio.to_thread(bus.run)).afollow():
                    self.branches.append(branch)

        try:
            asyncio.run(read())
        except isola_hbm.IsolaError as error:
            self.error = error


def found(live: Live, run: isola_hbm.Run) -> int:
    """Number of branches found."""
    live.is_alive()
    try:
        return run.status().tasks.branches
    except isola_hbm.Refused:
        return 0


def by_name(branches: list[isola_hbm.Branch]) -> dict[tuple[str, str], isola_hbm.Branch]:
    """By forcing amplitude and name; each of them once."""
    named = {(branch.amplitude_text, branch.name): branch for branch in branches}
    assert len(named) == len(branches), "a branch came twice"
    return named


def ordinal(row: dict[str, str]) -> int:
    """Number of a row's branch within its kind."""
    digits = re.findall(r"\d+", row["branch"])
    return int(digits[-1]) if digits else 0


def compare(row: dict[str, str], branch: isola_hbm.Branch) -> None:
    """A row of summary.csv with the branch that came over the bus."""

    def same(column: str, value: float) -> None:
        assert float(row[column]) == pytest.approx(value, rel=1e-6), (column, branch)

    assert row["status"] == branch.outcome
    assert int(row["points"]) == len(branch)
    same("omega_min", branch.omega.min())
    same("omega_max", branch.omega.max())
    same("amplitude_max", branch.amplitudes[branch.peak, 0])
    same("omega_at_max", branch.omega[branch.peak])
    if branch.certificate.contact_omega:
        touching = branch.omega[branch.contact.max(axis=1, initial=0.0) > 0]
        low, high = branch.certificate.contact_omega
        assert low <= touching.min() and touching.max() <= high, branch
        same("contact_omega_min", low)
        same("contact_omega_max", high)
    else:
        assert (row["contact_omega_min"], row["contact_omega_max"]) == ("", "")


def test_every_reader_sees_every_branch_once(live: Live) -> None:
    early, in_a_loop = Reader(live.directory), AsyncReader(live.directory)
    with isola_hbm.connect(live.directory) as bus:
        run = bus.run()
        model = run.model()
        assert model.name == "nonlinear damper"

        command = [sys.executable, "-m", "isola_hbm", str(live.directory)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as viewer:
            try:
                assert viewer.stdout is not None
                viewer.stdout.readline()
                wait_for("first branches", lambda: found(live, run) >= 3)
                os.kill(viewer.pid, signal.SIGSTOP)
                assert not run.status().is_over, "the study is too short for a half way"
                half_way = Reader(live.directory)

                waits = []
                while True:
                    started = time.monotonic()
                    status = run.status()
                    waits.append(time.monotonic() - started)
                    if status.is_over:
                        break
                    live.is_alive()
                    time.sleep(0.05)
                assert float(np.median(waits)) < 0.1, waits
                assert max(waits) < 1, waits

                assert status.stage == "finished"
                assert status.tasks.dead == 0
                branches = by_name(early.finish())
                assert len(branches) == status.tasks.branches
                late = by_name(Reader(live.directory).finish())
                for other in (by_name(half_way.finish()), by_name(in_a_loop.finish()), late, by_name(run.branches())):
                    assert other.keys() == branches.keys()
                    for name, branch in branches.items():
                        np.testing.assert_array_equal(other[name].omega, branch.omega)
                        np.testing.assert_array_equal(other[name].modal, branch.modal)

                os.kill(viewer.pid, signal.SIGCONT)
                lines = viewer.communicate(timeout=60)[0].splitlines()
                printed = [line.split(":")[0] for line in lines if line.startswith("A = ")]
                assert sorted(printed) == sorted(f"A = {text}  {name}" for text, name in branches)
                assert viewer.returncode == 0
            finally:
                viewer.kill()

        announced = run.done()
        assert [done.sequence for done in announced] == list(range(1, len(announced) + 1))
        assert {done.amplitude.text for done in announced} == {a.text for a in run.manifest.amplitudes}
        for branch in branches.values():
            top = np.abs(branch.over_period(0, 4096, points=branch.peak)).max()
            assert top == pytest.approx(branch.amplitudes[branch.peak, 0], rel=1e-5)
        backbone = run.backbone()
        assert backbone.modal.shape == (len(backbone), 1, HARMONICS + 1)
        assert {level.amplitude.text for level in run.windows()} == {a.text for a in run.manifest.amplitudes}

    assert live.end() in (0, 130)
    with (live.directory / "summary.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["kind"] in ("main", "isola")]
    groups: dict[tuple[float, str], list[dict[str, str]]] = defaultdict(list)
    for row in rows:
        groups[float(row["amplitude"]), row["kind"]].append(row)
    expected: dict[tuple[float, str], list[isola_hbm.Branch]] = defaultdict(list)
    for branch in branches.values():
        expected[branch.amplitude, branch.kind].append(branch)
    assert groups.keys() == expected.keys()
    assert len(rows) == len(branches)
    for key, group in groups.items():
        pairs = zip(sorted(group, key=ordinal), sorted(expected[key], key=lambda b: b.number), strict=True)
        for row, branch in pairs:
            compare(row, branch)
    # The isola is born at 0.0048 and has merged at 0.0114.
    isolas = sorted(amplitude for amplitude, kind in groups if kind == "isola")
    assert isolas == pytest.approx([i * STEP for i in range(25, 57)])


def test_a_coordinator_that_is_killed_and_resumed(live: Live) -> None:
    reader, in_a_loop = Reader(live.endpoint, live.secret), AsyncReader(live.endpoint, live.secret)
    with isola_hbm.connect(live.endpoint, secret_file=live.secret) as bus:
        run = bus.run()
        for count in (10, 40):
            wait_for(f"{count} branches", lambda count=count: found(live, run) >= count)
            assert not run.status().is_over, "the study is too short"
            live.kill()
            live.start("resume", live.directory)
        branches = by_name(reader.finish())
        status = run.status()
        assert (status.stage, status.tasks.dead, status.tasks.branches) == ("finished", 0, len(branches))
        assert branches.keys() == by_name(run.branches()).keys() == by_name(in_a_loop.finish()).keys()
        assert sum(kind == "main" for _, kind in branches) == 41
    assert live.end() in (0, 130)
