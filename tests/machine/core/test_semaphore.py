"""Semaphores: how the cores wait for each other, and what happens when that can never end."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from bfsim.api import Core, Frame
from bfsim.chip.boards import board_named
from bfsim.errors import DeadlockError
from bfsim.machine.core.synchronisation.semaphore import Semaphore
from bfsim.machine.simulation import Simulation
from bfsim.trace import REST, StallReason
from tests.machine.kernels import spin
from tests.machine.made_boards import noise
from tests.machine.naive_port import BETWEEN_CCLK, LOCKED_CCLK, TESTSET_CCLK, post_against_spin
from tests.machine.rig import Play, cycles_of, every_frame, load, run, see_all, stage_of

CHIP = board_named("cm-bf561").chip


TURN_CCLK = LOCKED_CCLK + BETWEEN_CCLK


def test_counts_and_serves_in_order() -> None:
    """Posts are kept for those who come later; waiters go on in the order in which they came."""
    env = Simulation()
    semaphore = Semaphore(env, "lines")
    semaphore.post()
    semaphore.post()
    assert semaphore.take() is None
    assert semaphore.take() is None
    first, second = semaphore.take(), semaphore.take()
    assert first is not None
    assert second is not None
    semaphore.post()
    assert (first.triggered, second.triggered) == (True, False)
    semaphore.post()
    assert second.triggered
    third = semaphore.take()
    assert third is not None
    assert not third.triggered


@pytest.mark.parametrize("turns", [1000, 1001, 1002, 1003])
def test_the_wait_is_a_stall_from_the_call_to_the_first_try_after_the_other_core_s_post(turns: int) -> None:
    """A works for so long and posts; B tries again and again, and each try keeps A's own TESTSET from the port of L2."""

    def post(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield core.run(spin, turns)
            yield from core.post("go")

    def wait(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield from core.wait("go")

    (frame,) = run(every_frame(post), every_frame(wait)).frames
    posting, waiting = (stage_of(frame, "Work", core) for core in ("A", "B"))
    asked_cclk = cycles_of(spin, turns) + CHIP.events.testset_cclk
    posted_cclk, won_cclk = post_against_spin(TESTSET_CCLK, asked_cclk)
    assert posting.elapsed_cclk == posted_cclk
    port_cclk = posted_cclk - LOCKED_CCLK - asked_cclk
    assert posting.stall_cclk.get(StallReason.L2_PORT, 0) == port_cclk
    semaphore_cclk = won_cclk - TESTSET_CCLK
    assert waiting.stall_cclk == {StallReason.L2_LATENCY: LOCKED_CCLK, StallReason.SEMAPHORE: semaphore_cclk}


def test_what_was_posted_before_needs_no_wait() -> None:
    """Only the access itself: two issue cycles and the way to L2."""

    def post(core: Core, frame: Frame) -> Play:
        yield from core.post("go")

    def wait(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)
        with core.stage("Work"):
            yield from core.wait("go")

    (frame,) = run(every_frame(post), every_frame(wait)).frames
    assert stage_of(frame, "Work", "B").elapsed_cclk == TESTSET_CCLK
    assert stage_of(frame, "Work", "B").stall_cclk == {StallReason.L2_LATENCY: LOCKED_CCLK}


@pytest.mark.parametrize("turns", range(0, 60, 7))
def test_it_does_not_matter_who_comes_first(turns: int) -> None:
    """Work before the post from nothing to longer than an access: the wait is the difference, and two turns of the loop at most."""

    def post(core: Core, frame: Frame) -> Play:
        yield core.run(spin, turns)
        yield from core.post("go")

    def wait(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 28)
        yield from core.wait("go")

    early, late = cycles_of(spin, turns), cycles_of(spin, 28)
    most_cclk = 2 * TURN_CCLK if early >= late else 0
    for mains, waiter in (((post, wait), "B"), ((wait, post), "A")):
        (frame,) = run(*map(every_frame, mains)).frames
        waited_cclk = stage_of(frame, REST, waiter).stall_cclk.get(StallReason.SEMAPHORE, 0)
        assert max(0, early - late) <= waited_cclk <= max(0, early - late) + most_cclk


def test_a_core_may_be_posted_ahead() -> None:
    """A posts three times at once; B takes them one a frame and never waits."""

    def post(core: Core, frame: Frame) -> Play:
        for _ in range(3 if frame.index == 0 else 0):
            yield from core.post("lines")

    def wait(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 100)
        yield from core.wait("lines")

    outcome = run(every_frame(post), every_frame(wait), frames=3)
    assert all(StallReason.SEMAPHORE not in stage_of(each, REST, "B").stall_cclk for each in outcome.frames)


def waiting_for(name: str) -> Any:
    """Make a main loop that waits for one semaphore in each frame."""

    def body(core: Core, frame: Frame) -> Play:
        yield from core.wait(name)

    return every_frame(body)


def test_two_cores_waiting_for_each_other_are_told_both_waits() -> None:
    """Who waits for what, since when, and on which line of the firmware: for both cores."""
    with pytest.raises(
        DeadlockError,
        match=r"core A waits for semaphore 'B is done', since cycle [\d,]+ \(.*test_semaphore\.py:\d+\); "
        r"core B waits for semaphore 'A is done', since cycle [\d,]+ \(.*test_semaphore\.py:\d+\)",
    ) as caught:
        run(waiting_for("B is done"), waiting_for("A is done"))
    line = waiting_for.__code__.co_firstlineno + 4
    assert str(caught.value).count(f"{__file__}:{line}") == 2


def test_a_core_that_waits_for_one_that_has_ended_is_told() -> None:
    """Core B's main loop returns at once; what A waits for can never come."""

    def end(core: Core) -> Play:
        yield from ()

    with pytest.raises(DeadlockError, match="core A waits for semaphore 'go', .*; core B has ended"):
        run(waiting_for("go"), end)


def test_a_semaphore_with_another_name_is_told() -> None:
    """B posts `going` where A waits for `go`: both stand there, and nothing said why."""

    def post(core: Core, frame: Frame) -> Play:
        yield from core.post("going")
        yield from core.wait("back")

    with pytest.raises(DeadlockError, match="; semaphore 'going' was posted, but nobody has waited for it$"):
        run(waiting_for("go"), every_frame(post))


def test_a_core_that_has_not_begun_has_not_ended() -> None:
    """Where semaphores cost nothing, A waits before B has had its first turn."""

    def post(core: Core) -> Play:
        yield from core.post("go")
        yield from see_all(core)

    def wait(core: Core) -> Play:
        yield from core.wait("go")
        yield from see_all(core)

    board = load(wait, post)
    chip = board.spec.chip
    assert chip.l2
    at_once = replace(chip, events=replace(chip.events, testset_cclk=0), l2=replace(chip.l2, read_cclk=0))
    board = replace(board, spec=replace(board.spec, chip=at_once))
    assert len(board.run(noise(2, board.size)).frames) == 2


def test_a_core_that_ends_early_keeps_its_pair_of_pictures() -> None:
    """Core B never gives its pictures back, so the frame buffers run out and A waits for ever."""

    def once(core: Core) -> Play:
        yield from core.next_frame()

    with pytest.raises(DeadlockError, match="core A waits for the next picture, since .*; core B has ended"):
        run(every_frame(lambda core, frame: iter(())), once, frames=5)
