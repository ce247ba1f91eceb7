"""Memory DMA as firmware programs it: what arrives, when, with which interrupts, and what the chip flags."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bfsim.api import Buffer, Core, Firmware, Frame, FrameSize, u8, u16
from bfsim.chip.boards import CM_BF533
from bfsim.chip.dma_registers import Flow, WdSize
from bfsim.errors import FirmwareError, MmrError
from bfsim.linker import link
from bfsim.machine.board import Board, Outcome, symbols_of
from bfsim.machine.dma_config import DmaConfig
from bfsim.machine.dma_descriptors import write_descriptor
from bfsim.trace import StallReason
from tests.machine.kernels import spin
from tests.machine.made_boards import CCLK_PER_SCLK, CHIP, assert_accounted, cclk_now, in_work, play
from tests.machine.placements import shipped
from tests.machine.rig import SIZE, Play, every_frame, stage_of
from tests.machine.rig import noise as pictures

DMA = CHIP.dma
NBYTES = 512
SECTIONS = {"L1": "L1_data_a", "L2": "l2_shared", "SDRAM": "sdram_bank2"}
MORE = tuple(
    Buffer(
        f"{use}_{memory}", u16 if use == "chain" else u8, NBYTES // 2 if use == "chain" else NBYTES, section
    )
    for memory, section in SECTIONS.items()
    for use in ("from", "to", "chain")
)
PATHS = [(source, target) for source in SECTIONS for target in SECTIONS]
each_path = pytest.mark.parametrize(("source", "target"), PATHS)

READ, WRITE = DmaConfig(), DmaConfig(WNR=True)
Registers = Mapping[str, int]


def noise(nbytes: int = NBYTES) -> NDArray[np.uint8]:
    """The same random bytes every time."""
    return np.random.default_rng(561).integers(0, 256, nbytes, np.uint8)


def linear(address: int, words: int, word_bytes: int = 4) -> Registers:
    """Registers for words one after the other."""
    return {"START_ADDR": address, "X_COUNT": words, "X_MODIFY": word_bytes}


def transfer(
    source: str,
    target: str,
    registers: Callable[[int, int], tuple[Registers, Registers]],
    configs: tuple[DmaConfig, DmaConfig],
    stream: str = "MDMA2_1",
) -> tuple[NDArray[np.uint8], Outcome]:
    """Move noise from one memory to the other; return what is there then, and the run."""
    arrived = []

    def work(core: Core, frame: Frame) -> Play:
        here, there = core.array(f"from_{source}"), core.array(f"to_{target}")
        here.array[:] = noise()
        dma = core.memory_dma(stream)
        inward, outward = registers(here.address, there.address)
        dma.program(source=inward, destination=outward)
        yield from dma.start(*configs)
        yield from dma.wait()
        arrived.append(there.array.copy())

    outcome = play(in_work(work), more=MORE)
    assert_accounted(outcome)
    return arrived[0], outcome


# ---- what arrives


@each_path
@pytest.mark.parametrize("width", WdSize)
def test_a_row_arrives_whole(source: str, target: str, width: WdSize) -> None:
    """Between any two memories, in words of any width."""
    words, nbytes = 100, width.word_bytes
    arrived, _ = transfer(
        source,
        target,
        lambda here, there: (linear(here, words, nbytes), linear(there, words, nbytes)),
        (DmaConfig(WDSIZE=width), DmaConfig(WDSIZE=width, WNR=True)),
    )
    np.testing.assert_array_equal(arrived[: words * nbytes], noise()[: words * nbytes])
    assert not arrived[words * nbytes :].any(), "and nothing behind it"


@each_path
def test_a_negative_step_mirrors_an_image(source: str, target: str) -> None:
    """Rows of pixels are read forwards and written backwards."""
    height, width = 8, 32
    arrived, _ = transfer(
        source,
        target,
        lambda here, there: (
            linear(here, height * width, 1),
            {
                "START_ADDR": there + width - 1,
                "X_COUNT": width,
                "X_MODIFY": -1,
                "Y_COUNT": height,
                "Y_MODIFY": 2 * width - 1,
            },
        ),
        (
            DmaConfig(WDSIZE=WdSize.WDSIZE_8),
            DmaConfig(WDSIZE=WdSize.WDSIZE_8, WNR=True, DMA2D=True),
        ),
    )
    image = noise()[: height * width].reshape(height, width)
    np.testing.assert_array_equal(arrived[: height * width].reshape(height, width), image[:, ::-1])


@each_path
@pytest.mark.parametrize("width", WdSize)
def test_two_dimensions_transpose_a_block(source: str, target: str, width: WdSize) -> None:
    """Row by row out of the block, column by column into it."""
    rows, columns, nbytes = 6, 10, width.word_bytes
    arrived, _ = transfer(
        source,
        target,
        lambda here, there: (
            linear(here, rows * columns, nbytes),
            {
                "START_ADDR": there, "X_COUNT": columns, "X_MODIFY": rows * nbytes,
                "Y_COUNT": rows, "Y_MODIFY": nbytes - (columns - 1) * rows * nbytes,
            },
        ),
        (DmaConfig(WDSIZE=width), DmaConfig(WDSIZE=width, WNR=True, DMA2D=True)),
    )  # fmt: skip
    words = np.dtype(f"u{nbytes}")
    block = noise()[: rows * columns * nbytes].view(words).reshape(rows, columns)
    np.testing.assert_array_equal(
        arrived[: rows * columns * nbytes].view(words).reshape(columns, rows), block.T
    )


@st.composite
def walks(draw: Any) -> tuple[int, int, int, int, int, int]:
    """Width of the words in bytes, rows, columns, X_MODIFY, Y_MODIFY and first byte of a walk inside the buffer."""
    nbytes = draw(st.sampled_from([1, 2, 4]))
    rows, columns = draw(st.integers(1, 5)), draw(st.integers(1, 6))
    across, down = draw(st.integers(-4, 4)), draw(st.integers(-8, 8))
    reached = [
        row * ((columns - 1) * across + down) + column * across
        for row in range(rows)
        for column in range(columns)
    ]
    first = draw(st.integers(-min(reached), NBYTES // nbytes - 1 - max(reached)))
    return nbytes, rows, columns, across, down, first


@settings(max_examples=40, deadline=None)
@given(walks(), st.sampled_from(PATHS))
def test_any_walk_reads_what_plain_python_reads(walk: tuple[int, ...], path: tuple[str, str]) -> None:
    """Gathered by the source in two dimensions, written one after the other."""
    nbytes, rows, columns, across, down, first = walk
    width = WdSize(nbytes.bit_length() - 1)
    arrived, _ = transfer(
        *path,
        lambda here, there: (
            {
                "START_ADDR": here + first * nbytes, "X_COUNT": columns, "X_MODIFY": across * nbytes,
                "Y_COUNT": rows, "Y_MODIFY": down * nbytes,
            },
            linear(there, rows * columns, nbytes),
        ),
        (DmaConfig(WDSIZE=width, DMA2D=True), DmaConfig(WDSIZE=width, WNR=True)),
    )  # fmt: skip
    words, at, expected = noise().view(f"u{nbytes}"), first, []
    for _ in range(rows):
        for column in range(columns):
            expected.append(words[at])
            at += across if column < columns - 1 else down
    assert arrived.view(f"u{nbytes}")[: rows * columns].tolist() == expected


# ---- when


def on_chip_cclk(units: int, words: int, elements: int, before: int) -> int:
    """Cycles from the start of `units` between L1 and L2, each of so many words and descriptor elements, at a core's cycle."""
    begin = before
    for _ in range(units):
        ready = begin + (DMA.startup_sclk + elements * DMA.descriptor_sclk) * CCLK_PER_SCLK
        begin = (
            -(-ready // CCLK_PER_SCLK) * CCLK_PER_SCLK + int(words * DMA.on_chip_word_sclk) * CCLK_PER_SCLK
        )
    return begin - before


@pytest.mark.parametrize("words", [1, 2, 17, 128])
@pytest.mark.parametrize(("source", "target"), [("L1", "L1"), ("L1", "L2"), ("L2", "L1")])
def test_programming_start_up_and_words_make_the_time(source: str, target: str, words: int) -> None:
    """A register write each, the start-up, and a word an SCLK; the core waits for all of it."""
    times = []

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("MDMA1_0")
        here, there = core.array(f"from_{source}"), core.array(f"to_{target}")
        dma.program(source=linear(here.address, words), destination=linear(there.address, words))
        yield from dma.start(READ, WRITE)
        times.append(cclk_now(core))
        yield from dma.wait()
        times.append(cclk_now(core))

    outcome = play(in_work(work), more=MORE)
    posted, done = times
    waited = on_chip_cclk(1, words, 0, posted)
    assert done - posted == waited
    cost = stage_of(outcome.frames[0], "Work")
    writes = 2 * 3 + 2  # START_ADDR, X_COUNT and X_MODIFY, then CONFIG, of both channels
    assert cost.stall_cclk == {
        StallReason.DMA_SETUP: writes * CHIP.events.mmr_write_cclk,
        StallReason.RING_EMPTY: waited,
    }


@pytest.mark.parametrize("words", [1, 40, 128])
def test_the_internal_dma_has_the_pace_of_the_core_s_clock(words: int) -> None:
    """Two CCLK a word, where MDMA takes an SCLK."""
    times = []

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("IMDMA_0")
        here, there = core.array("from_L1"), core.array("to_L2")
        dma.program(source=linear(here.address, words), destination=linear(there.address, words))
        yield from dma.start(READ, WRITE)
        times.append(cclk_now(core))
        yield from dma.wait()
        times.append(cclk_now(core))

    play(every_frame(work), more=MORE)
    posted, done = times
    ready = posted + DMA.startup_sclk * CCLK_PER_SCLK
    assert done == -(-ready // CCLK_PER_SCLK) * CCLK_PER_SCLK + words * DMA.imdma_word_cclk


def test_the_core_works_while_the_words_move() -> None:
    """A call longer than the transfer hides it: no wait is left."""

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("MDMA1_0")
        here, there = core.array("from_SDRAM"), core.array("to_L1")
        dma.program(source=linear(here.address, 100), destination=linear(there.address, 100))
        yield from dma.start(READ, WRITE)
        yield core.run(spin, 1000)
        yield from dma.wait()

    cost = stage_of(play(in_work(work), more=MORE).frames[0], "Work")
    assert set(cost.stall_cclk) == {StallReason.DMA_SETUP}


# ---- descriptors


def chain(flow: Flow, at: int, units: Sequence[Mapping[str, int]], **fields: Any) -> list[int]:
    """Return the 16-bit words of descriptors one after the other from address `at`; the last one stops."""
    described: list[int] = []
    for number, registers in enumerate(units):
        ends = number == len(units) - 1
        size = len(write_descriptor(flow, **_full(flow, 0, registers, 0)))
        config = DmaConfig(**fields, FLOW=Flow.STOP if ends else flow, NDSIZE=0 if ends else size)
        pointer = at + 2 * (len(described) + size)
        described += write_descriptor(flow, **_full(flow, pointer, registers, config.encode()))
    return described


def _full(flow: Flow, pointer: int, registers: Mapping[str, int], config: int) -> dict[str, int]:
    """Order the registers of a descriptor."""
    link = {} if flow is Flow.ARRAY else {"NEXT_DESC_PTR": pointer & (0xFFFF if flow is Flow.SMALL else -1)}
    rest = {name: registers[name] for name in ("X_COUNT", "X_MODIFY")}
    return {**link, "START_ADDR": registers["START_ADDR"], "CONFIG": config, **rest}


def run_chain(
    flow: Flow, memory: str, units: int, words: int
) -> tuple[list[NDArray[np.uint8]], int, int, Outcome]:
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
        dma.done.callbacks.append(lambda _: times.append(core._env.tick // core._cclk_ticks))
        yield from dma.wait()
        arrived.append(there.array.copy())

    outcome = play(every_frame(work), more=MORE)
    return arrived, *times, outcome


@pytest.mark.parametrize("memory", SECTIONS)
@pytest.mark.parametrize(("flow", "elements"), [(Flow.ARRAY, 5), (Flow.SMALL, 6), (Flow.LARGE, 7)])
def test_a_chain_of_descriptors_gathers_pieces(flow: Flow, elements: int, memory: str) -> None:
    """Arrays and lists, wherever they lie: the pieces arrive in the order of the descriptors, an interrupt each.

    Every work unit is started anew, and costs its two descriptors, element by element.
    """
    units, words = 4, 16
    arrived, posted, done, outcome = run_chain(flow, memory, units, words)
    pieces = noise()[: 4 * units * words].reshape(units, -1)[::-1].ravel()
    np.testing.assert_array_equal(arrived[0][: len(pieces)], pieces)
    assert outcome.interrupts == {"A MDMA1_1": units}
    assert done - posted == on_chip_cclk(units, words, 2 * elements, posted)


# ---- autobuffer and interrupts


def counting(
    config: DmaConfig, registers: Registers, source: str, target: str, until: int
) -> tuple[int, Outcome]:
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
        pytest.param(
            "L1", "L2",
            marks=pytest.mark.xfail(strict=True, reason="between L1 and L2 all rows move, and interrupt, at the end"),
        ),
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
        times.append(core._env.tick // core._cclk_ticks)
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


# ---- what the chip flags


def mistake(
    source: Mapping[str, int], destination: Mapping[str, int], configs: tuple[DmaConfig, DmaConfig] = (READ, WRITE),
    stream: str = "MDMA1_0",
) -> tuple[str, int]:  # fmt: skip
    """Program what is wrong; return the message without this file's name, and the line of `program`."""
    lines = []

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma(stream)
        here, there = core.array("from_L1"), core.array("to_L1")
        inward, outward = linear(here.address, 8), linear(there.address, 8)
        dma.program(source={**inward, **source}, destination={**outward, **destination})
        yield from dma.start(*configs)
        yield from dma.wait()

    lines.append(work.__code__.co_firstlineno + 4)
    with pytest.raises(MmrError) as caught:
        play(every_frame(work), more=MORE)
    return str(caught.value).replace(__file__, "here"), lines[0]


@pytest.mark.parametrize(
    ("source", "destination", "message"),
    [
        ({"X_COUNT": 65536}, {}, "MDMA1_S0_X_COUNT must be .* not 65536"),
        ({"X_MODIFY": 40_000}, {}, "MDMA1_S0_X_MODIFY must be .* not 40000"),
        ({}, {"CURR_X_COUNT": 1}, "a register that can be written must be one of .*, not CURR_X_COUNT"),
    ],
)
def test_a_wrong_register_is_told_with_the_line_that_sets_it(
    source: dict[str, int], destination: dict[str, int], message: str
) -> None:
    """Channel, register, value, and the firmware's line."""
    told, line = mistake(source, destination)
    assert re.match(rf"{message} \(set at here:{line}\)", told), told


@pytest.mark.parametrize(
    ("source", "destination", "configs", "message"),
    [
        ({"START_ADDR": 0x2}, {}, (READ, WRITE), "MDMA1_S0_START_ADDR must be a multiple of 4 bytes with WDSIZE_32, not 0x"),
        ({"START_ADDR": 0x3000_0000}, {}, (READ, WRITE), "MDMA1_S0_START_ADDR must point into a memory, not to"),
        ({}, {"START_ADDR": 0xFFB0_0000}, (READ, WRITE), "MDMA1_D0_START_ADDR must point into a memory that DMA1 reaches"),
        ({}, {"X_MODIFY": 32_000}, (READ, WRITE), "MDMA1_D0_START_ADDR: what starts at .* must stay in"),
        ({"X_COUNT": 7}, {}, (READ, WRITE), "MDMA1_S0 and MDMA1_D0 must move the same number of words, not 7 and 8"),
        (
            {}, {}, (DmaConfig(WDSIZE=WdSize.WDSIZE_16), WRITE),
            "MDMA1_S0 and MDMA1_D0 must have the same WDSIZE, not 16 and 32 bits",
        ),
        ({}, {}, (WRITE, WRITE), "MDMA1_S0_CONFIG: WNR must be 0, not 1"),
        ({}, {}, (READ, READ), "MDMA1_D0_CONFIG: WNR must be 1, not 0"),
        ({}, {}, (DmaConfig(NDSIZE=3), WRITE), "MDMA1_S0_CONFIG: FLOW=STOP requires NDSIZE 0, not 3"),
    ],
)  # fmt: skip
def test_wrong_work_is_told_with_the_line_that_starts_it(
    source: dict[str, int], destination: dict[str, int], configs: tuple[DmaConfig, DmaConfig], message: str
) -> None:
    """Whatever the chip would set DMA_ERR for."""
    told, line = mistake(source, destination, configs)
    assert re.match(message, told), told
    assert re.search(rf"\((set|started) at here:{line + 1}\)", told), told


def test_a_bad_descriptor_is_told_with_its_address_and_the_line_of_the_start() -> None:
    """The second one of a chain, fetched long after the start."""
    address = []

    def work(core: Core, frame: Frame) -> Play:
        here, there, descriptors = core.array("from_L1"), core.array("to_L1"), core.array("chain_L1")
        pieces = [linear(here.address, 8), linear(here.address + 1, 8)]
        source = chain(Flow.LARGE, descriptors.address, pieces)
        descriptors.array[: len(source)] = source
        address.append(descriptors.address + len(source))
        dma = core.memory_dma("MDMA1_0")
        dma.program(source={"NEXT_DESC_PTR": descriptors.address}, destination=linear(there.address, 8))
        yield from dma.start(DmaConfig(FLOW=Flow.LARGE, NDSIZE=7), DmaConfig(FLOW=Flow.AUTO, WNR=True))
        yield from dma.wait()

    with pytest.raises(MmrError) as caught:
        play(every_frame(work), more=MORE)
    line = work.__code__.co_firstlineno + 8
    assert re.match("MDMA1_S0_START_ADDR must be a multiple of 4 bytes", str(caught.value))
    expected = f"(in the descriptor at 0x{address[0]:08X} of the chain started at {__file__}:{line})"
    assert expected in str(caught.value)


def test_the_internal_dma_does_not_reach_sdram() -> None:
    """L1 of a core and L2 only."""
    told, line = mistake({"START_ADDR": 0x1000}, {}, stream="IMDMA_1")
    assert told.startswith(
        "IMDMA_S1_START_ADDR must point into a memory that IMDMA reaches, not to 0x00001000 in SDRAM"
    )
    assert f"here:{line + 1}" in told


def test_the_internal_dma_takes_words_from_the_other_core_s_l1() -> None:
    """What no load or store of a core can reach: from L1 of core A to L1 of core B."""
    seen = []
    addresses = []

    def give(core: Core, frame: Frame) -> Play:
        yield from core.wait("address")
        here = core.array("from_L1")
        here.array[:] = noise()
        dma = core.memory_dma("IMDMA_0")
        dma.program(source=linear(here.address, 8), destination=linear(addresses[0], 8))
        yield from dma.start(READ, WRITE)
        yield from dma.wait()
        yield from core.post("there")

    def take(core: Core, frame: Frame) -> Play:
        words = core.array("words")
        addresses.append(words.address)
        yield from core.post("address")
        yield from core.wait("there")
        seen.append(words.octets[:32].tobytes())

    play(every_frame(give), every_frame(take), more=MORE)
    assert seen == [noise()[:32].tobytes()]


def test_an_unknown_stream_is_told_the_known_ones() -> None:
    """By the names of their interrupts."""

    def work(core: Core, frame: Frame) -> Play:
        core.memory_dma("MDMA3_0")
        yield core.run(spin, 1)

    with pytest.raises(
        FirmwareError, match="must be one of MDMA1_0, .*IMDMA_1, not 'MDMA3_0' .*test_memory_dma.py:"
    ):
        play(every_frame(work), more=MORE)


def test_registers_of_a_running_stream_must_not_be_written() -> None:
    """Nor can it be started twice."""

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("MDMA1_0")
        here, there = core.array("from_L1"), core.array("to_L1")
        for _ in range(2):
            dma.program(source=linear(here.address, 8), destination=linear(there.address, 8))
            yield from dma.start(READ, WRITE)

    line = work.__code__.co_firstlineno + 4
    with pytest.raises(MmrError, match=f"MDMA1_S0_START_ADDR must not be written while .*py:{line}"):
        play(every_frame(work), more=MORE)


@pytest.mark.parametrize("name", ["MDMA2_0", "IMDMA_0"])
def test_a_chip_has_its_own_streams_only(name: str) -> None:
    """The BF533 has one controller, and no internal DMA."""

    def buffers(size: FrameSize) -> dict[str, Sequence[Buffer]]:
        return {"A": (Buffer("camera", u8, 2 * size.width_px, "sdram_bank0", rows=3 * size.height_px),)}

    def work(core: Core, frame: Frame) -> Play:
        yield from core.memory_dma(name).wait()

    firmware = Firmware(mains={"A": every_frame(work)}, buffers=buffers, camera="camera", rows=())
    chip = CM_BF533.chip
    link_map = link(shipped("cm-bf533.ldf"), symbols_of(firmware, SIZE), chip.regions, chip=chip.name)
    with pytest.raises(FirmwareError, match=f"must be one of MDMA1_0, MDMA1_1, not '{name}'"):
        Board(CM_BF533, firmware, SIZE, link_map).run(pictures(1))
