"""Memory DMA as firmware programs it: what arrives, and when."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bfsim.api import Core, Frame
from bfsim.chip.dma_registers import WdSize
from bfsim.machine.dma.config import DmaConfig
from bfsim.trace import BoardRecord, StallReason
from tests.machine.kernels import spin
from tests.machine.made_boards import CCLK_PER_SCLK, CHIP, assert_accounted, cclk_now, in_work, play
from tests.machine.rig import Play, every_frame, stage_of
from tests.machine.stream_rig import (
    DMA,
    MORE,
    NBYTES,
    PATHS,
    READ,
    WRITE,
    Registers,
    each_path,
    linear,
    noise,
    on_chip_cclk,
)


def transfer(
    source: str,
    target: str,
    registers: Callable[[int, int], tuple[Registers, Registers]],
    configs: tuple[DmaConfig, DmaConfig],
    stream: str = "MDMA2_1",
) -> tuple[NDArray[np.uint8], BoardRecord]:
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


@settings(max_examples=40)
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
