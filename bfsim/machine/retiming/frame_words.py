"""Where the reading of one frame's `PackedWork` is, for compiled code: words of one array, and behind them where its columns stand."""

from __future__ import annotations

from collections.abc import MutableSequence

from bfsim.kernel.native.entries import native
from bfsim.machine.retiming.packed_work import BEGIN, COLUMN_WORDS, PACKED_COLUMNS, WIDTH

NOT_THERE, NO_CODE, NO_ROOM, ODD = -1, -2, -3, -4
"""Returned in place of a number of operations: what one refers to is not there, or no code, no room for the log, or a number is none."""

(
    ROWS, NEXT,        # operations of the frame, and the next one to be written
    ACCESS_ROWS, ACCESS, PLACE,    # the same of accesses, and the byte of the last one,
    EVENT_ROWS, EVENT, COUNTER,    # and of rows of events, and the counter of the last one,
    PASSED,            # which are counted up to this mark
    COPIES, ACCOUNTS, OWNERS, STAGES,  # how many there are of each so far
    MMR_WRITE, MMR_READ,  # cycles of a core for a register
    IS_AT_CALL,        # whether a call of firmware comes behind what was written last
    COPY,              # the copy that was written last
    OPERATION_DICTIONARY_ROWS, ACCESS_DICTIONARY_ROWS,  # of both; the words of their entries are from DICTIONARIES_AT on (`laid_dictionaries`)
) = range(19)  # fmt: skip
FRAME_WORDS = 19
DICTIONARIES_AT = FRAME_WORDS + PACKED_COLUMNS * COLUMN_WORDS
Words = MutableSequence[int]


@native
def at_column(frame: Words, number: int) -> tuple[int, int]:
    """Return where a column begins, and the number of its width."""
    at = FRAME_WORDS + number * COLUMN_WORDS
    return frame[at + BEGIN], frame[at + WIDTH]
