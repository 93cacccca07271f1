"""The client against a coordinator of its own: late joins, lost announcements, restarts, frozen readers."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import msgpack
import numpy as np
import pytest
from fake import Coordinator, free_port

import isola_hbm
from isola_hbm.live.wire import VERSION, encoding, sha256


@pytest.fixture
def bus(coordinator: Coordinator) -> Iterator[isola_hbm.Bus]:
    with isola_hbm.connect(coordinator.endpoint) as bus:
        yield bus


class Reader(threading.Thread):
    """Follows a run, and keeps what comes."""

    def __init__(self, run: isola_hbm.Run, timeout: float = 20.0) -> None:
        super().__init__(daemon=True)
        self.run_followed = run
        self.timeout = timeout
        self.branches: list[isola_hbm.Branch] = []
        self.error: isola_hbm.IsolaError | None = None
        self.start()

    def run(self) -> None:
        try:
            for branch in self.run_followed.follow(self.timeout):
                self.branches.append(branch)
        except isola_hbm.IsolaError as error:
            self.error = error

    def tasks(self) -> list[str]:
        return [branch.task for branch in self.branches]

    def wait_for(self, count: int, seconds: float = 10.0) -> None:
        deadline = time.monotonic() + seconds
        while len(self.branches) < count:
            assert time.monotonic() < deadline, (self.tasks(), self.error)
            assert self.error is None, self.error
            time.sleep(0.01)

    def finish(self, seconds: float = 15.0) -> None:
        self.join(seconds)
        assert not self.is_alive(), f"still waiting with {self.tasks()}"
        assert self.error is None, self.error


def test_a_run_and_its_parts(coordinator, bus):
    (manifest,) = bus.runs()
    assert (manifest.run, manifest.stage) == ("damper-1", "sweep")
    run = bus.run()
    assert run.model().dofs == ("root", "tip")
    assert run.model() is run.model()
    assert len(run.backbone()) == len(run.backbone(mode=0)) == 3
    with pytest.raises(isola_hbm.Refused, match="no backbone of this mode"):
        run.backbone(mode=2)
    assert run.windows()[1].windows[0].best == 70
    assert run.status().sequence == 0
    assert run.done() == []
    assert run.branches() == []
    tasks = [coordinator.add(), coordinator.add(nothing=True), coordinator.add()]
    assert [done.task for done in run.done()] == tasks
    assert [(branch.task, branch.name) for branch in run.branches()] == [
        (tasks[0], "main"),
        (tasks[2], "isola 1"),
    ]
    assert run.result(tasks[1]).branch is None
    main = run.result(run.done()[0]).branch
    np.testing.assert_array_equal(main.omega, np.arange(5))
    with pytest.raises(isola_hbm.Refused, match="task 9-9 has no result yet"):
        run.result("9-9")
    coordinator.backbone = None
    for part in (run.backbone, run.windows):
        with pytest.raises(isola_hbm.Refused, match="still being computed"):
            part()


def test_choosing_a_run(coordinator):
    with isola_hbm.connect(coordinator.endpoint) as bus:
        assert bus.run("damper-1").manifest.run == "damper-1"
        with pytest.raises(isola_hbm.NoSuchRun, match="no run `other`; there are `damper-1`"):
            bus.run("other")
        other = {**coordinator.manifest, "run": "damper-2", "name": "second"}
        key = f"isola/v{VERSION}/damper-2/run"

        def answer(query):
            with query:
                query.reply(key, msgpack.packb(other), encoding=encoding("manifest"))

        coordinator.session.declare_queryable(key, answer, complete=True)
        assert [run.run for run in bus.runs()] == ["damper-1", "damper-2"]
        with pytest.raises(
            isola_hbm.NoSuchRun, match=r"several runs.*`damper-1` .*; `damper-2` \(second, sweep\)"
        ):
            bus.run()
        assert bus.run("damper-2").manifest.name == "second"
    with isola_hbm.connect(coordinator.endpoint, namespace="elsewhere") as bus:
        assert bus.runs() == []
        with pytest.raises(isola_hbm.NoSuchRun, match="no run in `elsewhere`"):
            bus.run()


def test_another_version_is_told():
    told = pytest.raises(isola_hbm.OtherVersion, match=rf"`damper-1` \(v{VERSION + 1}, Isola 0.1.0\)")
    with Coordinator(version=VERSION + 1) as fake, isola_hbm.connect(fake.endpoint) as bus, told:
        bus.runs()


def test_addresses(coordinator, tmp_path):
    with pytest.raises(isola_hbm.Unreachable, match="its run is not on the bus"):
        isola_hbm.connect(tmp_path)
    (tmp_path / "address").write_text(coordinator.endpoint + "\n")
    for directory in (tmp_path, str(tmp_path)):
        with isola_hbm.connect(directory) as bus:
            assert len(bus.runs()) == 1
    with pytest.raises(isola_hbm.Unreachable, match="neither an endpoint"):
        isola_hbm.connect("localhost")
    with pytest.raises(isola_hbm.Unreachable, match="no coordinator or router can be reached"):
        isola_hbm.connect(f"tcp/127.0.0.1:{free_port()}")


def test_early_half_way_and_late(coordinator, bus):
    run = bus.run()
    early = Reader(run)
    first = [coordinator.add(), coordinator.add()]
    early.wait_for(2)
    half_way = Reader(run)
    coordinator.add(nothing=True)
    second = [coordinator.add(), coordinator.add()]
    early.wait_for(4)
    coordinator.stage = "finished"
    late = Reader(run)
    for reader in (early, half_way, late):
        reader.finish()
        assert reader.tasks() == first + second
    names = [branch.name for branch in late.branches]
    assert names == ["main", "isola 1", "isola 2", "isola 3"]


def test_many_at_once_while_joining(coordinator, bus):
    run = bus.run()
    adding = threading.Thread(target=lambda: [coordinator.add(points=200) for _ in range(150)])
    adding.start()
    readers = []
    for _ in range(4):
        readers.append(Reader(run))
        time.sleep(0.05)
    adding.join()
    coordinator.stage = "finished"
    for reader in readers:
        reader.finish(30)
        assert sorted(reader.tasks()) == sorted(coordinator.store)


def test_lost_announcements_are_noticed_by_the_status(coordinator, bus):
    reader = Reader(bus.run())
    tasks = [coordinator.add()]
    reader.wait_for(1)
    tasks += [coordinator.add(silent=True), coordinator.add(silent=True)]
    reader.wait_for(3, 2)
    coordinator.stage = "cancelled"
    reader.finish()
    assert reader.tasks() == tasks


def test_lost_announcements_are_noticed_by_a_gap(coordinator, bus):
    coordinator.period = 3600
    time.sleep(0.2)
    reader = Reader(bus.run())
    tasks = [coordinator.add()]
    reader.wait_for(1)
    tasks += [coordinator.add(silent=True), coordinator.add()]
    reader.wait_for(3, 2)
    assert sorted(reader.tasks()) == tasks
    # Neither announcements nor statuses come any more.
    tasks.append(coordinator.add(silent=True))
    reader.wait_for(4, 8)
    coordinator.stage = "finished"
    reader.finish()
    assert sorted(reader.tasks()) == tasks


def test_announcements_that_come_twice_are_one(coordinator, bus):
    reader = Reader(bus.run())
    task = coordinator.add()
    reader.wait_for(1)
    for _ in range(5):
        coordinator.put(f"done/{task}", "done", coordinator.store[task][0])
    coordinator.stage = "finished"
    reader.finish()
    assert reader.tasks() == [task]


def test_a_coordinator_that_is_started_again(coordinator, bus):
    reader = Reader(bus.run())
    tasks = [coordinator.add(), coordinator.add()]
    reader.wait_for(2)
    for _ in range(2):
        coordinator.stop()
        tasks.append(coordinator.add(silent=True))
        time.sleep(1.5)
        coordinator.start()
        tasks.append(coordinator.add())
        reader.wait_for(len(tasks), 15)
    coordinator.stage = "finished"
    reader.finish()
    assert reader.tasks() == tasks


def test_a_coordinator_that_is_gone(coordinator, bus):
    run = bus.run()
    reader = Reader(run, timeout=3)
    coordinator.add()
    reader.wait_for(1)
    coordinator.stop()
    started = time.monotonic()
    reader.join(15)
    assert isinstance(reader.error, isola_hbm.NoAnswer)
    assert "nothing heard from run `damper-1`" in str(reader.error)
    assert 2 < time.monotonic() - started < 8
    bus.timeout = 2
    for ask in (run.status, run.done, run.backbone, bus.runs):
        with pytest.raises(isola_hbm.NoAnswer):
            ask()


def test_looking_for_a_coordinator_that_is_started_again(coordinator, bus):
    coordinator.stop()
    start = threading.Timer(1.5, coordinator.start)
    start.start()
    assert len(bus.runs()) == 1
    start.join()


def test_a_slow_reader_misses_nothing(coordinator, bus):
    for _ in range(3):
        coordinator.add()
    tasks = []
    for branch in bus.run().follow(timeout=1):
        tasks.append(branch.task)
        if len(tasks) == 2:
            for _ in range(3):
                coordinator.add()
            coordinator.stage = "finished"
            time.sleep(2.5)
    assert tasks == list(coordinator.store)


def test_leaving_early(coordinator, bus):
    coordinator.add()
    coordinator.add()
    branches = bus.run().follow()
    assert next(branches).name == "main"
    branches.close()
    with isola_hbm.connect(coordinator.endpoint) as other:
        left = other.run().follow()
        assert next(left).name == "main"
        other.close()
        left.close()


def test_wrong_bytes_are_noticed(coordinator, bus):
    run = bus.run()
    task = coordinator.add()
    done, result = coordinator.store[task]
    coordinator.store[task] = (done, result.replace(b"host-77", b"host-78"))
    with pytest.raises(isola_hbm.Corrupt, match="SHA-256 differs"):
        run.result(task)
    with pytest.raises(isola_hbm.Corrupt, match="SHA-256 differs"):
        next(run.follow())
    announcement = msgpack.unpackb(done)
    announcement["sha256"] = sha256(b"\x80")
    coordinator.store[task] = (msgpack.packb(announcement), b"\x80")
    with pytest.raises(isola_hbm.Corrupt, match="`result` message: KeyError"):
        run.result(task)
    coordinator.model += b"\0"
    with pytest.raises(isola_hbm.Corrupt, match="not the one that the manifest names"):
        bus.run().model()


def test_command_line(coordinator):
    coordinator.add()
    coordinator.add()
    coordinator.stage = "finished"
    command = [sys.executable, "-m", "isola_hbm", coordinator.endpoint]
    out = subprocess.run(command, capture_output=True, text=True, timeout=30, check=True).stdout.splitlines()
    assert out == [
        "damper-1  nonlinear damper  finished  A = 1e-3, 2.5",
        "A = 2.5  main: closed, 5 points, 0 to 4 rad/s, at most 4.0000e+00 m at 4 rad/s",
        "A = 2.5  isola 1: closed, 5 points, 100 to 104 rad/s, at most 1.0400e+02 m at 104 rad/s",
        "finished: 2 branches, 3 tasks given up",
    ]
    command[-1] = f"tcp/127.0.0.1:{free_port()}"
    ended = subprocess.run(command, capture_output=True, text=True, timeout=30, check=False)
    assert ended.returncode == 1
    assert ended.stderr.startswith("isola: no coordinator or router can be reached")


def test_a_frozen_reader_delays_nobody_and_catches_up(coordinator, bus):
    run = bus.run()
    # Less patience than the time for which it is stopped.
    command = [sys.executable, "-m", "isola_hbm", coordinator.endpoint, "--timeout", "5"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as viewer:
        try:
            coordinator.add()
            assert viewer.stdout is not None
            assert "nonlinear damper" in viewer.stdout.readline()
            assert "main" in viewer.stdout.readline()
            os.kill(viewer.pid, signal.SIGSTOP)
            healthy, waits = Reader(run), []
            for _ in range(60):
                coordinator.add(points=500)
                started = time.monotonic()
                run.status()
                waits.append(time.monotonic() - started)
            healthy.wait_for(61)
            assert max(waits) < 1
            assert float(np.median(waits)) < 0.1
            # Longer than its connection lives.
            time.sleep(7)
            coordinator.add()
            os.kill(viewer.pid, signal.SIGCONT)
            coordinator.stage = "finished"
            healthy.finish()
            lines = viewer.communicate(timeout=60)[0].splitlines()
            assert len([line for line in lines if line.startswith("A = ")]) == 61
            assert viewer.returncode == 0
        finally:
            viewer.kill()


LISTENING = """
import isola_hbm, os, sys
def sockets():
    own = set()
    for fd in os.listdir("/proc/self/fd"):
        try: own.add(os.readlink(f"/proc/self/fd/{fd}"))
        except OSError: pass
    found = []
    for table in ("tcp", "tcp6", "udp", "udp6"):
        for line in open(f"/proc/self/net/{table}").read().splitlines()[1:]:
            parts = line.split()
            if f"socket:[{parts[9]}]" in own and (parts[3] == "0A" or table.startswith("udp")):
                found.append((table, parts[1]))
    return found
with isola_hbm.connect(sys.argv[1]) as bus:
    bus.runs()
    print(sockets())
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_a_client_listens_nowhere(coordinator):
    command = [sys.executable, "-c", LISTENING, coordinator.endpoint]
    assert subprocess.run(command, capture_output=True, text=True, timeout=30, check=True).stdout == "[]\n"


def test_passwords(tmp_path):
    (tmp_path / "users").write_text("me:secret\n")
    users = {"transport/auth/usrpwd": {"dictionary_file": str(tmp_path / "users")}}
    with Coordinator(settings=users) as fake:
        right, wrong = (
            {"transport/auth/usrpwd": {"user": "me", "password": word}} for word in ("secret", "wrong")
        )
        with isola_hbm.connect(fake.endpoint, settings=right) as bus:
            assert len(bus.runs()) == 1
        for settings in (wrong, None):
            with pytest.raises(
                isola_hbm.Unreachable, match="not to have its secret looks the same"
            ):
                isola_hbm.connect(fake.endpoint, settings=settings)


def test_a_partner_that_does_not_answer_is_not_waited_for_forever():
    with socket.create_server(("127.0.0.1", 0)) as deaf:
        started = time.monotonic()
        with pytest.raises(isola_hbm.Unreachable):
            isola_hbm.connect(f"tcp/127.0.0.1:{deaf.getsockname()[1]}")
        assert time.monotonic() - started < 15


def test_the_example_of_the_documentation(coordinator):
    text = (Path(__file__).parents[2] / "protocol" / "MESSAGES.md").read_text()
    code = text.split("```python\n")[1].split("```")[0]
    assert len(code.strip().splitlines()) <= 18
    coordinator.add(points=2)
    command = [sys.executable, "-u", "-c", code, coordinator.endpoint]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as example:
        try:
            assert example.stdout is not None
            assert example.stdout.readline() == "2.5 main [0. 1.] [0. 1.]\n"
            coordinator.add(nothing=True)
            coordinator.add(points=2)
            assert example.stdout.readline() == "2.5 {'isola': 0} [200. 201.] [200. 201.]\n"
        finally:
            example.kill()
