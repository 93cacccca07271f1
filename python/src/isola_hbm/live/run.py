"""A run: what it is, how it is doing, what it found, and what it finds from now on."""

from __future__ import annotations

import time
from collections.abc import Iterator

import zenoh

from ..errors import Corrupt, NoAnswer, Refused
from .asynchronous import Following
from .bus import Bus, Patience, pauses, read
from .follow import Follower
from .types import Backbone, Branch, Done, LevelWindows, Manifest, Model, Result, Status
from .wire import VERSION, sha256


class Run:
    """One study carried out once. All methods block, and repeat a request until the bus's timeout is over."""

    def __init__(self, bus: Bus, manifest: Manifest) -> None:
        self.bus = bus
        #: What the run is, as it was when it was looked up.
        self.manifest = manifest
        self._base = f"{bus.namespace}/v{VERSION}/{manifest.run}"
        self._model: Model | None = None

    def __repr__(self) -> str:
        return f"<Run {self.manifest.run} ({self.manifest.name})>"

    def _key(self, rest: str) -> str:
        return f"{self._base}/{rest}"

    def _cancellable(self, cancellation: zenoh.CancellationToken) -> Run:
        """The same run, whose requests this ends."""
        run = Run(self.bus._cancellable(cancellation), self.manifest)
        run._model = self._model
        return run

    def status(self) -> Status:
        """How it is doing now. :class:`Refused` while it is just starting."""
        return read("status", self.bus.fetch(self._key("status")), Status.read)

    def model(self) -> Model:
        """The structure (fetched once)."""
        if self._model is None:
            answer = self.bus.fetch(self._key("model"))
            if sha256(answer.payload) != self.manifest.model_sha256:
                raise Corrupt("the model is not the one that the manifest names")
            self._model = read("model", answer, Model.read)
        return self._model

    def backbone(self, mode: int | None = None) -> Backbone:
        """The backbone of the primary mode, or of one of those in ``manifest.modes.followed``, counted from 0.
        :class:`Refused` while it is being computed, and if no backbone of this mode is followed."""
        key = "backbone" if mode is None else f"backbone/{mode + 1}"
        return read("backbone", self.bus.fetch(self._key(key)), Backbone.read, self.model())

    def windows(self) -> list[LevelWindows]:
        """Windows of every level. :class:`Refused` while the backbone is being computed."""
        answer = self.bus.fetch(self._key("windows"))
        return read(
            "windows", answer, lambda message: [LevelWindows.read(level) for level in message["levels"]]
        )

    def done(self) -> list[Done]:
        """All announcements so far, in their order."""
        try:
            expected = self.status().sequence
        except Refused:
            return []
        patience = Patience(self.bus.timeout)
        for pause in pauses():
            announced = self._announced(patience)
            if len(announced) >= expected:
                return sorted(announced.values(), key=lambda done: done.sequence)
            if patience.is_over():
                raise NoAnswer(f"{len(announced)} of {expected} announcements in {self.bus.timeout:g} s")
            time.sleep(min(pause, patience.left()))
        raise AssertionError("pauses do not end")

    def _announced(self, patience: Patience) -> dict[str, Done]:
        """The announcements that come when asked for, by task: nothing if nobody is there."""
        answers = self.bus.ask(self._key("done/*"), patience).answers
        announced = (read("done", answer, Done.read) for answer in answers)
        return {done.task: done for done in announced}

    def result(self, task: str | Done) -> Result:
        """The stored result of a task, checked against the SHA-256 that was announced."""
        if isinstance(task, Done):
            done = task
        else:
            # Asked for one by one, a task that is not done and a coordinator that is gone look the same.
            announced = {done.task: done for done in self.done()}
            if task not in announced:
                raise Refused(f"task {task} has no result yet")
            done = announced[task]
        answer = self.bus.fetch(self._key(f"result/{done.task}"))
        if sha256(answer.payload) != done.sha256:
            raise Corrupt(
                f"the result of task {done.task} ({len(answer.payload)} bytes) is not the one announced "
                f"({done.size} bytes): SHA-256 differs"
            )
        return read("result", answer, Result.read, self.model())

    def _branch(self, done: Done) -> Branch:
        branch = self.result(done).branch
        if branch is None:
            raise Corrupt(f"task {done.task} announced {done.branch}, but its result holds no branch")
        return branch

    def branches(self) -> list[Branch]:
        """All branches known now, in the order in which they were found."""
        return [self._branch(done) for done in self.done() if done.branch is not None]

    def follow(self, timeout: float = 30.0) -> Iterator[Branch]:
        """Every branch exactly once: first those that are there, then each as it is found.

        Ends when the run is finished or cancelled. Announcements are dropped on the way to a slow reader, and a
        coordinator may be started again meanwhile: what was missed is asked for.

        :class:`NoAnswer` if nothing is heard from the coordinator for `timeout` seconds, or once the connection is closed.
        """
        follower = Follower(self, timeout)
        with follower.listening():
            yield from follower.branches()

    def afollow(self, timeout: float = 30.0) -> Following:
        """The same for :mod:`asyncio`: ``async for branch in run.afollow()``.

        Every branch exactly once, with the same end and the same exceptions, while the event loop goes on; nothing is
        fetched before it is asked for. Waiting for the next branch may be cancelled
        (``await asyncio.wait_for(anext(branches), 5)``): the branch comes with the next `anext`. Use it in an
        ``async with`` statement, or call `aclose`, if it is left before its end.
        """
        return Following(self, timeout)
