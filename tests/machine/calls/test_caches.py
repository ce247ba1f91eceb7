"""Caches: what the data cache asks of the memories, counted beside a model in plain Python, and what an LDF switches on."""

from __future__ import annotations

import re
from collections import OrderedDict
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.api import Buffer, Core, Frame, i32, kernel, u8
from bfsim.chip.boards import CM_BF561
from bfsim.errors import FirmwareError, LinkError, MmrError
from bfsim.linker import LinkerScript, link
from bfsim.machine.board import Board
from bfsim.machine.buffers import FrameSize
from bfsim.machine.calls.caches import caches_of
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.symbols import symbols_of
from bfsim.trace import BoardRecord, StallReason
from bfsim.trace.owner_costs import COLUMN_OF
from tests.machine.kernels import copy, fill, first, spin, total
from tests.machine.made_boards import CCLK_PER_SCLK, CHIP, assert_accounted, in_work, made_board, play
from tests.machine.placements import changed, shipped
from tests.machine.rig import Play, every_frame, noise, of_core, see_all, stage_of
from tinyphoon import tinyphoon

CACHE = CHIP.cache
LINE, WAYS = CACHE.line_bytes, CACHE.data_ways
NBYTES = 2 * CACHE.data_bytes_per_bank
SETS = NBYTES // (LINE * WAYS)
LINE_WORDS = LINE // 4
FAR = Buffer("far_image", i32, 5 * SETS * LINE_WORDS, "sdram_bank2")
"""Lines of five ways: more than the cache has."""
ORDER = Buffer("order", i32, 256, "L1_data_a")


@kernel
def visit(image: i32[:], order: i32[:], n: i32) -> i32:
    """Load the words of `image` that `order` names; of what is below zero, store them: ~word."""
    result = 0
    for i in range(n):
        place = order[i]
        if place >= 0:
            result += image[place]
        else:
            image[-1 - place] = i
    return result


class PlainCache:
    """Tags in plain Python: of each set the lines, the one used last at the end, and whether they were changed."""

    def __init__(self) -> None:
        self.sets: dict[int, OrderedDict[int, bool]] = {}
        self.fills = self.write_backs = 0

    def access(self, address: int, *, write: bool) -> None:
        """Use the line of an address: a miss brings it in, and writes a changed one back for it."""
        line = address // LINE
        lines = self.sets.setdefault(line % SETS, OrderedDict())
        if line not in lines:
            self.fills += 1
            if len(lines) == WAYS:
                self.write_backs += lines.popitem(last=False)[1]
            lines[line] = False
        lines[line] |= write
        lines.move_to_end(line)


def moved(outcome: BoardRecord, *, stored: bool) -> int:
    """Bytes that core A loaded from SDRAM, or stored there."""
    of = [each for each in outcome.traffic if (each.memory, each.master) == ("SDRAM", "core A")]
    return sum(each.written_bytes if stored else each.read_bytes for each in of)


def visits(
    streams: Sequence[Sequence[int]], ldf: LinkerScript, **made: Any
) -> tuple[BoardRecord, PlainCache]:
    """Visit words of SDRAM by kernels, a call for each stream; and let the plain cache do the same."""
    plain = PlainCache()

    def work(core: Core, frame: Frame) -> Play:
        image, order = core.array("far_image"), core.array("order")
        for stream in streams:
            order.array[: len(stream)] = stream
            yield core.run(visit, image, order, len(stream))
            for place in stream:
                plain.access(image.address + 4 * (place if place >= 0 else ~place), write=place < 0)
        yield core.run(spin, 100)  # the store buffer is emptied meanwhile
        yield from core.post("through")

    return play(every_frame(work), ldf=ldf, more=(FAR, ORDER), **made), plain


PLACES = st.builds(
    lambda way, line, word, write: ((way * SETS + line) * LINE_WORDS + word) ^ (-1 if write else 0),
    st.integers(0, 4), st.sampled_from([0, 1, SETS - 1]), st.sampled_from([0, LINE_WORDS - 1]), st.booleans(),
)  # fmt: skip


@settings(max_examples=40)
@given(st.lists(st.lists(PLACES, max_size=40), min_size=1, max_size=3))
def test_fills_and_write_backs_are_those_of_a_plain_cache(streams: list[list[int]]) -> None:
    """Whatever is loaded and stored: the same lines come, and the same changed ones go, also between calls."""
    outcome, plain = visits(streams, shipped("cache.ldf"))
    assert moved(outcome, stored=False) == plain.fills * LINE
    assert moved(outcome, stored=True) == plain.write_backs * LINE
    assert_accounted(outcome)


def test_a_line_costs_once() -> None:
    """The first word of a line stalls for the fill, the others are there; a second walk finds all of them."""
    times = []

    def work(core: Core, frame: Frame) -> Play:
        order = core.array("order")
        for walk in ([0], [1, 2, 3, 4, 5, 6, 7], [LINE_WORDS], [0, LINE_WORDS]):
            order.array[: len(walk)] = walk
            times.append((yield from timed(core, walk)))

    def timed(core: Core, walk: Sequence[int]) -> Play:
        stalls, fill = core._parts.clock.accounts.now.kernels.row, COLUMN_OF[StallReason.CACHE_FILL]
        before = stalls[fill]
        yield core.run(visit, core.array("far_image"), core.array("order"), len(walk))
        return stalls[fill] - before

    board = made_board(in_work(work), ldf=shipped("cache.ldf"), more=(FAR, ORDER))
    board.ahead = None  # a core has its stalls when its firmware looks then
    outcome = board.run(noise(1))
    sdram = CM_BF561.sdram
    hit_cclk = (CHIP.external.core_sync_sclk + sdram.nCL) * CCLK_PER_SCLK - 1
    assert times == [hit_cclk + sdram.nRCD * CCLK_PER_SCLK, 0, hit_cclk, 0]
    cost = stage_of(outcome.frames[0], "Work")
    assert cost.stall_cclk[StallReason.CACHE_FILL] == sum(times)


def test_without_a_cache_every_word_is_an_access() -> None:
    """The thesis's LDF has its caches off."""
    outcome, _ = visits([[0, 1, 1, ~1]], shipped("thesis.ldf"))
    assert moved(outcome, stored=False) == 3 * 4
    assert moved(outcome, stored=True) == 4


@pytest.mark.parametrize(("bank", "written_nbytes"), [(2, 3 * 4), (1, 0)])
def test_a_segment_that_is_written_through(bank: int, written_nbytes: int) -> None:
    """Every store to it goes to SDRAM as a word, and brings no line in; elsewhere the changed lines stay in the cache."""
    outcome, _ = visits([[~0, ~1, ~0]], shipped("cache.ldf"), write_through=(f"MEM_SDRAM_BANK{bank}",))
    assert moved(outcome, stored=True) == written_nbytes
    assert moved(outcome, stored=False) == (0 if written_nbytes else LINE)


@pytest.mark.parametrize("name", ["MEM_SDRAM_BANK9", "MEM_L2"])
def test_only_sdram_is_written_through(name: str) -> None:
    """What is not cached, or not there, is refused by name."""
    with pytest.raises(
        FirmwareError, match=rf"^write_through must name .* MEM_SDRAM_BANK2, .*, not '{name}'$"
    ):
        play(see_all, ldf=shipped("cache.ldf"), write_through=(name,))


def test_l2_is_not_cached() -> None:
    """Each load of the shared word goes to L2, as often as it is made."""

    def work(core: Core, frame: Frame) -> Play:
        for _ in range(3):
            yield core.run(total, core.array("in_l2"))

    outcome = play(in_work(work), ldf=shipped("cache.ldf"))
    (l2,) = [each for each in outcome.traffic if each.memory == "L2"]
    assert l2.read_bytes == 3 * 4096
    assert StallReason.CACHE_FILL not in stage_of(outcome.frames[0], "Work").stall_cclk


def test_a_new_picture_is_read_anew() -> None:
    """DMA writes past the cache, so its lines are invalidated: each frame fills them all again, and pays the loop."""

    def work(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            for row in frame.rows:
                yield core.run(first, row)
                yield core.run(first, row)

    outcome = play(every_frame(work), ldf=shipped("cache.ldf"), frames=5)
    lines = 8 * 32 // LINE
    for frame in outcome.frames:
        assert of_core(frame, "A").stages[-1].issue_cclk == lines * CACHE.invalidate_cclk
    assert moved(outcome, stored=False) == 5 * lines * LINE


def test_without_a_cache_nothing_is_invalidated() -> None:
    """No loop, no cycles."""
    (frame,) = play(see_all, ldf=shipped("thesis.ldf")).frames
    assert of_core(frame, "A").stages[-1].issue_cclk == 0


# ---- rings become rows


def test_rings_become_the_image_s_rows() -> None:
    """Kernels get the picture's lines where they are, and no DMA moves any."""
    seen = []

    def work(core: Core, frame: Frame) -> Play:
        image = core.rows("image")
        ring, out = core.input_ring(frame.rows, "in_ring"), core.output_ring("out_ring", image)
        for number in range(frame.height):
            line, target = (yield from ring.line()), (yield from out.row())
            seen.append((line is frame.rows[number], target is image[number], ring[number] is line))
            yield core.run(copy, line, target)
            out.send()
        yield from out.flush()

    outcome = play(every_frame(work), ldf=shipped("cache.ldf"))
    assert seen == [(True, True, True)] * 8
    assert {each.master for each in outcome.traffic} == {"PPI0", "PPI1", "core A"}


@pytest.mark.parametrize(
    ("way", "message"),
    [
        ("line", "camera has no line 8: the picture has 8"),
        ("item", "line 3 of camera was not taken yet, but 1 lines"),
        ("row", "the picture image has 8 lines; one more was asked for"),
        ("unsent", "line 0 of image must be sent when it is written: `ring.send()`"),
        ("unsent last", "line 1 of image must be sent when it is written: `ring.send()`"),
    ],
)
def test_cached_lines_are_as_strict_as_rings(way: str, message: str) -> None:
    """A line too many, or one that was not taken or sent, is told."""

    def work(core: Core, frame: Frame) -> Play:
        ring, out = core.input_ring(frame.rows, "in_ring"), core.output_ring("out_ring", core.rows("image"))
        yield from ring.line()
        if way == "item":
            _ = ring[3]
        for _ in range(8):
            if way == "unsent":
                yield from out.row()
            elif way == "unsent last":
                yield from out.row()
                out.send()
                yield from out.row()
                yield from out.flush()
            elif way == "line":
                yield from ring.line()
            else:
                yield from out.row()
                out.send()
        yield from out.row()

    with pytest.raises(FirmwareError, match=f"{re.escape(message)} .*test_caches.py:"):
        play(every_frame(work), ldf=shipped("cache.ldf"))


def seen_by_tinyphoon(ldf: str, size: FrameSize) -> tuple[dict[str, bytes], BoardRecord]:
    """Run the vision firmware; return what is in its buffers then, and the run."""
    spec = CM_BF561
    link_map = link(shipped(ldf), symbols_of(tinyphoon, size), spec.chip.regions)
    board = Board(spec, tinyphoon, size, link_map)
    outcome = board.run(noise(2, size))
    names = (
        "colour_image",
        "edge_image",
        "opened_image",
        "edge_data",
        "right_edge_data",
        "edge_index",
        "edge_counts",
        "results",
    )
    return {
        f"{name} {core}": b"".join(row.octets.tobytes() for row in rows[name])
        for core, rows in board._buffers.of.items()
        for name in names
        if name in rows
    }, outcome


@pytest.mark.exhaustive
@pytest.mark.parametrize("ldf", ["cache.ldf", "l2.ldf", "sdram.ldf"])
def test_the_placement_changes_cycles_and_no_pixel(ldf: str) -> None:
    """Every shipped placement: the same images, edges and messages as the thesis's, at another price."""
    size = FrameSize(64, 24)
    expected, reference = seen_by_tinyphoon("thesis.ldf", size)
    seen, outcome = seen_by_tinyphoon(ldf, size)
    assert seen == expected
    assert [each.results for each in outcome.frames] == [each.results for each in reference.frames]
    assert outcome.frames[0].result_cclk != reference.frames[0].result_cclk
    assert_accounted(outcome)


# ---- what the LDF may place


def test_nothing_may_lie_in_what_the_ldf_makes_a_cache() -> None:
    """A bank of 32 KB with the cache on: a buffer that reaches into its upper half."""
    ldf = changed("cache.ldf", ("#define DATA_BANK_LENGTH 16K", "#define DATA_BANK_LENGTH 32K"))
    large = Buffer("large", u8, 20_000, "L1_data_a")
    with pytest.raises(
        LinkError,
        match=r"'large' of p0 \(section L1_data_a\) must lie outside of 0xFF804000-0xFF807FFF of .*, which the LDF makes a cache",
    ):
        play(see_all, ldf=ldf, more=(large,))


def test_what_is_beside_the_cache_may_stay() -> None:
    """The same LDF with what fits into the lower half."""
    ldf = changed("cache.ldf", ("#define DATA_BANK_LENGTH 16K", "#define DATA_BANK_LENGTH 32K"))
    assert len(play(see_all, ldf=ldf, more=(Buffer("small", u8, 5_000, "L1_data_a"),)).frames) == 1


def test_dma_into_the_cache_is_flagged() -> None:
    """The cache's half of the bank is no target."""

    def work(core: Core, frame: Frame) -> Play:
        dma = core.memory_dma("MDMA1_0")
        source = core.array("in_sdram").address
        registers = {"X_COUNT": 4, "X_MODIFY": 4}
        dma.program(
            source={"START_ADDR": source, **registers}, destination={"START_ADDR": 0xFF80_4000, **registers}
        )
        yield from dma.start(DmaConfig(), DmaConfig(WNR=True))

    with pytest.raises(
        MmrError, match="MDMA1_D0_START_ADDR: .* must stay out of 0xFF804000..0xFF807FFF, which is cache"
    ):
        play(every_frame(work), ldf=shipped("cache.ldf"))
    play(every_frame(work), ldf=shipped("thesis.ldf"))


@pytest.mark.parametrize(
    ("off", "data", "code", "nbytes"),
    [
        ((), ("L1_DATA_A", "L1_DATA_B"), True, NBYTES),
        (("___l1_data_cache_b",), ("L1_DATA_A",), True, NBYTES // 2),
        (("___l1_data_cache_a", "___l1_data_cache_b"), (), True, None),
        (("___l1_code_cache",), ("L1_DATA_A", "L1_DATA_B"), False, NBYTES),
    ],
)
def test_each_cache_has_a_symbol_of_its_own(
    off: Sequence[str], data: tuple[str, ...], code: bool, nbytes: int | None
) -> None:
    """16 KB of one bank, 32 KB of both, or none."""
    ldf = changed("cache.ldf", *((f"{each} = CACHES;", f"{each} = 0;") for each in off))
    link_map = link(ldf, [], CM_BF561.chip.regions)
    for processor in ("p0", "p1"):
        caches = caches_of(link_map, processor)
        assert (caches.data, caches.code) == (data, code)
        size = caches.data_size(CACHE)
        assert (size.nbytes if size else None) == nbytes


@settings(max_examples=10)
@given(st.integers(0, 2**31 - 2000))
def test_values_do_not_depend_on_the_cache(value: int) -> None:
    """What is stored through the cache is loaded again, by this core at least."""
    sums: list[Any] = []

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(fill, core.array("in_sdram"), value)
        sums.append((yield core.run(total, core.array("in_sdram"))))

    play(every_frame(work), ldf=shipped("cache.ldf"))
    expected = int(np.arange(value, value + 1024, dtype=np.int64).sum())
    assert sums[0] == (expected + 2**31) % 2**32 - 2**31
