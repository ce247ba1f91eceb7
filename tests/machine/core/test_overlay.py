"""Rows of another kind over the memory of a buffer: the same bytes at the same addresses."""

from __future__ import annotations

import numpy as np
import pytest

from bfsim.api import Buffer, u8, u16, u32
from bfsim.chip.boards import CM_BF561
from bfsim.errors import FirmwareError
from bfsim.linker import Placement, Symbol
from bfsim.machine.memories import Memories, Row

START = 0xFF800000


def placed() -> tuple[Memories, tuple[Row, ...]]:
    """A buffer of 2 rows of 5 words in L1, with the bytes 0 to 39."""
    values = np.arange(40, dtype=np.uint8).view(np.uint32)
    memories = Memories(CM_BF561)
    buffer = Buffer("idle", u32, 5, "L1_data_a", rows=2, values=values)
    symbol = Symbol(name=buffer.name, section=buffer.section, nbytes=buffer.nbytes, processor="p0")
    return memories, memories.place(buffer, Placement(symbol, "", "", START, 0))


def test_rows_lie_over_the_whole_buffer_and_what_is_left_over_is_in_none() -> None:
    """Three rows of six half-words take 36 of 40 bytes, across the buffer's own rows."""
    memories, rows = placed()
    over = memories.overlay(rows, u16, 6)
    assert [each.address - START for each in over] == [0, 12, 24]
    assert [each.offset - rows[0].offset for each in over] == [0, 12, 24]
    assert [each.array.view(np.uint8).tolist() for each in over] == [
        list(range(first, first + 12)) for first in (0, 12, 24)
    ]
    assert (over[0].buffer, over[0].memory) == (rows[0].buffer, rows[0].memory)


def test_what_is_written_over_a_buffer_is_in_it() -> None:
    """An overlay is the memory itself, for kernels and for DMA."""
    memories, rows = placed()
    memories.overlay(rows, u8, 20)[1].array[:] = 255
    assert rows[0].array[0] == 0x03020100
    assert set(rows[1].array.tolist()) == {0xFFFFFFFF}


def test_row_longer_than_the_buffer_is_refused() -> None:
    """There is nothing behind a buffer that a row could use."""
    memories, rows = placed()
    with pytest.raises(FirmwareError, match="a row over buffer idle must have 1 to 20 elements, not 21"):
        memories.overlay(rows, u16, 21)


def test_elements_of_python_are_refused() -> None:
    """`int` is no type of the chip's memory; that it has no `nbytes` was all that was said."""
    memories, rows = placed()
    with pytest.raises(
        FirmwareError, match="a row over a buffer must have elements such as u8, not <class 'int'"
    ):
        memories.overlay(rows, int, 5)  # type: ignore[arg-type]
