"""Spin locks: one core at a time, whole turns of waiting, and what is told of a lock that never comes."""

from __future__ import annotations

import itertools
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Core, Frame, i32, kernel
from bfsim.errors import DeadlockError, FirmwareError
from bfsim.machine.board import Fidelity
from bfsim.machine.program import Main
from bfsim.trace import StallReason
from tests.machine.kernels import spin
from tests.machine.made_boards import CHIP, assert_accounted, cclk_now, in_work, play
from tests.machine.naive_port import BETWEEN_CCLK, LOCKED_CCLK, TESTSET_CCLK, store_against_spin
from tests.machine.rig import Play, cycles_of, every_frame, run, stage_of

UNLOCK_CCLK = 1


@kernel
def load(words: i32[:]) -> i32:
    return words[0]


@kernel
def store(words: i32[:], value: i32):
    words[0] = value


def test_a_free_lock_costs_one_testset() -> None:
    """Two issue cycles, a read and a write of L2; giving it back is a store."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.lock("word")
        yield from core.unlock("word")

    outcome = run(in_work(work))
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.issue_cclk == CHIP.events.testset_cclk + UNLOCK_CCLK
    assert cost.stall_cclk == {StallReason.L2_LATENCY: LOCKED_CCLK}
    assert_accounted(outcome)


def holding(turns: int) -> Main:
    """Make core A's main loop: the lock is taken at once and given back after so many turns of work."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.lock("word")
        yield core.run(spin, turns)
        yield from core.unlock("word")

    return in_work(work)


def coming(turns: int) -> Main:
    """Make core B's main loop: the lock is asked for after so many turns of work."""

    def wait(core: Core, frame: Frame) -> Play:
        yield core.run(spin, turns)
        with core.stage("Work"):
            yield from core.lock("word")
        yield from core.unlock("word")

    return every_frame(wait)


def phase_of(turns: int, turns_of_b: int, **how: Any) -> int:
    """Check when B has a lock that A holds for so many turns; return how far into a turn of B's A's store asks, in CCLK."""
    outcome = play(holding(turns), coming(turns_of_b), **how)
    asked_cclk = cycles_of(spin, turns_of_b)
    granted_cclk = max(asked_cclk + CHIP.events.testset_cclk, TESTSET_CCLK)  # A's first TESTSET had the port
    first_try_cclk = granted_cclk + LOCKED_CCLK
    store_cclk = TESTSET_CCLK + cycles_of(spin, turns)
    won_cclk = first_try_cclk
    if first_try_cclk <= store_cclk:
        won_cclk = store_against_spin(first_try_cclk, store_cclk)
    cost = stage_of(outcome.frames[0], "Work", "B")
    assert cost.stall_cclk.get(StallReason.SEMAPHORE, 0) == won_cclk - first_try_cclk
    assert cost.elapsed_cclk == won_cclk - asked_cclk
    assert_accounted(outcome)
    return (store_cclk - first_try_cclk) % (LOCKED_CCLK + BETWEEN_CCLK)


@pytest.mark.parametrize("turns", [0, 1, 2, 3, 5, 10, 1000])
def test_a_core_that_spins_has_the_lock_at_its_first_try_after_the_other_gave_it_back(turns: int) -> None:
    """B comes while A has the lock, and tries again every turn; its tries and A's store meet at the port of L2."""
    phase_of(turns, 0)


@pytest.mark.parametrize("fidelity", Fidelity)
def test_wherever_in_a_turn_the_lock_is_given_back(fidelity: Fidelity) -> None:
    """In no cycle of B's turn does a try win that had the port before A's store, or lose that had it after."""
    turn_cclk = LOCKED_CCLK + BETWEEN_CCLK
    phases = {phase_of(100 + more, 0, fidelity=fidelity) for more in range(turn_cclk)}
    assert phases == set(range(turn_cclk))


@settings(max_examples=25)
@given(st.integers(0, 60), st.integers(0, 60))
def test_whoever_comes_when_and_however_long_it_is_kept(turns: int, turns_of_b: int) -> None:
    """As above, also where B comes when the lock is free again, or just then."""
    phase_of(turns, turns_of_b)


@settings(max_examples=25)
@given(st.lists(st.integers(0, 60), max_size=8), st.lists(st.integers(0, 60), max_size=8))
def test_no_increment_is_lost(pauses_a: list[int], pauses_b: list[int]) -> None:
    """Both cores load a word of L2, wait and store it back greater by one: under the lock all of them count."""
    inside: list[tuple[int, int]] = []
    last = []

    def counting(pauses: list[int]) -> Any:
        def count(core: Core, frame: Frame) -> Play:
            for pause in pauses:
                yield core.run(spin, pause)
                yield from core.lock("word")
                begin = cclk_now(core)
                value = yield core.run(load, core.array("in_l2"))
                yield core.run(spin, pause)
                yield core.run(store, core.array("in_l2"), value + 1)
                inside.append((begin, cclk_now(core)))
                last.append(value + 1)
                yield from core.unlock("word")

        return every_frame(count)

    outcome = run(counting(pauses_a), counting(pauses_b))
    both = len(pauses_a) + len(pauses_b)
    assert last == list(range(1, both + 1))
    inside.sort()
    assert all(before[1] <= after[0] for before, after in itertools.pairwise(inside))
    assert_accounted(outcome)


def test_two_locks_do_not_disturb_each_other() -> None:
    """Each core has its own: nobody waits."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.lock(core.name)
        yield core.run(spin, 1000)
        yield from core.unlock(core.name)

    (frame,) = run(in_work(work), in_work(work)).frames
    for core in ("A", "B"):
        assert StallReason.SEMAPHORE not in stage_of(frame, "Work", core).stall_cclk


def test_taking_a_lock_twice_is_an_error() -> None:
    """It would spin for ever on itself."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.lock("word")
        yield from core.lock("word")

    with pytest.raises(
        FirmwareError,
        match=r"core A must not take lock 'word' again: it holds it already \(.*test_spin_lock.py:",
    ):
        run(every_frame(work))


def give_back(core: Core, frame: Frame) -> Play:
    """Unlock what was never locked, or another core has."""
    yield core.run(spin, 100)
    yield from core.unlock("word")


def test_giving_back_what_nobody_holds_is_an_error() -> None:
    """The lock is free."""
    with pytest.raises(
        FirmwareError,
        match=r"core A must not give lock 'word' back, which nobody holds \(.*test_spin_lock.py:",
    ):
        run(every_frame(give_back))


def test_giving_back_what_the_other_core_holds_is_an_error() -> None:
    """Who holds it, since when, and from which line."""

    def hold(core: Core, frame: Frame) -> Play:
        yield from core.lock("word")
        yield core.run(spin, 10_000)
        yield from core.unlock("word")

    with pytest.raises(
        FirmwareError,
        match=r"core B must not give lock 'word' back, which core A since cycle [\d,]+ \(.*test_spin_lock.py:\d+\) holds",
    ):
        run(every_frame(hold), every_frame(give_back))


def taking(first: str, second: str) -> Any:
    """Make a main loop that takes two locks, works in between, and gives none back in time."""

    def take(core: Core, frame: Frame) -> Play:
        yield from core.lock(first)
        yield core.run(spin, 1000)
        yield from core.lock(second)
        yield from core.unlock(second)
        yield from core.unlock(first)

    return every_frame(take)


def test_two_locks_in_opposite_order_are_told_with_their_holders() -> None:
    """Who waits for what, since when, where; and who holds it, since when, where: for both cores."""
    with pytest.raises(DeadlockError) as caught:
        run(taking("left", "right"), taking("right", "left"))
    line = taking.__code__.co_firstlineno + 4
    taken, waited = f"({__file__}:{line})", f"({__file__}:{line + 2})"
    core_a, core_b = str(caught.value).removeprefix("nothing can happen any more: ").split("; ")
    # of the two first TESTSETs, B's waits until A's gives the port back
    for told, core, other, name, later_cclk in (
        (core_a, "A", "B", "right", -LOCKED_CCLK),
        (core_b, "B", "A", "left", LOCKED_CCLK),
    ):
        begin, _, rest = told.partition(
            f"core {core} waits for lock {name!r}, held by core {other} since cycle "
        )
        assert begin == ""
        held, _, rest = rest.partition(f" {taken}, since cycle ")
        since, _, rest = rest.partition(f" {waited}")
        assert rest == ""
        held_cclk, since_cclk = (int(each.replace(",", "")) for each in (held, since))
        assert since_cclk - held_cclk == cycles_of(spin, 1000) + TESTSET_CCLK + later_cclk


def test_the_same_order_is_no_deadlock() -> None:
    """Whoever comes second waits at the first lock, and both get through."""
    outcome = run(taking("left", "right"), taking("left", "right"))
    assert len(outcome.frames) == 1


def test_a_lock_that_is_kept_is_told() -> None:
    """Core A ends its frame with the lock; core B waits for ever."""

    def keep(core: Core, frame: Frame) -> Play:
        if frame.index == 0:
            yield from core.lock("word")

    with pytest.raises(
        DeadlockError,
        match=r"core A waits for .*; core B waits for lock 'word', held by core A since cycle [\d,]+ \(.*\), since",
    ):
        run(every_frame(keep), taking("word", "other"), frames=5)
