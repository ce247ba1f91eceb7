"""Interrupts of a core that waits or is at work: when they are taken."""

from __future__ import annotations

import pytest

from bfsim.api import Core, Frame
from bfsim.trace import StallReason
from tests.machine.kernels import spin, total
from tests.machine.made_boards import CHIP, assert_accounted, cclk_now, in_work
from tests.machine.naive_port import LOCKED_CCLK
from tests.machine.rig import Play, cycles_of, every_frame, run, stage_of

ENTRY_CCLK, EXIT_CCLK = CHIP.events.interrupt_entry_cclk, CHIP.events.interrupt_exit_cclk


@pytest.mark.parametrize("turns", [0, 10, 1000, 100_000])
def test_idle_lasts_until_the_interrupt(turns: int) -> None:
    """B works and interrupts A, which has nothing to do: idle to the request, then entry, handler and exit."""
    handled = []

    def wait(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SUPPLEMENTAL_0", lambda core: handled.append(cclk_now(core)))
        handled.append(cclk_now(core))
        yield from core.idle()
        handled.append(cclk_now(core))

    def interrupt(core: Core, frame: Frame) -> Play:
        yield core.run(spin, turns)
        yield from core.interrupt_core("A")

    outcome = run(in_work(wait), in_work(interrupt))
    idle_cclk = cycles_of(spin, turns) + CHIP.events.mmr_write_cclk
    (frame,) = outcome.frames
    assert stage_of(frame, "Work", "B").elapsed_cclk == idle_cclk
    assert stage_of(frame, "Work").idle_cclk == idle_cclk
    assert stage_of(frame, "Work").stall_cclk == {StallReason.INTERRUPT: ENTRY_CCLK + EXIT_CCLK}
    before, at, after = handled
    assert (at - before, after - at) == (idle_cclk + ENTRY_CCLK, EXIT_CCLK)
    assert outcome.interrupts == {"A SUPPLEMENTAL_0": 1}
    assert_accounted(outcome)


def test_an_interrupt_before_idle_ends_it_at_once() -> None:
    """The request is kept; the core does not sleep over it."""

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", lambda core: None)
        core.request_interrupt("TIMER0")
        yield from core.idle()

    cost = stage_of(run(in_work(work)).frames[0], "Work")
    assert (cost.idle_cclk, cost.elapsed_cclk) == (0, ENTRY_CCLK + EXIT_CCLK)


def test_an_interrupt_during_a_call_outside_l1_is_taken_behind_it() -> None:
    """B interrupts A in the middle of a call that reads SDRAM word by word."""
    handled = []

    def read(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SUPPLEMENTAL_0", lambda core: handled.append(cclk_now(core)))
        yield core.run(total, core.array("in_sdram"))
        handled.append(cclk_now(core))

    def interrupt(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 100)
        yield from core.interrupt_core("A")

    outcome = run(in_work(read), in_work(interrupt))
    at, after = handled
    assert after == at + EXIT_CCLK
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.stall_cclk[StallReason.INTERRUPT] == ENTRY_CCLK + EXIT_CCLK
    assert cost.elapsed_cclk > cycles_of(spin, 100) + 1000, "the call goes on for long after the request"


def test_calls_in_l1_are_interrupted_between_two_of_them() -> None:
    """A hundred calls that meet no other device: the handler runs behind the one in which B asks for it."""
    handled = []

    def compute(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SUPPLEMENTAL_0", lambda core: handled.append(cclk_now(core)))
        handled.append(cclk_now(core))
        for _ in range(100):
            yield core.run(spin, 100)
        yield from core.post("through")

    def interrupt(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)
        yield from core.interrupt_core("A")

    run(every_frame(compute), every_frame(interrupt))
    before, at = handled
    asked_cclk = cycles_of(spin, 1000) + CHIP.events.mmr_write_cclk
    assert asked_cclk <= at - before - ENTRY_CCLK < asked_cclk + cycles_of(spin, 100)


def test_a_handler_ends_the_wait_of_its_own_core() -> None:
    """The usual way of a DMA's interrupt: the handler posts the semaphore that the main loop waits for."""

    def post(core: Core) -> Play:
        yield from core.post("line")

    def wait(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SUPPLEMENTAL_0", post)
        yield from core.wait("line")

    def interrupt(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)
        yield from core.interrupt_core("A")

    outcome = run(every_frame(wait), every_frame(interrupt))
    assert outcome.interrupts == {"A SUPPLEMENTAL_0": 1}


def test_during_a_wait_it_is_taken_when_it_comes() -> None:
    """A waits for a semaphore; B interrupts it on the way to posting that."""
    handled = []

    def wait(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SUPPLEMENTAL_0", lambda core: handled.append(cclk_now(core)))
        handled.append(cclk_now(core))
        yield from core.wait("go")

    def interrupt(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)
        yield from core.interrupt_core("A")
        yield core.run(spin, 1000)
        yield from core.post("go")

    outcome = run(in_work(wait), in_work(interrupt))
    before, at = handled
    assert at - before == cycles_of(spin, 1000) + CHIP.events.mmr_write_cclk + ENTRY_CCLK
    (frame,) = outcome.frames
    # the last try of A comes right behind the TESTSET of B's post
    assert stage_of(frame, "Work").elapsed_cclk == stage_of(frame, "Work", "B").elapsed_cclk + LOCKED_CCLK
    assert_accounted(outcome)
