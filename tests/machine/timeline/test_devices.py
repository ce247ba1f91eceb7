"""What devices tell the timeline: transfers, camera lines, messages, semaphores, locks, rings and the load of the buses."""

from __future__ import annotations

from itertools import pairwise
from math import ceil

import pytest

from bfsim.api import Core, Frame
from bfsim.machine.board import Fidelity
from bfsim.machine.bus.told import SAMPLE_CCLK
from bfsim.spans import Span, SpanKind
from bfsim.trace import StallReason
from tests.machine.kernels import spin, total
from tests.machine.made_boards import CCLK_PER_SCLK, CHIP, CLOCKS, in_work, made_board
from tests.machine.peripherals.test_spi import MORE as MESSAGES
from tests.machine.peripherals.test_spi import Talker
from tests.machine.rig import SIZE, Play, cycles_of, every_frame
from tests.machine.stream_rig import MORE, NBYTES, READ, WRITE, linear
from tests.machine.timelines import assert_flows, assert_orderly, by_track, told
from tests.tiers import exhaustive

LINE_BYTES = 2 * SIZE.width_px
both_fidelities = pytest.mark.parametrize("fidelity", Fidelity)


def take_lines(core: Core, frame: Frame) -> Play:
    """Fetch all lines, and do nothing with them: each wait is ended by its transfer."""
    ring = core.input_ring(frame.rows, "in_ring")
    for _ in range(frame.height):
        yield from ring.line()


@both_fidelities
def test_a_ring_is_a_transfer_a_line_and_each_wait_has_the_one_that_ended_it(fidelity: Fidelity) -> None:
    """Begin and end of a transfer: behind the one before, and where its wait ends, to the cycle."""
    _, spans = told(made_board(in_work(take_lines), fidelity=fidelity), frames=1)
    transfers = by_track(spans)["MDMA1 stream 0", "transfers"]
    assert [(each.name, each.value) for each in transfers] == [
        ("camera → in_ring", LINE_BYTES)
    ] * SIZE.height_px
    waits = [each for each in spans if each.where == "core A" and StallReason.RING_EMPTY in each.stall_cclk]
    flows = {each.flow: each for each in transfers if each.flow}
    assert len(waits) == SIZE.height_px, "nothing else to do"
    assert all(flows[each.flow].end_cclk == each.end_cclk for each in waits)
    assert all(each.elapsed_cclk >= CHIP.dma.startup_sclk * CCLK_PER_SCLK for each in transfers)
    assert_flows(spans)
    assert_orderly(spans)


@both_fidelities
def test_the_picture_ends_the_wait_for_it(fidelity: Fidelity) -> None:
    """The transfer of a PPI has the flow to the wait for the next picture."""
    _, spans = told(made_board(in_work(take_lines), fidelity=fidelity), frames=1)
    (idle,) = [each for each in by_track(spans)["core A", "work"] if each.kind is SpanKind.IDLE][:1]
    pictures = [each for name in ("PPI0", "PPI1") for each in by_track(spans)[name, "transfers"]]
    assert [each.name for each in pictures] == ["picture → camera"] * 2
    (ending,) = [each for each in pictures if each.flow == idle.flow]
    assert ending.end_cclk == idle.end_cclk == max(each.end_cclk for each in pictures)
    assert all(each.value == LINE_BYTES * SIZE.height_px for each in pictures)


def test_camera_lines_come_at_the_pace_of_the_sensor() -> None:
    """As many as the picture has, all as long, the period of the sensor's line apart, and over before the DMA is."""
    board = made_board(in_work(take_lines))
    _, spans = told(board, frames=1)
    lines = by_track(spans)["PPI0", "lines"]
    mode = board.spec.sensor.mode(SIZE.width_px, SIZE.height_px)
    period_cclk = CLOCKS.cclk_hz / mode.ppi_clk_hz * mode.line_clocks
    assert [each.name for each in lines] == [f"line {number}" for number in range(SIZE.height_px)]
    assert all(
        abs(after.begin_cclk - before.begin_cclk - period_cclk) < period_cclk / 1000 + 1
        for before, after in pairwise(lines)
    )
    assert {each.value for each in lines} == {LINE_BYTES}
    (picture,) = by_track(spans)["PPI0", "transfers"]
    assert picture.begin_cclk <= lines[0].begin_cclk
    assert lines[-1].end_cclk <= picture.end_cclk


@both_fidelities
def test_a_programmed_stream_ends_the_wait_for_it(fidelity: Fidelity) -> None:
    """The last work unit of a memory DMA has the flow."""

    def work(core: Core, frame: Frame) -> Play:
        here, there = core.array("from_SDRAM"), core.array("to_L1")
        dma = core.memory_dma("MDMA2_1")
        dma.program(source=linear(here.address, NBYTES // 4), destination=linear(there.address, NBYTES // 4))
        yield from dma.start(READ, WRITE)
        yield from dma.wait()

    _, spans = told(made_board(in_work(work), more=MORE, fidelity=fidelity), frames=1)
    (unit,) = by_track(spans)["MDMA2 stream 1", "transfers"]
    (wait,) = [each for each in spans if StallReason.RING_EMPTY in each.stall_cclk]
    assert (unit.name, unit.value, unit.flow, unit.end_cclk) == (
        "work unit",
        NBYTES,
        wait.flow,
        wait.end_cclk,
    )


def test_messages_are_the_records() -> None:
    """Each message over SPI is a span of its own, as long as its record."""

    def work(core: Core, frame: Frame) -> Play:
        yield from core.send(core.array("message"), 24)

    outcome, spans = told(made_board(in_work(work), more=MESSAGES, devices={"SPI": Talker()}), frames=2)
    messages = by_track(spans)["SPI", "messages"]
    assert [(each.name, each.value, each.end_cclk) for each in messages] == [
        ("report out", each.nbytes, each.end_cclk) for each in outcome.messages
    ]
    assert len(messages) == 2


def test_the_count_of_a_semaphore_is_a_level() -> None:
    """Three posts and two takes; how long each count stood."""

    def work(core: Core, frame: Frame) -> Play:
        for _ in range(3):
            yield from core.post("lines")
        yield core.run(spin, 100)
        for _ in range(2):
            yield from core.wait("lines")
        yield from core.post("through")

    _, spans = told(made_board(in_work(work)), frames=1)
    counts = by_track(spans)["semaphore lines", "count"]
    assert [each.value for each in counts] == [0, 1, 2, 3, 2, 1]
    assert counts[3].elapsed_cclk > cycles_of(spin, 100)
    assert all(before.end_cclk == after.begin_cclk for before, after in pairwise(counts))


def test_a_lock_is_held_by_one_core_at_a_time() -> None:
    """Both cores want it; who has it is a span, and they take turns."""

    def work(core: Core, frame: Frame) -> Play:
        for _ in range(3):
            yield from core.lock("word")
            yield core.run(spin, 100)
            yield from core.unlock("word")

    _, spans = told(made_board(in_work(work), in_work(work)), frames=1)
    held = by_track(spans)["lock word", "locks"]
    assert sorted(each.name for each in held) == ["core A"] * 3 + ["core B"] * 3
    assert all(each.elapsed_cclk > cycles_of(spin, 100) for each in held)
    assert_orderly(spans)


def test_the_fill_of_a_ring_says_whether_dma_keeps_up() -> None:
    """A line that is there when the core asks, behind long work; and one that is not."""

    def slow(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "in_ring")
        for _ in range(frame.height):
            yield from ring.line()
            yield core.run(spin, 10_000)

    for body, values in ((take_lines, []), (slow, [0, 1])):
        _, spans = told(made_board(in_work(body)), frames=1)
        assert [each.value for each in by_track(spans)["core A", "ring in_ring"]] == values


@pytest.mark.parametrize("fidelity", [Fidelity.FAST, *exhaustive(Fidelity.DETAILED)])
def test_the_load_of_a_bus_is_its_busy_time(fidelity: Fidelity) -> None:
    """A core that reads SDRAM and nothing else: the levels, by the time that they stood, are the busy cycles of the records."""

    def read(core: Core, frame: Frame) -> Play:
        for _ in range(40):
            yield core.run(total, core.array("in_sdram"))

    outcome, spans = told(made_board(in_work(read), fidelity=fidelity), frames=1)
    (work,) = [each for each in spans if (each.kind, each.name) == (SpanKind.STAGE, "Work")]
    levels: list[Span] = by_track(spans)["SDRAM bus", "busy with cores, %"]
    loads = [each for each in levels if each.end_cclk > work.begin_cclk]
    busy_cclk = sum(each.value * each.elapsed_cclk for each in loads) / 100
    (record,) = [each for each in outcome.traffic if (each.memory, each.master) == ("SDRAM", "core A")]
    rounding = work.elapsed_cclk / 100 + SAMPLE_CCLK
    assert busy_cclk == pytest.approx(record.busy_cclk, abs=ceil(rounding))
    assert max(each.value for each in levels) <= 100
    assert record.busy_cclk > 2 * rounding, "or nothing was shown"


def test_nobody_is_told_without_a_timeline() -> None:
    """A board that nobody asks keeps nothing."""
    board = made_board(every_frame(take_lines))
    board.run(iter(()))
    assert board._env.timeline is None
    assert board._bus.records.timeline is None
