"""Transfers in two dimensions: every element goes where plain Python puts it, and no other byte changes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bfsim.errors import FirmwareError
from bfsim.machine.bus import state as w
from bfsim.machine.bus.transfer_plans import Walk
from tests.machine.bench import Bench
from tests.tiers import tried

# From the middle of each of these the longest walk stays within it.
ROOM = 8192
PLACES = {
    "SDRAM": 0x0001_0000,
    "another bank": 0x0081_0000,
    "L2": 0xFEB0_4000,
    "L1": 0xFF80_2000,
    "L1 of core B": 0xFF40_2000,
}
COUNTS = (1, 2, 5, 12, 30, 48)


@dataclass(frozen=True)
class Side:
    """A walk through memory, in elements instead of bytes."""

    place: str
    shift: int
    x_count: int
    x_modify: int
    y_modify: int

    def walk(self, bench: Bench, size: int) -> Walk:
        """Return the walk from the middle of its memory."""
        first = bench.row(PLACES[self.place], ROOM).offset + ROOM // 2
        return Walk(first + self.shift * size, self.x_count, self.x_modify * size, self.y_modify * size)


def offsets(walk: Walk, count: int) -> list[int]:
    """Where each element lies: behind the last one of a line Y_MODIFY stands in for X_MODIFY."""
    found, at = [], walk.offset
    for number in range(1, count + 1):
        found.append(at)
        at += walk.y_modify if number % walk.x_count == 0 else walk.x_modify
    return found


@st.composite
def copies(draw: st.DrawFn) -> tuple[Side, Side, int]:
    """Two walks of as many elements in two places, whole lines of each: forwards, backwards, on the spot."""
    count = draw(st.sampled_from(COUNTS))
    lines = st.sampled_from([each for each in range(1, count + 1) if count % each == 0])
    modify = st.integers(-9, 9)
    source, target = (
        draw(st.builds(Side, st.sampled_from(places), st.integers(0, 7), lines, modify, modify))
        for places in (("SDRAM", "L2", "L1"), ("another bank", "L1 of core B"))
    )
    return source, target, count


@tried(60, 200)
def test_every_element_arrives_and_nothing_else_changes(examples: int) -> None:
    """Of 1, 2 or 4 bytes, by any strides, from any memory to any other: compared with a copy in plain Python."""

    @settings(max_examples=examples)
    @given(
        walks=copies(),
        size=st.sampled_from([1, 2, 4]),
        master=st.sampled_from([w.MDMA1_0, w.MDMA2_1, w.IMDMA_0]),
    )
    def holds(walks: tuple[Side, Side, int], size: int, master: int) -> None:
        bench = Bench()
        source, target, count = walks
        inward, outward = source.walk(bench, size), target.walk(bench, size)
        around = bench.row(PLACES[target.place], ROOM)
        expected = around.array.copy()
        for one, other in zip(offsets(inward, count), offsets(outward, count), strict=True):
            at = other - around.offset
            expected[at : at + size] = bench.memories.bytes_from(one, size)
        plan = bench.bus.planner.copy(master, inward, outward, count, element_bytes=size, setup=0)
        (end,) = bench.ends(bench.bus.post(plan))
        assert np.array_equal(around.array, expected)
        assert end >= count * (bench.cclk(2) if master == w.IMDMA_0 else bench.sclk(1))
        in_sdram, in_l2 = (bench.traffic(master, each) for each in (w.NO_BUFFER_IN_SDRAM, w.NO_BUFFER_IN_L2))
        assert in_sdram.read_bytes == count * size * (source.place == "SDRAM")
        assert in_l2.read_bytes == count * size * (source.place == "L2")
        assert in_sdram.written_bytes == count * size * (target.place == "another bank")
        assert in_l2.written_bytes == 0

    holds()


def test_a_picture_is_cut_out_turned_round_and_put_elsewhere() -> None:
    """8 of 16 columns, the last line first, as a mirror does with a part of a picture."""
    bench = Bench()
    picture, part = bench.row(PLACES["SDRAM"], 128), bench.row(PLACES["L1"], 64)
    plan = bench.bus.planner.copy(
        w.MDMA1_0,
        Walk(picture.offset + 7 * 16 + 4, 8, 1, -16 - 7),
        Walk(part.offset, 8, 1, 1),
        64,
        element_bytes=1,
        setup=0,
    )
    bench.ends(bench.bus.post(plan))
    assert np.array_equal(part.array.reshape(8, 8), picture.array.reshape(8, 16)[::-1, 4:12])


@pytest.mark.parametrize("shift", range(4))
@pytest.mark.parametrize("nbytes", range(1, 10))
def test_rows_at_any_address_leave_their_neighbours_alone(shift: int, nbytes: int) -> None:
    """Canaries on both sides of a short row stay what they are, whatever element the row is copied in."""
    bench = Bench()
    source = bench.row(PLACES["SDRAM"] + 3 - shift, nbytes)
    around = bench.row(PLACES["L1"], 32)
    around.array[:] = 0xA5
    target = bench.row(PLACES["L1"] + 8 + shift, nbytes)
    target.array[:] = 0
    bench.ends(bench.stream.copy(source, target, 0))
    assert np.array_equal(target.array, source.array)
    canaries = np.delete(around.array, range(8 + shift, 8 + shift + nbytes))
    assert (canaries == 0xA5).all()


def test_the_end_of_each_line_can_wake_somebody() -> None:
    """An interrupt per row: four lines of 40 words, a line's time apart; the last one is the end."""
    bench = Bench()
    source, target = bench.row(PLACES["L1"], 640), bench.row(PLACES["SDRAM"], 640)
    walk = Walk(source.offset, 40, 4, 4), Walk(target.offset, 40, 4, 4)
    transfer = bench.bus.post(bench.bus.planner.copy(w.MDMA1_0, *walk, 160, element_bytes=4, setup=0))
    bench.bus.words[w.TRANSFERS_AT + transfer.place * w.TRANSFER_WORDS + w.WAKE] = w.AT_ROWS
    bench.bus._ends.of_transfer(transfer.number)
    ends = []
    for _ in range(4):
        bench.bus._ends.of_transfer(transfer.number)
        assert bench.bus.play_until(w.NEVER)
        ends.append(bench.bus.words[w.DONE_AT] // bench.sclk(1))
    opening = bench.spec.sdram.nRCD
    assert ends == [opening + 40 * line for line in range(1, 5)]
    assert transfer.end == bench.sclk(ends[-1])


def test_sub_banks_are_counted_word_by_word() -> None:
    """A row with half of its words in one sub-bank of 4 KB and half in the next."""
    bench = Bench()
    source, target = bench.row(PLACES["SDRAM"], 1024), bench.row(PLACES["L1"] + 4096 - 512, 1024)
    bench.ends(bench.stream.copy(source, target, 0))
    first = w.SUBBANKS_AT + (target.offset - bench.memories.l1) // 4096
    assert bench.bus.words[first : first + 2].tolist() == [128, 128]


def test_a_part_of_a_line_is_refused() -> None:
    """X_COUNT 9 on one side and two elements in all is no transfer that a descriptor can ask for."""
    bench = Bench()
    source, target = (Walk(bench.offset(PLACES[each]), 9, 4, 4) for each in ("SDRAM", "L1"))
    with pytest.raises(FirmwareError):
        bench.bus.planner.copy(w.MDMA1_0, source, target, 2, element_bytes=4, setup=0)
