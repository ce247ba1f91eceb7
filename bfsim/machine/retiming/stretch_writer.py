"""What was recorded of a frame, written for a board: each stretch by one call of machine code (`written_stretch`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.block_spec import EventSpec
from bfsim.machine.retiming.packed_work import COLUMN_WORDS, PACKED_COLUMNS, WIDTHS, PackedWork
from bfsim.machine.retiming.work import Table
from bfsim.machine.retiming.written_stretch import (
    ACCESS_ROWS,
    ACCOUNTS,
    COPIES,
    EVENT_ROWS,
    FRAME_WORDS,
    MMR_READ,
    MMR_WRITE,
    NO_CODE,
    NO_ROOM,
    NOT_THERE,
    ODD,
    OWNERS,
    ROWS,
    write_stretch,
)
from bfsim.machine_code.built_in import built_in

PROBLEMS = {
    NOT_THERE: "a call, a copy, an account, a counter or memory that is not there",
    NO_CODE: "code is fetched from where none lies",
    NO_ROOM: "more accesses than a core has room for",
    ODD: "a number that is out of its range",
}


class StretchWriter:
    """Writes the stretches of one frame's `work` into the `state` of a bus, its words, for a core.

    `firsts`: where in the arena the memory of each owner begins, IN_L1 for what lies there; `copies`: rows of what is behind COPY for
    each copy; `accounts`: how many there are; `events`: what the core takes for registers.
    """

    def __init__(
        self, state: Any, core: int, work: PackedWork, firsts: NDArray[np.int64], copies: Table, accounts: int, events: EventSpec
    ) -> None:  # fmt: skip
        words = np.zeros(FRAME_WORDS + PACKED_COLUMNS * COLUMN_WORDS, np.int64)
        words[[ROWS, ACCESS_ROWS, EVENT_ROWS]] = (
            work.rows["operations"], work.rows["accesses"], work.rows["events"],
        )  # fmt: skip
        words[[COPIES, ACCOUNTS, OWNERS]] = len(copies), accounts, len(firsts)
        words[[MMR_WRITE, MMR_READ]] = events.mmr_write_cclk, events.mmr_read_cclk
        words[FRAME_WORDS:] = work.columns.reshape(-1)
        octets = np.frombuffer(work.octets, np.int8)
        self._kept: tuple[NDArray[Any], ...] = (words, *[octets] * len(WIDTHS), firsts, copies)
        self._write = built_in(
            write_stretch.address(), 4, np.asarray(state).ctypes.data, core, *(each.ctypes.data for each in self._kept)
        )  # fmt: skip

    def write(self, kinds_at: int, calls: int, counters_at: int, counters: int) -> int:
        """Write the next stretch and return how many operations it has: if fewer than it can have, all up to the next call of firmware.

        The addresses of arrays, and how many they have: of each call that is prepared by now, what running it is to the bus; and the
        core's counters, which count what its kernels have until that call. Raises ValueError for what is not there.
        """
        written = self._write(kinds_at, calls, counters_at, counters)
        if written < 0:
            raise ValueError(PROBLEMS[written])
        return written
