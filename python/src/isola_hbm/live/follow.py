"""A run followed: every branch exactly once, whatever gets lost on the way."""

from __future__ import annotations

import contextlib
import math
import queue
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

import zenoh

from ..errors import NoAnswer
from .bus import CLOSED, STOPPED, Answer, Patience, read
from .types import Branch, Done, Status

if TYPE_CHECKING:
    from .run import Run

#: Time without news after which is asked, s. A coordinator sends its status every second.
SILENCE = 3.0
#: Time that an announcement is given to come by itself, s, before it is asked for.
GRACE = 0.3


class Follower:
    """What :meth:`Run.follow` knows."""

    def __init__(self, run: Run, timeout: float) -> None:
        self.run = run
        #: What comes by itself; None wakes whoever waits.
        self.news: queue.SimpleQueue[Answer | None] = queue.SimpleQueue()
        self.timeout = timeout
        #: Announcements by task, and those whose branch was not handed out yet.
        self.announced: dict[str, Done] = {}
        self.pending: list[Done] = []
        #: Number of announcements that there are according to the coordinator.
        self.expected = 0
        self.is_over = False
        self.is_stopped = False
        #: Time spent listening since the coordinator was last heard, s.
        self.silent = 0.0

    @contextlib.contextmanager
    def listening(self) -> Iterator[None]:
        """Subscribes to announcements and status. To be entered before anything is asked: what comes in between comes
        twice, not never."""
        run, bus = self.run, self.run.bus

        def hear(sample: zenoh.Sample) -> None:
            self.news.put(Answer(str(sample.key_expr), str(sample.encoding), sample.payload.to_bytes()))

        keys = ("done/*", "status")
        try:
            subscribers = [bus.session.declare_subscriber(run._key(key), hear) for key in keys]
        except zenoh.ZError as error:
            if bus.session.is_closed():
                raise NoAnswer(CLOSED) from error
            raise
        bus._closing.add(self.stop)
        try:
            yield
        finally:
            bus._closing.discard(self.stop)
            if not bus.session.is_closed():
                for subscriber in subscribers:
                    subscriber.undeclare()

    def stop(self) -> None:
        """Ends it, from any thread: whoever waits is woken."""
        self.is_stopped = True
        self.news.put(None)

    @property
    def missing(self) -> int:
        """How many announcements are known to have been missed."""
        return self.expected - len(self.announced)

    def branches(self) -> Iterator[Branch]:
        check, pause = time.monotonic(), GRACE
        while True:
            if self.is_stopped:
                raise NoAnswer(CLOSED)
            if time.monotonic() >= check:
                whole = self.ask()
                yield from self.hand_out()
                if whole and self.is_over and not self.pending:
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

    def note(self, answer: Answer | None) -> None:
        """Takes down a status or an announcement."""
        if answer is None:
            return
        self.silent = 0.0
        if answer.key.endswith("/status"):
            status = read("status", answer, Status.read)
            self.expected, self.is_over = status.sequence, status.is_over
        else:
            self.add(read("done", answer, Done.read))

    def add(self, done: Done) -> None:
        """Takes down an announcement, once. A result that was withdrawn since it was wrong (it brought no branch) is followed
        by another one of its task."""
        self.expected = max(self.expected, done.sequence)
        known = self.announced.get(done.task)
        if known is None or known.sha256 != done.sha256:
            self.announced[done.task] = done
            self.pending.append(done)

    def listened(self, since: float, until: float) -> None:
        """Counts time spent listening in vain. Whoever was stopped meanwhile could not hear anybody."""
        now = time.monotonic()
        self.silent = 0.0 if now > until + STOPPED else self.silent + now - since

    def hand_out(self) -> Iterator[Branch]:
        """Branches announced, in their order. Whoever takes them may take any time."""
        self.pending.sort(key=lambda done: done.sequence)
        while self.pending and not self.is_stopped:
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
                if attempt == attempts or self.is_stopped:
                    raise
        raise AssertionError("the last attempt returns or raises")
