"""A coordinator that stores and announces what it is told to: the frozen samples with other numbers."""

from __future__ import annotations

import copy
import json
import socket
import threading
from pathlib import Path
from typing import Any, final

import msgpack
import numpy as np
import zenoh

from isola_hbm.live.wire import REFUSAL, VERSION, encoding, sha256

FROZEN = Path(__file__).parents[2] / "protocol" / "tests" / "frozen"


def frozen(name: str) -> bytes:
    """Bytes of a sample, as the Rust tests freeze them."""
    return (FROZEN / f"{name}.snap.msgpack").read_bytes()


def sample(name: str) -> Any:
    """A sample, to be changed."""
    return msgpack.unpackb(frozen(name))


def wire_array(values: Any) -> dict[str, Any]:
    """An array as it is sent."""
    values = np.ascontiguousarray(values, "<f8")
    return {"dtype": "<f8", "shape": list(values.shape), "data": values.tobytes()}


def free_port() -> int:
    """A port of the loopback interface that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@final
class Coordinator:
    """One run, on a router of its own that can be stopped and started again."""

    def __init__(
        self, *, run: str = "damper-1", version: int = VERSION, settings: dict[str, Any] | None = None
    ) -> None:
        self.endpoint = f"tcp/127.0.0.1:{free_port()}"
        self.settings = settings or {}
        self.base = f"isola/v{version}/{run}"
        self.model = frozen("model")
        self.manifest = {
            **sample("manifest"),
            "run": run,
            "protocol": version,
            "model_sha256": sha256(self.model),
        }
        self.backbone: bytes | None = frozen("backbone")
        self.stage = "sweep"
        #: Announcements and results by task, as bytes.
        self.store: dict[str, tuple[bytes, bytes]] = {}
        self.found = 0
        #: Keys asked for.
        self.asked: list[str] = []
        #: Pause between statuses that are sent by themselves, s.
        self.period = 0.1
        self.wake = threading.Event()
        self.session: zenoh.Session | None = None
        self.beat: threading.Thread | None = None
        self.start()

    def __enter__(self) -> Coordinator:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        """Listens, with what is stored."""
        config = zenoh.Config()
        for key, value in {
            "mode": "router",
            "listen/endpoints": [self.endpoint],
            "listen/exit_on_failure": True,
            "scouting/multicast/enabled": False,
            "scouting/gossip/enabled": False,
            "adminspace/enabled": False,
            **self.settings,
        }.items():
            config.insert_json5(key, json.dumps(value))
        self.session = zenoh.open(config)
        for key in ("run", "model", "backbone", "backbone/*", "windows", "status", "done/*", "result/*"):
            self.session.declare_queryable(f"{self.base}/{key}", self.answer, complete=True)
        self.wake.clear()
        self.beat = threading.Thread(target=self.report, args=(self.session,), daemon=True)
        self.beat.start()

    def stop(self) -> None:
        """Leaves; what is stored stays."""
        session, self.session = self.session, None
        if session is not None:
            session.close()
            self.wake.set()
            assert self.beat is not None
            self.beat.join(5)

    def report(self, session: zenoh.Session) -> None:
        """Sends the status again and again."""
        while self.session is session:
            try:
                self.put("status", "status", self.status())
            except zenoh.ZError:
                return
            self.wake.wait(self.period)

    def put(self, rest: str, name: str, payload: bytes) -> None:
        """Puts a message."""
        if (session := self.session) is not None:
            drop = zenoh.CongestionControl.DROP
            session.put(f"{self.base}/{rest}", payload, encoding=encoding(name), congestion_control=drop)

    def status(self) -> bytes:
        """The status message."""
        message = {**sample("status"), "stage": self.stage, "sequence": len(self.store)}
        message["tasks"] = {**message["tasks"], "done": len(self.store), "branches": self.found}
        return msgpack.packb(message)

    def answer(self, query: zenoh.Query) -> None:
        """Answers whatever is asked."""
        asked = str(query.key_expr)
        self.asked.append(asked)
        rest = asked.removeprefix(f"{self.base}/") if asked.startswith(self.base) else "run"

        def reply(key: str, name: str, payload: bytes) -> None:
            query.reply(f"{self.base}/{key}", payload, encoding=encoding(name))

        def refuse(why: str) -> None:
            query.reply_err(why, encoding=REFUSAL)

        with query:
            if rest == "run":
                reply("run", "manifest", msgpack.packb({**self.manifest, "stage": self.stage}))
            elif rest == "model":
                reply("model", "model", self.model)
            elif rest == "status":
                reply("status", "status", self.status())
            elif rest == "windows" or rest.split("/")[0] == "backbone":
                if self.backbone is None:
                    refuse("the backbone is still being computed")
                elif rest == "windows":
                    reply(rest, rest, frozen("windows"))
                elif rest in ("backbone", "backbone/1"):
                    reply(rest, "backbone", self.backbone)
                else:
                    refuse("no backbone of this mode was followed")
            elif rest.startswith("done/"):
                for task, (done, _) in list(self.store.items()):
                    if rest in ("done/*", f"done/{task}"):
                        reply(f"done/{task}", "done", done)
            else:
                task = rest.split("/")[-1]
                if task in self.store:
                    reply(f"result/{task}", "result", self.store[task][1])
                else:
                    refuse(f"task {task} has no result yet")

    def add(self, *, silent: bool = False, nothing: bool = False, points: int = 5) -> str:
        """Stores and announces a result, with a new branch or with nothing. `silent`: the announcement gets lost."""
        number = len(self.store)
        task = f"2.5-{number}"
        result = copy.deepcopy(sample("result_nothing" if nothing else "result"))
        result["task"] = task
        if not nothing:
            name: Any = "main" if self.found == 0 else {"isola": self.found - 1}
            self.found += 1
            result.update(name=name, outcome={"found": name})
            omega = 100.0 * number + np.arange(points)
            modal = np.random.default_rng(number).normal(size=(points, 2, 2, 2))
            zeros = np.zeros(points)
            result["branch"].update(special=[{"kind": "start", "index": 0}], outcome="closed")
            result["branch"]["points"] = {
                "motions": {
                    "harmonics": 1,
                    "omega": wire_array(omega),
                    "decay": wire_array(zeros),
                    "forcing": wire_array(zeros + 2.5),
                    "argument": wire_array(np.zeros((points, 9, 2, 2))),
                    "modal": wire_array(modal),
                },
                "amplitude": wire_array(omega[:, None]),
                "rms": wire_array(omega[:, None]),
                "contact": wire_array(np.zeros((points, 2))),
                "residual": wire_array(zeros),
                "high_harmonics": wire_array(zeros),
                "iterations": wire_array(zeros),
            }
        payload = msgpack.packb(result)
        done = sample("done_nothing" if nothing else "done")
        done.update(sequence=number + 1, task=task, size=len(payload), sha256=sha256(payload))
        if not nothing:
            done.update(outcome=result["outcome"], branch=result["name"])
        announcement = msgpack.packb(done)
        self.store[task] = (announcement, payload)
        if not silent:
            self.put(f"done/{task}", "done", announcement)
        return task
