"""Buffers for smaller pictures over the memory of the full ones, and parts of rows: what lies where, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bfsim.api import Buffer, Core, FirmwareError, Frame, FrameSize, u8, u16
from bfsim.machine.core.buffers import layouts
from bfsim.machine.core.buffers.layouts import Layouts
from tests.machine.kernels import first
from tests.machine.made_boards import play
from tests.machine.rig import SIZE, Play, every_frame

HALF = FrameSize(SIZE.width_px // 2, SIZE.height_px // 2)
TABLE = Buffer("table", u8, 4, "L1_data_a", values=np.arange(4))


def in_frame(body: Any, **made: Any) -> None:
    """Let core A do `body(core, frame)` in a frame."""

    def work(core: Core, frame: Frame) -> Play:
        body(core, frame)
        yield core.run(first, frame.rows[0])

    play(every_frame(work), **made)


def test_buffers_of_a_smaller_size_lie_at_the_beginning_of_the_full_ones() -> None:
    """Row behind row; what does not depend on the size is the same. Back at the full size all is as before."""

    def body(core: Core, frame: Frame) -> None:
        full, words, table = core.rows("image"), core.array("words"), core.array("table")
        core.use_size(HALF)
        small = core.rows("image")
        assert [(each.address - full[0].address, each.nbytes) for each in small] == [
            (number * SIZE.width_px, SIZE.width_px) for number in range(HALF.height_px)
        ]
        assert core.rows("image") is small, "calls with them are prepared once"
        assert (core.array("words"), core.array("table")) == (words, table)
        assert len(core.overlay("image", u16, 2)) == HALF.height_px * SIZE.width_px // 4
        core.use_size(SIZE)
        assert core.rows("image") is full
        assert len(core.overlay("image", u16, 2)) == SIZE.height_px * SIZE.width_px // 2

    in_frame(body, more=(TABLE,))


def test_the_only_row_of_a_buffer_is_that_of_the_present_size() -> None:
    """Firmware may have asked for it before, in either size."""

    def body(core: Core, frame: Frame) -> None:
        for size in (SIZE, HALF, HALF, SIZE, HALF):
            core.use_size(size)
            assert core.array("single_row").nbytes == 2 * size.width_px
            assert core.array("single_row") is core.array("single_row") is core.rows("single_row")[0]

    in_frame(body)


def test_a_larger_size_is_refused() -> None:
    """There is nothing behind a buffer."""
    large = FrameSize(SIZE.width_px, SIZE.height_px + 1)
    with pytest.raises(
        FirmwareError, match=f"must be no table and fit into its memory at {SIZE} .* of {large}"
    ):
        in_frame(lambda core, frame: core.use_size(large))


def test_a_part_of_rows_is_the_same_memory() -> None:
    """Some elements of each; all of them are the row itself."""

    def body(core: Core, frame: Frame) -> None:
        rows = core.rows("wide_image")[1:3]
        part = core.part(rows, 2, 3)
        assert [(each.address, each.offset, each.nbytes) for each in part] == [
            (row.address + 4, row.offset + 4, 6) for row in rows
        ]
        rows[1].array[2:5] = 7, 8, 9
        assert part[1].array.tolist() == [7, 8, 9]
        assert core.part(rows, 2, 3) == part
        assert core.part(rows, 0, SIZE.width_px) == rows

    in_frame(body)


def test_rows_of_a_part_are_the_same_however_many_others_there_were(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few parts are remembered, for what moves has others in each frame; calls and copies with their rows are prepared once."""
    monkeypatch.setattr(layouts, "MOST_PARTS", 4)
    known: list[Layouts] = []
    part = Layouts.part
    monkeypatch.setattr(Layouts, "part", lambda self, *what: known.append(self) or part(self, *what))

    def body(core: Core, frame: Frame) -> None:
        rows = core.rows("wide_image")
        before = core.part(rows[1:3], 2, 3)
        for number in range(9):
            core.part(rows[number % 4 :], 1, 1 + number % 2)
            assert len(known[0]._parts) <= 4
        after = core.part(rows[1:3], 2, 3)
        assert all(one is other for one, other in zip(before, after, strict=True))

    in_frame(body)


@pytest.mark.parametrize(("start", "count"), [(-1, 2), (0, 0), (0, SIZE.width_px + 1), (SIZE.width_px, 1)])
def test_a_part_must_lie_in_its_rows(start: int, count: int) -> None:
    """Nothing before them, behind them, or of no length."""
    with pytest.raises(
        FirmwareError, match=f"a part of rows of {SIZE.width_px} elements must lie in them, not at {start}"
    ):
        in_frame(lambda core, frame: core.part(core.rows("wide_image"), start, count))


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (
            lambda core: core.part("image", 0, 4),
            r"core\.part\(rows, first, count\) must get rows such as frame\.rows and two int",
        ),
        (lambda core: core.part(core.rows("image"), "0", 4), r"two integers, not \(.*'0', 4\)"),
        (
            lambda core: core.use_size((8, 4)),
            r"core\.use_size must get a bfsim\.api\.FrameSize, not \(8, 4\)",
        ),
    ],
)
def test_what_is_no_part_and_no_size_is_told(ask: Any, message: str) -> None:
    """Each was an error of Python's in a line of bfsim's."""
    with pytest.raises(FirmwareError, match=message):
        in_frame(lambda core, frame: ask(core))


def test_remarks_are_in_the_record_of_their_frame() -> None:
    """With the core that made them, in order."""

    def work(core: Core, frame: Frame) -> Play:
        if frame.index == 1:
            core.remark("is tired")
            core.remark("goes on")
        yield core.run(first, frame.rows[0])

    outcome = play(every_frame(work), every_frame(work), frames=3)
    said = ("core A is tired", "core A goes on", "core B is tired", "core B goes on")
    assert [each.remarks for each in outcome.frames] == [(), said, ()]
