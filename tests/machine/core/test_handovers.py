"""Buffers that the cores hand over: calls on them are done ahead, with the cycles of calls that are not, and only in turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from bfsim.api import BudgetRow, Buffer, Core, Firmware, Frame, FrameSize, i32
from bfsim.errors import FirmwareError
from bfsim.machine.core.synchronisation.handovers import Handovers
from bfsim.trace import BoardRecord
from tests.machine.kernels import fill, spin, total
from tests.machine.rig import SIZE, Play, board_of, buffers, every_frame, noise

CALLS = 40


def work(core: Core, cycles: int) -> Play:
    """Work on the buffer with many calls, each as long as core A's pictures are bright."""
    row = core.array("in_turns")
    for number in range(CALLS):
        yield core.run(fill, row, cycles + number)
        yield core.run(spin, cycles)
        core.publish(found=(yield core.run(total, row)))


def by_semaphores(core: Core, frame: Frame) -> Play:
    """First core A works on it, then core B, which waits for core A; core A waits for core B before it begins again."""
    if core.name == "A":
        if frame.index:
            yield from core.wait("B is done")
        yield from work(core, 3)
        yield from core.post("A is done")
    else:
        yield from core.wait("A is done")
        yield from work(core, 5)
        yield from core.post("B is done")


def by_lock(core: Core, _frame: Frame) -> Play:
    """Whoever has the lock works on it."""
    yield core.run(spin, 10 if core.name == "A" else 4_000)
    yield from core.lock("of the buffer")
    yield from work(core, 4)
    yield from core.unlock("of the buffer")


def by_interrupt(core: Core, frame: Frame) -> Play:
    """Core A works on it in the first frame only, and core B in the handler of the interrupt that core A raises then."""
    if core.name == "A" and not frame.index:
        yield core.run(spin, 4_000)
        yield from work(core, 3)
        yield from core.interrupt_core("B")
    if core.name == "B" and not frame.index:
        core.on_interrupt("SUPPLEMENTAL_0", lambda core: work(core, 5))


def outcome(task, *, handed_over: bool = True, ahead: bool = True, frames: int = 3) -> BoardRecord:
    """Run a firmware whose cores do `task` with each frame; `handed_over`: whether the buffer is declared to be."""

    def more_buffers(size: FrameSize) -> dict[str, Sequence[Buffer]]:
        plain = buffers(size)
        shared = Buffer("in_turns", i32, 64, "l2_shared", handed_over=handed_over)
        return {**plain, "shared": (*plain["shared"], shared)}

    main = every_frame(task)
    firmware = Firmware(
        mains={"A": main, "B": main}, buffers=more_buffers, camera="camera", rows=(BudgetRow(stage="Work"),)
    )
    board = board_of(firmware, SIZE)
    board.ahead = board.ahead if ahead else None
    return board.run(noise(frames))


@pytest.mark.parametrize("task", [by_semaphores, by_lock, by_interrupt])
def test_a_buffer_in_turns_costs_what_it_costs_when_every_access_waits_for_its_cycle(task) -> None:
    """The same cycles, stalls and results as of a buffer that anybody may work on, and of cores that do not run ahead."""
    ahead = replace(outcome(task), events=0)
    assert ahead.frames
    assert ahead == replace(outcome(task, handed_over=False), events=0)
    assert ahead == replace(outcome(task, ahead=False), events=0)


def test_calls_on_it_wait_for_nobody() -> None:
    """An event for each call becomes some for each turn."""
    ahead, waiting = outcome(by_semaphores), outcome(by_semaphores, handed_over=False)
    assert waiting.events > 3 * 2 * 2 * CALLS
    assert ahead.events < waiting.events / 10


@pytest.mark.parametrize("waits", [False, True])
@pytest.mark.parametrize("ahead", [False, True])
def test_work_out_of_turn_ends_the_run(waits: bool, ahead: bool) -> None:
    """Core B waits for nothing, or for a post from before core A worked on it; whether the cores run ahead or not."""

    def task(core: Core, _frame: Frame) -> Play:
        if core.name == "A":
            yield from core.post("A has begun")
            yield from work(core, 3)
        else:
            yield core.run(spin, 2_000)
            if waits:
                yield from core.wait("A has begun")
            yield from work(core, 5)

    with pytest.raises(
        FirmwareError,
        match=r"core [AB] must not work on in_turns while core [AB] has it: .*test_handovers.py",
    ):
        outcome(task, ahead=ahead)
    outcome(task, handed_over=False)  # whose order the cycles decide


@pytest.mark.parametrize("ahead", [False, True])
def test_work_out_of_turn_ends_the_run_in_a_later_frame_too(ahead: bool) -> None:
    """Where the calls of both cores are known, and were in turn before."""

    def task(core: Core, frame: Frame) -> Play:
        if core.name == "B" and frame.index == 2:
            yield from work(core, 5)
        yield from by_semaphores(core, frame)

    assert len(outcome(task, ahead=ahead, frames=2).frames) == 2
    with pytest.raises(FirmwareError, match=r"must not work on in_turns while core [AB] has it"):
        outcome(task, ahead=ahead)


def test_what_no_other_core_has_is_not_handed_over() -> None:
    """A buffer of one core is refused before the run."""

    def own(size: FrameSize) -> dict[str, Sequence[Buffer]]:
        plain = buffers(size)
        return {**plain, "A": (*plain["A"], Buffer("mine", i32, 64, "L1_data_a", handed_over=True))}

    mains = {core: every_frame(by_lock) for core in "AB"}
    with pytest.raises(FirmwareError, match="buffer mine of A must not be handed over"):
        board_of(Firmware(mains=mains, buffers=own, camera="camera", rows=(BudgetRow(stage="Work"),)))


def test_who_was_told_by_whom_else_may_work_on_it() -> None:
    """Of three cores C hears of A's turn from B only."""
    cores = Handovers("ABC")
    cores.use("A", "row")
    cores.give("A", "one")
    cores.take("B", "one")
    cores.give("B", "two")
    with pytest.raises(FirmwareError, match="core C must not work on row while core A has it"):
        cores.use("C", "row")
    cores.take("C", "two")
    cores.use("C", "row")
    with pytest.raises(FirmwareError, match="core A must not work on row while core C has it"):
        cores.use("A", "row")


def test_what_was_given_away_before_is_not_given_away_again() -> None:
    """A post counts for what was done before it."""
    cores = Handovers("AB")
    cores.give("A", "one")
    cores.use("A", "row")
    cores.take("B", "one")
    with pytest.raises(FirmwareError):
        cores.use("B", "row")
