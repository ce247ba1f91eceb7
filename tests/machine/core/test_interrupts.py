"""Interrupts: when a core takes them, in which order, and what the way in and out costs."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Core, Frame
from bfsim.chip.interrupts import Bf561Interrupt
from bfsim.errors import DeadlockError, FirmwareError
from bfsim.trace import StallReason
from tests.machine.kernels import spin, total
from tests.machine.made_boards import CHIP, assert_accounted, cclk_now, in_work
from tests.machine.rig import Play, cycles_of, every_frame, run, stage_of

ENTRY_CCLK, EXIT_CCLK = CHIP.events.interrupt_entry_cclk, CHIP.events.interrupt_exit_cclk
SOURCES = st.lists(st.sampled_from(Bf561Interrupt), min_size=1, max_size=8, unique=True)


def count(core: Core) -> None:
    """A handler that does nothing."""


async def count_later(core: Core) -> None:
    """No handler: nobody would await it."""


@pytest.mark.parametrize(("handler", "what"), [(7, "not 7"), (count_later, "not an `async` one")])
def test_a_handler_is_a_function(handler: Any, what: str) -> None:
    """A coroutine's was called, and nothing of it ran."""

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", handler)
        yield core.run(spin, 1)

    with pytest.raises(FirmwareError, match=rf"on_interrupt must get a function .* for TIMER0.*{what}"):
        run(every_frame(work))


def test_the_way_in_and_out_is_a_stall() -> None:
    """Between two calls: the kernels issue what they do without it, and entry and exit come on top."""

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", count)
        core.request_interrupt("TIMER0")
        yield core.run(spin, 100)
        yield core.run(spin, 30)

    outcome = run(in_work(work))
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.issue_cclk == cycles_of(spin, 100) + cycles_of(spin, 30)
    assert cost.stall_cclk == {StallReason.INTERRUPT: ENTRY_CCLK + EXIT_CCLK}
    assert outcome.interrupts == {"A TIMER0": 1}


def test_the_call_is_not_cut() -> None:
    """Asked for before a call, taken behind it."""
    began = []

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", lambda core: began.append(cclk_now(core)))
        core.request_interrupt("TIMER0")
        began.append(cclk_now(core))
        yield core.run(spin, 1000)
        began.append(cclk_now(core))

    run(every_frame(work))
    before, handled, after = began
    assert handled == before + cycles_of(spin, 1000) + ENTRY_CCLK
    assert after == handled + EXIT_CCLK


def test_a_handler_yields_kernels_as_a_main_loop_does() -> None:
    """Its work is issued where it was called, and its value comes back to it."""
    values = []

    def handler(core: Core) -> Play:
        values.append((yield core.run(spin, 50)))
        yield core.run(total, core.array("in_l2"))

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", handler)
        core.request_interrupt("TIMER0")
        values.append((yield core.run(spin, 50)))

    outcome = run(in_work(work))
    cost = stage_of(outcome.frames[0], "Work")
    assert values[0] == values[1]
    kernels = {(each.stage, each.kernel): each for each in outcome.kernels}
    assert kernels["Work", "spin"].calls == 2
    assert cost.issue_cclk == 2 * cycles_of(spin, 50) + kernels["Work", "total"].issue_cclk
    assert cost.stall_cclk[StallReason.INTERRUPT] == ENTRY_CCLK + EXIT_CCLK
    assert_accounted(outcome)


@settings(max_examples=30)
@given(SOURCES)
def test_levels_decide_the_order_and_then_the_numbers(sources: list[Bf561Interrupt]) -> None:
    """However they were asked for: IVG7 first, and of one level the source with the lowest number."""
    taken: list[str] = []

    def work(core: Core, frame: Frame) -> Play:
        for each in sources:
            core.on_interrupt(each.name, lambda core, name=each.name: taken.append(name))
            core.request_interrupt(each.name)
        yield core.run(spin, 1)

    outcome = run(in_work(work))
    ordered = [each.name for each in sorted(sources, key=lambda each: (each.ivg, each.value))]
    assert taken == ordered
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.stall_cclk == {StallReason.INTERRUPT: len(sources) * (ENTRY_CCLK + EXIT_CCLK)}


def test_without_a_handler_it_is_masked() -> None:
    """Nothing is taken, and nothing is kept for a handler that comes later."""

    def work(core: Core, frame: Frame) -> Play:
        core.request_interrupt("TIMER0")
        yield core.run(spin, 10)
        core.on_interrupt("TIMER0", count)
        yield core.run(spin, 10)

    outcome = run(in_work(work))
    assert outcome.interrupts == {}
    assert stage_of(outcome.frames[0], "Work").stall_cclk == {}


def test_a_source_that_waits_already_is_not_counted_twice() -> None:
    """Two requests before the call ends are one interrupt; one after it is another."""

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", count)
        for _ in range(2):
            core.request_interrupt("TIMER0")
        yield core.run(spin, 10)
        core.request_interrupt("TIMER0")
        yield core.run(spin, 10)

    assert run(every_frame(work)).interrupts == {"A TIMER0": 2}


def nested(wait: Any) -> list[str]:
    """Let a handler ask for a higher interrupt before its kernel, and return what happened in which order."""
    happened: list[str] = []

    def handler(core: Core) -> Play:
        happened.append("low begins")
        core.request_interrupt("PLL_WAKEUP")
        yield core.run(spin, 10)
        happened.append("low ends")

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("WATCHDOG", handler)
        core.on_interrupt("PLL_WAKEUP", lambda core: happened.append("high"))
        core.request_interrupt("WATCHDOG")
        yield from wait(core)

    run(every_frame(work))
    return happened


@pytest.mark.parametrize("way", ["call", "idle"])
def test_handlers_are_not_interrupted(way: str) -> None:
    """An interrupt of a higher level waits until the handler is through, wherever that was called."""

    def wait(core: Core) -> Play:
        if way == "call":
            yield core.run(spin, 10)
        else:
            yield from core.idle()

    assert nested(wait) == ["low begins", "low ends", "high"]


def test_a_handler_that_asks_for_itself_runs_again() -> None:
    """The second time comes behind the first."""
    times = []

    def handler(core: Core) -> None:
        times.append(cclk_now(core))
        if len(times) == 1:
            core.request_interrupt("TIMER0")

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", handler)
        core.request_interrupt("TIMER0")
        yield core.run(spin, 10)

    run(every_frame(work))
    assert times[1] - times[0] == EXIT_CCLK + ENTRY_CCLK


@pytest.mark.parametrize("other", ["A", "C"])
def test_only_another_core_can_be_interrupted(other: str) -> None:
    """Not itself, and none that the chip does not have."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.interrupt_core(other)

    with pytest.raises(
        FirmwareError,
        match=f"core A can interrupt another core of the chip, not '{other}' .*test_interrupts.py:",
    ):
        run(every_frame(work))


def test_a_wrong_name_is_told_the_right_ones() -> None:
    """Attached or asked for: the message has the sources of the chip, and the firmware's line."""
    for name in ("on_interrupt", "request_interrupt"):

        def work(core: Core, frame: Frame, name: str = name) -> Play:
            getattr(core, name)(*["TIMER12", count][: 2 if name == "on_interrupt" else 1])
            yield core.run(spin, 1)

        with pytest.raises(
            FirmwareError,
            match="an interrupt must be one of PLL_WAKEUP, .*SUPPLEMENTAL_1, not 'TIMER12' .*test_interrupts",
        ):
            run(every_frame(work))


def test_an_idle_core_without_interrupts_is_told() -> None:
    """Nobody will ever wake it: what it waits for, and on which line."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.idle()

    with pytest.raises(
        DeadlockError, match="core A waits for an interrupt, since cycle .*test_interrupts.py:"
    ):
        run(every_frame(work))


def test_a_handler_that_waits_for_ever_is_told_with_its_own_line() -> None:
    """The deadlock is in the handler, not where it came between."""

    def handler(core: Core) -> Play:
        yield from core.wait("never")

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", handler)
        core.request_interrupt("TIMER0")
        yield core.run(spin, 10)

    line = handler.__code__.co_firstlineno + 1
    with pytest.raises(
        DeadlockError, match=f"core A waits for semaphore 'never', .*test_interrupts.py:{line}\\)"
    ):
        run(every_frame(work))


STEPS = st.lists(
    st.tuples(st.sampled_from(["spin", "sdram", "l2", "interrupt", "line", "self"]), st.integers(0, 300)),
    max_size=10,
)


def disturbed(steps: list[tuple[str, int]]) -> Any:
    """Make a main loop of random steps, with handlers that work too."""

    def handler(core: Core) -> Play:
        yield core.run(spin, 20)
        yield core.run(total, core.array("in_l2"))

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("SUPPLEMENTAL_0", handler)
        core.on_interrupt("TIMER0", handler)
        ring = core.input_ring(frame.rows, "in_ring")
        for number, (kind, turns) in enumerate(steps):
            if kind == "spin":
                yield core.run(spin, turns)
            elif kind == "interrupt":
                yield from core.interrupt_core("B" if core.name == "A" else "A")
            elif kind == "self":
                core.request_interrupt("TIMER0")
            elif kind == "line":
                if number < frame.height:
                    yield from ring.line()
            else:
                yield core.run(total, core.array(f"in_{kind}"))

    return in_work(work)


@settings(max_examples=40)
@given(STEPS, STEPS)
def test_no_interrupt_loses_a_cycle(steps_a: list[tuple[str, int]], steps_b: list[tuple[str, int]]) -> None:
    """issue + stall + idle = elapsed, whatever the cores do to each other."""
    outcome = run(disturbed(steps_a), disturbed(steps_b), frames=2)
    assert_accounted(outcome)
    taken = sum(outcome.interrupts.values())
    stalls = [
        each.stall_cclk.get(StallReason.INTERRUPT, 0)
        for f in outcome.frames
        for c in f.cores
        for each in c.stages
    ]
    frames = 2 * len(outcome.frames)  # each picture is an interrupt, too
    assert sum(stalls) == (taken + frames) * (ENTRY_CCLK + EXIT_CCLK)
