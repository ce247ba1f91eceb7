"""Chains of descriptors, interrupts of rows and blocks, and autobuffer: memory DMA beyond one work unit."""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest
from numpy.typing import NDArray

from bfsim.api import Core, Frame
from bfsim.chip.dma_registers import ELEMENT_BYTES, Flow
from bfsim.errors import DeadlockError
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.simulation import Simulation
from bfsim.trace import BoardRecord
from tests.machine.kernels import spin
from tests.machine.made_boards import assert_accounted, cclk_now, in_work, play
from tests.machine.rig import Play, every_frame
from tests.machine.stream_rig import (
    MORE,
    NBYTES,
    READ,
    SECTIONS,
    WRITE,
    Registers,
    chain,
    each_path,
    linear,
    noise,
    on_chip_cclk,
)


def now_cclk(core: Core) -> int:
    """Return the simulated time, which the core's own clock may not have reached."""
    return core._parts.shared._env.tick // core._parts.clock.cclk_ticks


def run_chain(
    flow: Flow, memory: str, units: int, words: int
) -> tuple[list[NDArray[np.uint8]], int, int, BoardRecord]:
    """Gather `units` pieces, last first, by descriptors in `memory`; return what arrived, and when it was posted and done."""
    arrived: list[NDArray[np.uint8]] = []
    times: list[int] = []

    def work(core: Core, frame: Frame) -> Play:
        here, there, descriptors = core.array("from_L1"), core.array("to_L1"), core.array(f"chain_{memory}")
        here.array[:] = noise()
        step = 4 * words
        pieces = [linear(here.address + (units - 1 - number) * step, words) for number in range(units)]
        targets = [linear(there.address + number * step, words) for number in range(units)]
        source = chain(flow, descriptors.address, pieces)
        second = descriptors.address + 2 * len(source)
        written = source + chain(flow, second, targets, WNR=True, DI_EN=True)
        descriptors.array[: len(written)] = written
        pointer = "CURR_DESC_PTR" if flow is Flow.ARRAY else "NEXT_DESC_PTR"
        dma = core.memory_dma("MDMA1_1")
        dma.program(source={pointer: descriptors.address}, destination={pointer: second})
        size = len(source) // units
        core.on_interrupt("MDMA1_1", lambda core: None)
        yield from dma.start(
            DmaConfig(FLOW=flow, NDSIZE=size), DmaConfig(FLOW=flow, NDSIZE=size, WNR=True, DI_EN=True)
        )
        times.append(cclk_now(core))
        dma.done.callbacks.append(lambda _: times.append(now_cclk(core)))
        yield from dma.wait()
        arrived.append(there.array.copy())

    outcome = play(every_frame(work), more=MORE)
    return arrived, *times, outcome


@pytest.mark.parametrize("memory", SECTIONS)
@pytest.mark.parametrize(("flow", "elements"), [(Flow.ARRAY, 5), (Flow.SMALL, 6), (Flow.LARGE, 7)])
def test_a_chain_of_descriptors_gathers_pieces(flow: Flow, elements: int, memory: str) -> None:
    """Arrays and lists, wherever they lie: the pieces arrive in the order of the descriptors, an interrupt each.

    Every work unit is started anew, and costs its two descriptors, element by element: words of the memory that has them.
    """
    units, words = 4, 16
    arrived, posted, done, outcome = run_chain(flow, memory, units, words)
    pieces = noise()[: 4 * units * words].reshape(units, -1)[::-1].ravel()
    np.testing.assert_array_equal(arrived[0][: len(pieces)], pieces)
    assert outcome.interrupts == {"A MDMA1_1": units}
    fetched_nbytes = units * 2 * elements * ELEMENT_BYTES
    if memory != "SDRAM":
        assert done - posted == on_chip_cclk(units, words, 2 * elements, posted)
    else:
        assert done - posted > on_chip_cclk(units, words, 2 * elements, posted)
    read_nbytes = {
        each.memory: each.read_bytes
        for each in outcome.traffic
        if each.master == "MDMA1 stream 1" and each.memory in ("L2", "SDRAM")
    }
    assert read_nbytes == ({} if memory == "L1" else {memory: fetched_nbytes})


# ---- autobuffer and interrupts


def counting(
    config: DmaConfig, registers: Registers, source: str, target: str, until: int
) -> tuple[int, BoardRecord]:
    """Start a stream and idle until `until` of its interrupts were taken; return the words that had come at the first."""
    seen: list[int] = []

    def work(core: Core, frame: Frame) -> Play:
        here, there = core.array(f"from_{source}"), core.array(f"to_{target}")
        here.array[:] = 255
        core.on_interrupt("MDMA1_0", lambda core: seen.append(np.count_nonzero(there.array)))
        dma = core.memory_dma("MDMA1_0")
        dma.program(
            source=linear(here.address, 128),
            destination={"START_ADDR": there.address, "X_MODIFY": 4, **registers},
        )
        yield from dma.start(READ, config)
        while len(seen) < until:
            yield from core.idle()
        yield from dma.wait()

    outcome = play(in_work(work), more=MORE)
    assert_accounted(outcome)
    return seen[0], outcome


ROWS = {"X_COUNT": 32, "Y_COUNT": 4, "Y_MODIFY": 4}
rows_of = pytest.mark.parametrize(
    ("source", "target"),
    [
        ("SDRAM", "L1"), ("L1", "SDRAM"), ("SDRAM", "L2"), ("SDRAM", "SDRAM"),
        ("L1", "L2"),
    ],
)  # fmt: skip


@rows_of
def test_an_interrupt_for_each_row(source: str, target: str) -> None:
    """DI_SEL: four of them, the first when its row is there and the others are not."""
    config = DmaConfig(WNR=True, DMA2D=True, DI_EN=True, DI_SEL=True)
    arrived, outcome = counting(config, ROWS, source, target, until=4)
    assert outcome.interrupts == {"A MDMA1_0": 4}
    assert 128 <= arrived < 256


@each_path
def test_one_interrupt_for_a_block(source: str, target: str) -> None:
    """Without DI_SEL: when all of it is there."""
    config = DmaConfig(WNR=True, DMA2D=True, DI_EN=True)
    arrived, outcome = counting(config, ROWS, source, target, until=1)
    assert outcome.interrupts == {"A MDMA1_0": 1}
    assert arrived == NBYTES


def test_without_di_en_there_is_none() -> None:
    """The handler is never called; the words come all the same."""
    handled = []

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("MDMA1_0", handled.append)
        dma = core.memory_dma("MDMA1_0")
        here, there = core.array("from_SDRAM"), core.array("to_L1")
        dma.program(source=linear(here.address, 64), destination=linear(there.address, 64))
        yield from dma.start(READ, WRITE)
        yield from dma.wait()

    assert play(every_frame(work), more=MORE).interrupts == {}
    assert handled == []


def test_the_interrupt_goes_to_the_core_that_programmed_the_stream() -> None:
    """Core B has a handler, too, but not the stream."""

    def attach(core: Core, frame: Frame) -> Play:
        core.on_interrupt("MDMA1_0", lambda core: None)
        if core.name == "A":
            dma = core.memory_dma("MDMA1_0")
            here, there = core.array("from_SDRAM"), core.array("to_L1")
            dma.program(source=linear(here.address, 64), destination=linear(there.address, 64))
            yield from dma.start(READ, DmaConfig(WNR=True, DI_EN=True))
            yield from dma.wait()

    assert play(every_frame(attach), every_frame(attach), more=MORE).interrupts == {"A MDMA1_0": 1}


def test_autobuffer_goes_on_until_it_is_stopped() -> None:
    """The same block again and again, started anew each time, until the handler of the third one stops it."""
    times: list[int] = []

    def handler(core: Core) -> None:
        times.append(now_cclk(core))
        if len(times) == 4:  # the start, and three blocks
            core.memory_dma("MDMA1_0").stop()

    def work(core: Core, frame: Frame) -> Play:
        core.on_interrupt("MDMA1_0", handler)
        dma = core.memory_dma("MDMA1_0")
        here, there = core.array("from_L1"), core.array("to_L2")
        dma.program(source=linear(here.address, 100), destination=linear(there.address, 100))
        yield from dma.start(DmaConfig(FLOW=Flow.AUTO), DmaConfig(FLOW=Flow.AUTO, WNR=True, DI_EN=True))
        times.append(cclk_now(core))
        yield from dma.wait()
        yield core.run(spin, 1)

    outcome = play(in_work(work), more=MORE)
    posted, *ends = times
    assert [each - posted for each in ends] == [on_chip_cclk(units, 100, 0, posted) for units in (1, 2, 3, 4)]
    assert outcome.interrupts == {"A MDMA1_0": 4}, "the block under way is moved to its end"
    assert_accounted(outcome)


def test_a_stopped_stream_can_be_started_again() -> None:
    """The second programming is as good as the first."""
    runs = []

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("MDMA1_0")
        here, there = core.array("from_L1"), core.array("to_L2")
        auto = DmaConfig(FLOW=Flow.AUTO), DmaConfig(FLOW=Flow.AUTO, WNR=True)
        for flow in (auto, (READ, WRITE)):
            dma.program(source=linear(here.address, 10), destination=linear(there.address, 10))
            yield from dma.start(*flow)
            if flow is auto:
                yield core.run(spin, 1000)
                dma.stop()
            yield from dma.wait()
            runs.append((dma.source.running, dma.destination.running))

    play(every_frame(work), more=MORE)
    assert runs == [(False, False)] * 2


def test_a_deadlock_is_told_while_a_stream_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """Autobuffer without interrupts: nothing it does can wake the core."""
    steps = count()
    step = Simulation.step

    def counted(self: Simulation) -> None:
        assert next(steps) < 10_000, "the simulation goes on for ever"
        step(self)

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("MDMA1_0")
        here, there = core.array("from_L1"), core.array("to_L2")
        dma.program(source=linear(here.address, 100), destination=linear(there.address, 100))
        yield from dma.start(DmaConfig(FLOW=Flow.AUTO), DmaConfig(FLOW=Flow.AUTO, WNR=True))
        yield from core.wait("never")

    monkeypatch.setattr(Simulation, "step", counted)
    with pytest.raises(DeadlockError, match="core A waits for semaphore 'never'"):
        play(every_frame(work), more=MORE)
