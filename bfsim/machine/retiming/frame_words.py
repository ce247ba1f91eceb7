"""How far one frame's `PackedWork` has been read, for compiled code: words of one array, followed by the positions of its columns."""

from __future__ import annotations

from collections.abc import MutableSequence

from bfsim.kernel.native.entries import native
from bfsim.machine.retiming.packed_work import BEGIN, COLUMN_WORDS, PACKED_COLUMNS, WIDTH

NOT_THERE, NO_CODE, NO_ROOM, ODD = -1, -2, -3, -4
"""Returned instead of a number of operations: something referred to is missing, code is missing, the log is full, or a number is odd."""

(
    ROWS, NEXT,        # operations of the frame, and the next one to write
    ACCESS_ROWS, ACCESS, PLACE,    # the same for accesses, and the byte of the last one
    EVENT_ROWS, EVENT, COUNTER,    # the same for rows of events, and the counter of the last one
    PASSED,            # the mark up to which events are counted
    COPIES, ACCOUNTS, OWNERS, STAGES,  # how many there are of each so far
    MMR_WRITE, MMR_READ,  # cycles of a core for a register
    IS_AT_CALL,        # whether a call of firmware follows what was written last
    COPY,              # the copy that was written last
    OPERATION_DICTIONARY_ROWS, ACCESS_DICTIONARY_ROWS,  # entries of both; their words are from DICTIONARIES_AT on (`laid_dictionaries`)
) = range(19)  # fmt: skip
FRAME_WORDS = 19
DICTIONARIES_AT = FRAME_WORDS + PACKED_COLUMNS * COLUMN_WORDS
Words = MutableSequence[int]


@native
def at_column(frame: Words, number: int) -> tuple[int, int]:
    """Return where a column begins, and the number of its width."""
    at = FRAME_WORDS + number * COLUMN_WORDS
    return frame[at + BEGIN], frame[at + WIDTH]
