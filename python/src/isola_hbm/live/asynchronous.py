"""A run followed from :mod:`asyncio`: the same follower, in a thread of its own."""

from __future__ import annotations

import asyncio
import contextlib
import queue
import threading
from collections.abc import AsyncIterator
from concurrent.futures import Future
from types import TracebackType
from typing import TYPE_CHECKING, final

import zenoh

from .follow import Follower
from .types import Branch

if TYPE_CHECKING:
    from .run import Run

#: A branch that is asked for; None at the end of the run.
Wanted = Future["Branch | None"]


@final
class Following(AsyncIterator[Branch]):
    """Branches of a run, as ``async for`` takes them: see :meth:`isola_hbm.Run.afollow`.

    Several tasks may take from it; each branch goes to one of them. After its end, and after an exception, there is
    nothing more.
    """

    # Reading a branch is arithmetic on megabytes, and all requests block: in a thread neither holds the event loop up. The
    # thread does nothing before it is asked for the next branch, and knows nothing of this object, which may be forgotten.

    def __init__(self, run: Run, timeout: float) -> None:
        self._cancellation = zenoh.CancellationToken()
        self._follower = Follower(run._cancellable(self._cancellation), timeout)
        self._wanted: queue.SimpleQueue[Wanted | None] = queue.SimpleQueue()
        #: What the thread was asked for last, unless it was handed out.
        self._next: Wanted | None = None
        self._ended: Future[None] | None = None
        self._is_over = False
        self._turn = asyncio.Lock()

    def __aiter__(self) -> Following:
        return self

    async def __anext__(self) -> Branch:
        async with self._turn:
            if self._is_over:
                raise StopAsyncIteration
            if self._next is None:
                self._next = Future()
                self._wanted.put(self._next)
                self._start()
            # Whoever is cancelled here leaves the branch to the next one.
            await _done(self._next)
            answer, self._next = self._next, None
            if self._is_over:
                raise StopAsyncIteration
            try:
                branch = answer.result()
            except BaseException:
                self._is_over = True
                raise
            if branch is None:
                self._is_over = True
                raise StopAsyncIteration
            return branch

    async def __aenter__(self) -> Following:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.aclose()

    async def aclose(self) -> None:
        """Ends it, and whoever waits for a branch of it; the connection stays."""
        self._is_over = True
        self._stop()
        if self._ended is not None:
            await _done(self._ended)

    def __del__(self) -> None:
        self._stop()

    def _start(self) -> None:
        if self._ended is None:
            self._ended = Future()
            arguments = (self._follower, self._wanted, self._ended)
            threading.Thread(target=_work, args=arguments, name="isola follow", daemon=True).start()

    def _stop(self) -> None:
        self._cancellation.cancel()
        self._follower.stop()
        self._wanted.put(None)


def _work(follower: Follower, wanted: queue.SimpleQueue[Wanted | None], ended: Future[None]) -> None:
    """Answers what is wanted, one branch after the other, until the run is over or nothing is wanted any more."""
    answer = wanted.get()
    try:
        with follower.listening():
            for branch in follower.branches():
                if answer is None:
                    return
                answer.set_result(branch)
                answer = wanted.get()
        if answer is not None:
            answer.set_result(None)
    except BaseException as error:  # noqa: BLE001 (raised where the branch is waited for)
        if answer is not None:
            answer.set_exception(error)
    finally:
        ended.set_result(None)


async def _done(future: Future[Branch | None] | Future[None]) -> None:
    """Waits until it is done; cancelling the wait leaves it as it is."""
    loop = asyncio.get_running_loop()
    waiter: asyncio.Future[None] = loop.create_future()

    def wake() -> None:
        if not waiter.done():
            waiter.set_result(None)

    def tell(_: object) -> None:
        # A loop that was closed meanwhile waits for nothing.
        with contextlib.suppress(RuntimeError):
            loop.call_soon_threadsafe(wake)

    future.add_done_callback(tell)
    await waiter
