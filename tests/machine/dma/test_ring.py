"""Line rings: the DMA is one line ahead of the core, and the core waits only when it is late."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Core, Frame, FrameSize, u16
from bfsim.chip.bf561 import BF561
from bfsim.errors import FirmwareError
from bfsim.trace import StallReason
from tests.machine.bench import Bench
from tests.machine.kernels import copy, first, negate, spin
from tests.machine.rig import SIZE, Picture, Play, every_frame, load, noise, run, stage_of, through_rings

LINE_BYTES = 2 * SIZE.width_px
EVENTS = BF561.events
SETUP_CCLK = 5 * EVENTS.mmr_write_cclk + EVENTS.mmr_read_cclk  # of one copy, each time
REFRESH_CCLK = (11 + 3 + 2 * 2) * 5
"""A refresh that comes in between, behind data on their way, and the page opened before and after it."""


def copy_sclk(words: int, *, is_write: bool = False) -> int:
    """Cycles of an undisturbed copy between L1 and an open page of SDRAM, shorter than from pause to pause."""
    dma, sdram = Bench().spec.chip.dma, Bench().spec.sdram
    return dma.startup_sclk + words + (0 if is_write else sdram.nCL)


def test_lines_come_in_order_and_bit_exact() -> None:
    """Every byte of the left picture reaches core A, of the right one core B, first line first."""
    seen: dict[str, list[np.ndarray[Any, Any]]] = {"A": [], "B": []}

    def look(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "in_ring")
        for _ in range(frame.height):
            seen[core.name].append((yield from ring.line()).array.copy())

    run(every_frame(look), every_frame(look), frames=2)
    pictures = list(noise(2))
    assert np.array_equal(np.stack(seen["A"]), np.concatenate([each.left for each in pictures]))
    assert np.array_equal(np.stack(seen["B"]), np.concatenate([each.right for each in pictures]))


def test_a_picture_goes_through_two_rings_and_a_kernel() -> None:
    """In, inverted, out, and what the DMA brought to SDRAM is the whole picture."""
    results = []

    def invert(core: Core, frame: Frame) -> Play:
        yield from through_rings(core, frame, negate)
        results.append(np.stack([row.array for row in core.rows("image")]))

    outcome = run(every_frame(invert))
    (picture,) = noise(1)
    assert np.array_equal(results[0], 255 - picture.left)
    moved = {each.master: each for each in outcome.traffic if each.memory == "SDRAM"}
    assert moved["MDMA1 stream 0"].read_bytes == moved["MDMA1 stream 1"].written_bytes == picture.left.size


def test_dma_moves_bytes_whatever_the_elements_are() -> None:
    """A picture of bytes in a ring of 16-bit elements: two pixels' bytes in each, low byte first."""
    lines = []

    def look(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "wide_ring")
        for _ in range(frame.height):
            lines.append((yield from ring.line()).array.copy())

    run(every_frame(look))
    (picture,) = noise(1)
    assert np.array_equal(np.stack(lines), picture.left.view(u16.dtype))


def test_a_ring_of_three_keeps_two_lines() -> None:
    """The newest line and the one before can be used; older ones are gone, later ones not there."""

    def look(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "in_ring")
        for number in range(frame.height):
            newest = yield from ring.line()
            yield core.run(spin, 500)
            yield from core.post("time for the DMA to bring what comes next")
            assert ring[number] is newest
            for each in range(max(0, number - 1), number + 1):
                assert np.array_equal(ring[each].array, frame.rows[each].array)
            for gone in {number - 2, number + 1, -1} - {number - 1}:
                with pytest.raises(
                    FirmwareError, match=f"line {gone} is not in ring in_ring, which has 3 rows"
                ):
                    ring[gone]

    run(every_frame(look))


def test_a_core_without_work_waits_for_every_line() -> None:
    """DMA-bound: each line costs what its copy costs, and all of it is RING_EMPTY."""

    def fetch(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)  # until the last lines of both cameras are off the bus
        with core.stage("Work"):
            ring = core.input_ring(frame.rows, "in_ring")
            for _ in range(frame.height):
                yield from ring.line()

    outcome = run(every_frame(fetch), frames=2)
    cost = stage_of(outcome.frames[1], "Work")
    unloaded_cclk = SIZE.height_px * copy_sclk(LINE_BYTES // 4) * 5
    assert cost.issue_cclk == cost.idle_cclk == 0
    assert cost.stall_cclk[StallReason.DMA_SETUP] == SIZE.height_px * SETUP_CCLK
    assert cost.elapsed_cclk == sum(cost.stall_cclk.values())
    # the first copy is programmed, and waits for an SCLK edge
    assert cost.elapsed_cclk - unloaded_cclk in range(SETUP_CCLK + REFRESH_CCLK + 5)


def test_a_core_with_work_waits_for_the_first_line_only() -> None:
    """Compute-bound: while the core works on a line, the DMA brings the next."""

    def work(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "in_ring")
        with core.stage("Work"):
            yield from ring.line()
        with core.stage("More work"):
            for _ in range(frame.height - 1):
                yield core.run(spin, 200)
                yield from ring.line()

    outcome = run(every_frame(work))
    assert set(stage_of(outcome.frames[0], "Work").stall_cclk) == {
        StallReason.RING_EMPTY,
        StallReason.DMA_SETUP,
    }
    setup_cclk = (SIZE.height_px - 1) * SETUP_CCLK
    assert stage_of(outcome.frames[0], "More work").stall_cclk == {StallReason.DMA_SETUP: setup_cclk}


def test_a_core_that_is_too_fast_fills_its_output_ring() -> None:
    """Two rows: the third line waits for the first to leave; in all, every line but two costs a copy."""

    def send(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 1000)  # until the last lines of both cameras are off the bus
        out = core.output_ring("out_ring", core.rows("image"))
        with core.stage("Work"):
            for _ in range(frame.height):
                yield from out.row()
                out.send()
        with core.stage("More work"):
            yield from out.flush()

    outcome = run(every_frame(send), frames=2)
    one_cclk = copy_sclk(LINE_BYTES // 4, is_write=True) * 5
    sending, flushing = (stage_of(outcome.frames[1], each) for each in ("Work", "More work"))
    assert set(sending.stall_cclk) == {StallReason.RING_FULL, StallReason.DMA_SETUP}
    assert set(flushing.stall_cclk) == {StallReason.RING_FULL}
    # each line is programmed while those before it leave; the last two are on their way when all are sent
    setup_cclk = SIZE.height_px * SETUP_CCLK
    assert sending.elapsed_cclk - (SIZE.height_px - 2) * one_cclk in range(setup_cclk + REFRESH_CCLK + 5)
    assert 2 * one_cclk - flushing.elapsed_cclk in range(2 * SETUP_CCLK)


def test_flush_of_nothing_is_free() -> None:
    """No line was sent, so there is none to wait for."""

    def flush(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield from core.output_ring("out_ring", core.rows("image")).flush()

    assert stage_of(run(every_frame(flush)).frames[0], "Work").elapsed_cclk == 0


def test_what_was_flushed_can_be_read_back() -> None:
    """A second stage reads what the first one wrote, through the same memory."""
    sums = []

    def there_and_back(core: Core, frame: Frame) -> Play:
        yield from through_rings(core, frame, copy)
        ring = core.input_ring(core.rows("image"), "in_ring")
        for _ in range(frame.height):
            sums.append((yield core.run(first, (yield from ring.line()))))

    run(every_frame(there_and_back))
    (picture,) = noise(1)
    assert sums == picture.left[:, 0].tolist()


def test_rings_work_on_images_in_l2() -> None:
    """No SDRAM and no bus, but the same lines."""

    def there_and_back(core: Core, frame: Frame) -> Play:
        out = core.output_ring("out_ring", core.rows("shared_image"))
        for number in range(frame.height):
            (yield from out.row()).array[:] = number
            out.send()
        yield from out.flush()
        ring = core.input_ring(core.rows("shared_image"), "in_ring")
        for number in range(frame.height):
            assert ((yield from ring.line()).array == number).all()

    run(every_frame(there_and_back))


def test_a_line_that_spans_two_pages_arrives_whole() -> None:
    """644 bytes a line and pages of 2048: some lines cross a page border, and none loses a byte."""
    size = FrameSize(322, 10)
    lines = []

    def look(core: Core, frame: Frame) -> Play:
        page_bytes = Bench().spec.sdram.page_bytes
        assert any(
            row.offset // page_bytes < (row.offset + row.nbytes - 1) // page_bytes for row in frame.rows
        )
        ring = core.input_ring(frame.rows, "in_ring")
        for _ in range(frame.height):
            lines.append((yield from ring.line()).array.copy())

    run(every_frame(look), size=size)
    (picture,) = noise(1, size)
    assert np.array_equal(np.stack(lines), picture.left)


def one_line_too_many(core: Core, frame: Frame) -> Play:
    """Ask for line 8 of 8."""
    ring = core.input_ring(frame.rows, "in_ring")
    for _ in range(frame.height + 1):
        yield from ring.line()


def one_line_too_many_sent(core: Core, frame: Frame) -> Play:
    """Send line 8 of 8."""
    out = core.output_ring("out_ring", core.rows("image"))
    for _ in range(frame.height + 1):
        yield from out.row()
        out.send()


def a_row_twice(core: Core, frame: Frame) -> Play:
    """Forget to send what was written."""
    out = core.output_ring("out_ring", core.rows("image"))
    for _ in range(frame.height):
        yield from out.row()


def the_last_row_not_sent(core: Core, frame: Frame) -> Play:
    """Forget to send what was written last."""
    out = core.output_ring("out_ring", core.rows("image"))
    yield from out.row()
    out.send()
    yield from out.row()
    yield from out.flush()


def ring_of(ring: str) -> Any:
    """Make an input ring of the buffer `ring`."""

    def make(core: Core, frame: Frame) -> Generator[Any, Any, None]:
        core.input_ring(frame.rows, ring)
        yield from ()

    return make


def ring_for_no_picture(core: Core, frame: Frame) -> Play:
    """Make a ring for a picture without lines."""
    core.input_ring(frame.rows[:0], "in_ring")
    yield from ()


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (one_line_too_many, "ring of in_ring has no line 8: the picture has 8"),
        (one_line_too_many_sent, "picture image has 8 lines; one more was sent"),
        (
            a_row_twice,
            r"row of out_ring for line 0 of image must be sent when it is written: `ring\.send\(\)`",
        ),
        (the_last_row_not_sent, "row of out_ring for line 1 of image must be sent when it is written"),
        (
            ring_of("short_ring"),
            r"rows of ring short_ring must be as long as those of camera \(32 bytes\), not 16 bytes",
        ),
        (ring_of("scratch_ring"), "scratch_ring must be where DMA can reach it, not in COREA_SCRATCH"),
        (ring_of("single_row"), "a ring needs at least 2 rows, not the 1 of single_row"),
        (ring_of("ring_in"), "core A has no buffer 'ring_in'; it has camera, image, in_l2, in_ring"),
        (ring_for_no_picture, "picture for ring in_ring must have at least one line, not none"),
    ],
)
def test_wrong_use_of_a_ring_is_told(body: Any, message: str) -> None:
    """Each mistake names the buffer and what it should have been."""
    with pytest.raises(FirmwareError, match=message):
        run(every_frame(body))


def test_lines_of_a_frame_are_never_mixed_with_the_next_one() -> None:
    """While a core works for longer than a frame, the cameras fill other buffers than the one it reads from."""
    flat = [Picture(n, np.full((8, 32), n, np.uint8), np.full((8, 32), n, np.uint8), n, n) for n in range(6)]

    def look(core: Core, frame: Frame) -> Play:
        ring = core.input_ring(frame.rows, "in_ring")
        for _ in range(frame.height):
            assert ((yield from ring.line()).array == frame.index).all()
            yield core.run(spin, 1_000_000)

    assert len(run(every_frame(look), frames=flat).frames) == 6


@settings(max_examples=20)
@given(turns=st.lists(st.integers(0, 300), min_size=1, max_size=5))
def test_rings_never_hold_more_than_they_have_rows(turns: list[int]) -> None:
    """However fast the core is, a line that it may use is whole, one at most is on its way in, and none is lost."""
    written = []

    def work(core: Core, frame: Frame) -> Play:
        ring, out = core.input_ring(frame.rows, "in_ring"), core.output_ring("out_ring", core.rows("image"))
        for number in range(frame.height):
            source, target = (yield from ring.line()), (yield from out.row())
            yield core.run(spin, turns[number % len(turns)])
            sent = out._sent
            on_their_way = [
                each for each in sent._copies.values() if each.end is None or each.end > core.now_ticks
            ]
            assert len(on_their_way) < sent._depth
            for valid in range(max(0, number - 1), number + 1):
                assert np.array_equal(ring[valid].array, frame.rows[valid].array)
            yield core.run(copy, source, target)
            out.send()
        yield from out.flush()
        written.append(np.stack([row.array for row in core.rows("image")]))

    board = load(every_frame(work), every_frame(work))
    board.ahead = None  # a core's clock is where its firmware is then
    board.run(noise(2))
    for picture, (left, right) in zip(noise(2), zip(written[::2], written[1::2], strict=True), strict=True):
        assert {left.tobytes(), right.tobytes()} == {picture.left.tobytes(), picture.right.tobytes()}


@pytest.mark.parametrize("ahead", [True, False])
def test_every_row_of_a_ring_must_be_as_long_as_its_line(ahead: bool) -> None:
    """Not the first ones alone: a copy would write over what lies behind."""

    def work(core: Core, frame: Frame) -> Play:
        short = core.part(frame.rows, 0, 4)
        ring = core.window_ring((frame.rows[0], short[1]), core.rows("in_ring"))
        if not ahead:
            core.on_interrupt("SUPPLEMENTAL_0", lambda _: None)
        yield from ring.line()
        yield from ring.line()

    with pytest.raises(
        FirmwareError,
        match=r"a row of camera must be as long as the one of in_ring that it is copied to \(32 bytes\), not 4 bytes",
    ):
        run(every_frame(work))


def test_a_row_that_is_too_short_is_told_when_it_is_copied() -> None:
    """One line ahead: the lines before that are there, for the copies of a ring are planned together."""
    lines = []

    def work(core: Core, frame: Frame) -> Play:
        short = core.part(frame.rows, 0, 4)
        ring = core.window_ring((*frame.rows[:4], short[4]), core.rows("in_ring"))
        for number in range(5):
            lines.append((yield from ring.line()))
            assert ring[number] is lines[-1]

    with pytest.raises(FirmwareError, match=r"\(32 bytes\), not 4 bytes(.|\n)*test_ring.py"):
        run(every_frame(work))
    assert len(lines) == 3
