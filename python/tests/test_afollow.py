"""The client in an event loop, against a coordinator of its own: what the blocking one yields, and nothing held up."""

from __future__ import annotations

import asyncio
import gc
import threading
from collections.abc import Awaitable, Callable, Iterator

import pytest
from fake import Coordinator

import isola_hbm

#: Longer than anything takes.
PATIENCE = 60.0


@pytest.fixture
def run(coordinator: Coordinator) -> Iterator[isola_hbm.Run]:
    with isola_hbm.connect(coordinator.endpoint) as bus:
        yield bus.run()


def in_a_loop(test: Callable[[], Awaitable[None]]) -> None:
    """Runs it, with an end; no thread is left."""

    async def limited() -> None:
        await asyncio.wait_for(test(), PATIENCE)

    asyncio.run(limited())
    gc.collect()
    for thread in threads():
        thread.join(PATIENCE)
        assert not thread.is_alive()


def threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "isola follow"]


async def tasks_of(run: isola_hbm.Run, timeout: float = 30.0) -> list[str]:
    return [branch.task async for branch in run.afollow(timeout)]


async def take(branches: isola_hbm.Following, count: int) -> list[str]:
    return [(await anext(branches)).task for _ in range(count)]


def test_early_half_way_and_late(coordinator, run):
    async def test() -> None:
        early = run.afollow()
        first = [coordinator.add(), coordinator.add()]
        assert await take(early, 2) == first
        half_way = run.afollow()
        coordinator.add(nothing=True)
        second = [coordinator.add(), coordinator.add()]
        assert await take(half_way, 3) == [*first, second[0]]
        coordinator.stage = "finished"
        rest = await asyncio.gather(take(early, 2), take(half_way, 1), tasks_of(run))
        assert rest == [second, second[1:], first + second]
        for branches in (early, half_way):
            for _ in range(2):
                with pytest.raises(StopAsyncIteration):
                    await anext(branches)

    in_a_loop(test)
    # And what the blocking one yields.
    assert [branch.task for branch in run.follow()] == [
        task for task, (done, _) in coordinator.store.items() if b"nothing" not in done and task != "2.5-2"
    ]


def test_many_at_once_while_joining(coordinator, run):
    adding = threading.Thread(target=lambda: [coordinator.add(points=200) for _ in range(150)])

    async def test() -> None:
        adding.start()
        readers = [asyncio.create_task(tasks_of(run)) for _ in range(4)]
        await asyncio.to_thread(adding.join)
        coordinator.stage = "finished"
        for tasks in await asyncio.gather(*readers):
            assert sorted(tasks) == sorted(coordinator.store)

    in_a_loop(test)


def test_lost_and_repeated_announcements(coordinator, run):
    async def test() -> None:
        branches = run.afollow()
        tasks = [coordinator.add()]
        assert await take(branches, 1) == tasks
        for _ in range(5):
            coordinator.put(f"done/{tasks[0]}", "done", coordinator.store[tasks[0]][0])
        lost = [coordinator.add(silent=True), coordinator.add(silent=True)]
        assert await take(branches, 2) == lost
        # Neither announcements nor statuses come any more.
        coordinator.period = 3600
        last = coordinator.add(silent=True)
        assert await take(branches, 1) == [last]
        coordinator.stage = "finished"
        assert [branch.task async for branch in branches] == []

    in_a_loop(test)


def test_a_coordinator_that_is_started_again(coordinator, run):
    async def test() -> None:
        branches = run.afollow()
        tasks = [coordinator.add(), coordinator.add()]
        assert await take(branches, 2) == tasks
        waiting = asyncio.ensure_future(take(branches, 2))
        coordinator.stop()
        lost = coordinator.add(silent=True)
        coordinator.start()
        found = coordinator.add()
        assert sorted(await waiting) == [lost, found]
        coordinator.stage = "finished"
        assert [branch.task async for branch in branches] == []

    in_a_loop(test)


def test_a_coordinator_that_is_gone(coordinator, run):
    async def test() -> None:
        branches = run.afollow(timeout=1)
        coordinator.add()
        await anext(branches)
        coordinator.stop()
        with pytest.raises(isola_hbm.NoAnswer, match="nothing heard from run `damper-1`"):
            await anext(branches)
        with pytest.raises(StopAsyncIteration):
            await anext(branches)

    in_a_loop(test)


def test_the_event_loop_goes_on(coordinator, run):
    async def test() -> None:
        branches = run.afollow()
        waiting = asyncio.ensure_future(anext(branches))
        # The loop turns again and again while nothing is found.
        for _ in range(200):
            await asyncio.sleep(0.001)
        assert not waiting.done()
        task = coordinator.add(points=2000)
        assert (await waiting).task == task
        await branches.aclose()

    in_a_loop(test)


def test_a_wait_that_is_cancelled_loses_nothing(coordinator, run):
    async def test() -> None:
        branches = run.afollow()
        tasks = [coordinator.add()]
        assert await take(branches, 1) == tasks
        for number in range(20):
            # Some waits are cancelled before, some after the branch is there.
            waiting = asyncio.ensure_future(anext(branches))
            await asyncio.sleep(0)
            task = coordinator.add()
            for _ in range(number):
                await asyncio.sleep(0.001)
            waiting.cancel()
            try:
                found = (await waiting).task
            except asyncio.CancelledError:
                found = (await anext(branches)).task
            assert found == task
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(anext(branches), 0.05)
        task = coordinator.add()
        coordinator.stage = "finished"
        assert [branch.task async for branch in branches] == [task]

    in_a_loop(test)


def test_a_wait_goes_on_in_another_loop(coordinator, run):
    branches = run.afollow()

    async def leave() -> None:
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(anext(branches), 0.05)

    asyncio.run(leave())
    task = coordinator.add()
    coordinator.stage = "finished"

    async def test() -> None:
        assert [branch.task async for branch in branches] == [task]

    in_a_loop(test)


def test_tasks_that_share_the_branches(coordinator, run):
    async def test() -> None:
        tasks = [coordinator.add() for _ in range(10)]
        coordinator.stage = "finished"
        branches = run.afollow()

        async def some() -> list[str]:
            return [branch.task async for branch in branches]

        shares = await asyncio.gather(*(some() for _ in range(3)))
        assert sorted(task for share in shares for task in share) == sorted(tasks)

    in_a_loop(test)


def test_leaving_early(coordinator, run):
    async def test() -> None:
        coordinator.add()
        coordinator.add()
        async with run.afollow() as branches:
            assert (await anext(branches)).name == "main"
        with pytest.raises(StopAsyncIteration):
            await anext(branches)
        # Also while somebody waits for the next one.
        branches = run.afollow()
        await take(branches, 2)
        waiting = asyncio.ensure_future(take(branches, 1))
        await asyncio.sleep(0)
        await branches.aclose()
        await branches.aclose()
        for thread in threads():
            await asyncio.to_thread(thread.join, PATIENCE)
            assert not thread.is_alive()
        with pytest.raises((StopAsyncIteration, RuntimeError)):
            await waiting
        # Or without a word, or without having begun.
        async for _ in run.afollow():
            break
        await run.afollow().aclose()
        assert len(run.branches()) == 2

    in_a_loop(test)


def test_closing_the_connection_ends_it(coordinator):
    bus = isola_hbm.connect(coordinator.endpoint)
    run = bus.run()

    async def test() -> None:
        branches = run.afollow()
        coordinator.add()
        await anext(branches)
        waiting = asyncio.ensure_future(anext(branches))
        await asyncio.sleep(0)
        await asyncio.to_thread(bus.close)
        with pytest.raises(isola_hbm.NoAnswer, match="closed by this program"):
            await waiting

    in_a_loop(test)
    for late in (run.status, bus.runs, lambda: next(run.follow())):
        with pytest.raises(isola_hbm.NoAnswer, match="closed by this program"):
            late()


def test_a_blocking_reader_ends_with_the_connection(coordinator):
    bus = isola_hbm.connect(coordinator.endpoint)
    task = coordinator.add()
    first, ended, found = threading.Event(), threading.Event(), []

    def read() -> None:
        try:
            for branch in bus.run().follow():
                found.append(branch.task)
                first.set()
        except isola_hbm.NoAnswer as error:
            found.append(str(error))
        ended.set()

    threading.Thread(target=read, daemon=True).start()
    assert first.wait(PATIENCE)
    bus.close()
    assert ended.wait(PATIENCE)
    assert found == [task, "the connection was closed by this program"]


def test_wrong_bytes_are_noticed(coordinator, run):
    task = coordinator.add()
    done, result = coordinator.store[task]
    coordinator.store[task] = (done, result.replace(b"host-77", b"host-78"))

    async def test() -> None:
        branches = run.afollow()
        with pytest.raises(isola_hbm.Corrupt, match="SHA-256 differs"):
            await anext(branches)
        with pytest.raises(StopAsyncIteration):
            await anext(branches)

    in_a_loop(test)
