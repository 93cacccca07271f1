"""A run: what it is, how it is doing, what it found, and what it finds from now on."""

from __future__ import annotations

import math
import queue
import time
from collections.abc import Callable, Iterator
from typing import TypeVar

import zenoh

from ..errors import Corrupt, NoAnswer, Refused
from .bus import STOPPED, Answer, Bus, Patience, pauses
from .types import Backbone, Branch, Done, LevelWindows, Manifest, Model, Result, Status
from .wire import VERSION, decode, sha256

T = TypeVar("T")

#: Time without news after which :meth:`Run.follow` asks, s. A coordinator sends its status every second.
SILENCE = 3.0
#: Time that an announcement is given to come by itself, s, before it is asked for.
GRACE = 0.3


def _read(name: str, answer: Answer, convert: Callable[..., T], *more: object) -> T:
    message = decode(answer.payload, answer.encoding, name)
    try:
        return convert(message, *more)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise Corrupt(f"`{name}` message: {type(error).__name__} {error}") from error


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

    def status(self) -> Status:
        """How it is doing now. :class:`Refused` while it is just starting."""
        return _read("status", self.bus.fetch(self._key("status")), Status.read)

    def model(self) -> Model:
        """The structure (fetched once)."""
        if self._model is None:
            answer = self.bus.fetch(self._key("model"))
            if sha256(answer.payload) != self.manifest.model_sha256:
                raise Corrupt("the model is not the one that the manifest names")
            self._model = _read("model", answer, Model.read)
        return self._model

    def backbone(self, mode: int | None = None) -> Backbone:
        """The backbone of the primary mode, or of one of those in ``manifest.modes.followed``, counted from 0.
        :class:`Refused` while it is being computed, and if no backbone of this mode is followed."""
        key = "backbone" if mode is None else f"backbone/{mode + 1}"
        return _read("backbone", self.bus.fetch(self._key(key)), Backbone.read, self.model())

    def windows(self) -> list[LevelWindows]:
        """Windows of every level. :class:`Refused` while the backbone is being computed."""
        answer = self.bus.fetch(self._key("windows"))
        return _read(
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
        announced = (_read("done", answer, Done.read) for answer in answers)
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
        return _read("result", answer, Result.read, self.model())

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

        :class:`NoAnswer` if nothing is heard from the coordinator for `timeout` seconds.
        """
        news: queue.SimpleQueue[Answer] = queue.SimpleQueue()

        def hear(sample: zenoh.Sample) -> None:
            news.put(Answer(str(sample.key_expr), str(sample.encoding), sample.payload.to_bytes()))

        # Subscribe first, ask afterwards: what comes in between comes twice, not never.
        keys = ("done/*", "status")
        subscribers = [self.bus.session.declare_subscriber(self._key(key), hear) for key in keys]
        try:
            yield from _Follower(self, news, timeout).branches()
        finally:
            if not self.bus.session.is_closed():
                for subscriber in subscribers:
                    subscriber.undeclare()


class _Follower:
    """What :meth:`Run.follow` knows."""

    def __init__(self, run: Run, news: queue.SimpleQueue[Answer], timeout: float) -> None:
        self.run = run
        self.news = news
        self.timeout = timeout
        #: Announcements by task, and those whose branch was not handed out yet.
        self.announced: dict[str, Done] = {}
        self.pending: list[Done] = []
        #: Number of announcements that there are according to the coordinator.
        self.expected = 0
        self.is_over = False
        #: Time spent listening since the coordinator was last heard, s.
        self.silent = 0.0

    @property
    def missing(self) -> int:
        """How many announcements are known to have been missed."""
        return self.expected - len(self.announced)

    def branches(self) -> Iterator[Branch]:
        check, pause = time.monotonic(), GRACE
        while True:
            if time.monotonic() >= check:
                whole = self.ask()
                yield from self.hand_out()
                if whole and self.is_over:
                    return
                pause = GRACE if whole else min(2 * pause, SILENCE)
                check = time.monotonic() + (SILENCE if whole else pause)
            if self.silent > self.timeout:
                raise NoAnswer(f"nothing heard from run `{self.run.manifest.run}` for {self.silent:.0f} s")
            if self.listen(check):
                yield from self.hand_out()
                # As long as there is news nothing needs to be asked for, unless something was missed.
                quiet = self.missing <= 0 and not self.is_over
                check = time.monotonic() + SILENCE if quiet else min(check, time.monotonic() + GRACE)

    def ask(self) -> bool:
        """Asks for status and announcements; whether all of them are here."""
        since, patience = time.monotonic(), Patience(min(self.run.bus.timeout, self.timeout))
        answers = self.run.bus.ask(self.run._key("status"), patience)
        for answer in answers.answers:
            self.note(answer)
        if answers.refusal is not None:
            # It is there, just starting.
            self.silent = 0.0
        elif not answers.answers:
            self.listened(since, patience.deadline)
        if answers.answers:
            for done in self.run._announced(patience).values():
                self.add(done)
        return bool(answers.answers) and self.missing <= 0

    def listen(self, until: float) -> bool:
        """Waits for news until then and takes all there is; whether there was any."""
        since = time.monotonic()
        until = max(until, since)
        try:
            self.note(self.news.get(timeout=until - since))
        except queue.Empty:
            self.listened(since, until)
            return False
        while not self.news.empty():
            self.note(self.news.get())
        return True

    def note(self, answer: Answer) -> None:
        """Takes down a status or an announcement."""
        self.silent = 0.0
        if answer.key.endswith("/status"):
            status = _read("status", answer, Status.read)
            self.expected, self.is_over = status.sequence, status.is_over
        else:
            self.add(_read("done", answer, Done.read))

    def add(self, done: Done) -> None:
        """Takes down an announcement, once."""
        self.expected = max(self.expected, done.sequence)
        if done.task not in self.announced:
            self.announced[done.task] = done
            self.pending.append(done)

    def listened(self, since: float, until: float) -> None:
        """Counts time spent listening in vain. Whoever was stopped meanwhile could not hear anybody."""
        now = time.monotonic()
        self.silent = 0.0 if now > until + STOPPED else self.silent + now - since

    def hand_out(self) -> Iterator[Branch]:
        """Branches announced, in their order. Whoever takes them may take any time."""
        self.pending.sort(key=lambda done: done.sequence)
        while self.pending:
            done = self.pending.pop(0)
            if done.branch is not None:
                yield self.fetch(done)

    def fetch(self, done: Done) -> Branch:
        """A branch, with as much time as a coordinator that is started again may take."""
        attempts = max(2, math.ceil(self.timeout / self.run.bus.timeout))
        for attempt in range(1, attempts + 1):
            try:
                return self.run._branch(done)
            except NoAnswer:
                if attempt == attempts:
                    raise
        raise AssertionError("the last attempt returns or raises")
