"""The work of a frame as the bus of another board plays it: operations, stretch by stretch, and the accesses that they refer to."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import EventSpec
from bfsim.kernel import access_trace as log
from bfsim.kernel.native import native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.retiming.work import (
    BYTE,
    CALL,
    KIND,
    OWNER,
    SITE,
    STAMP,
    Accesses,
    FrameWork,
    Table,
)


@dataclass(frozen=True, slots=True)
class Stretch:
    """Operations up to the next call of firmware. `calls`: where those are that run a kernel which may have accesses, and its number.

    `accesses`: the log of these, a row of entries and one of sites.
    """

    operations: Table
    calls: tuple[NDArray[np.int64], NDArray[np.int64]]
    accesses: Table


@dataclass(frozen=True, slots=True)
class Translated:
    """A frame. `calls_at`: the numbers of the operations that are calls of its firmware."""

    operations: Table
    calls_at: list[int]
    log: Table
    _log_ends: NDArray[np.int64]  # of each operation, in the log
    _runs_at: NDArray[np.int64]  # the operations that run a kernel which may have accesses,
    _kernels: NDArray[np.int64]  # and which one each of them runs

    def stretches(self) -> Iterator[list[Stretch]]:
        """Yield what is done before each call of firmware, and after the last one; most often that is one stretch."""
        begin = 0
        for end in (*self.calls_at, len(self.operations)):
            firsts = range(begin, end, w.MAX_OPERATIONS)
            yield [self._stretch(first, min(first + w.MAX_OPERATIONS, end)) for first in firsts]
            begin = end + 1

    def _stretch(self, first: int, last: int) -> Stretch:
        log_first = int(self._log_ends[first - 1]) if first else 0
        runs = slice(*np.searchsorted(self._runs_at, (first, last)))
        runs_at = self._runs_at[runs] - first
        operations = self.operations[first:last]
        operations[runs_at, 3:5] -= log_first
        return Stretch(
            operations,
            (runs_at, self._kernels[runs]),
            self.log[:, log_first : int(self._log_ends[last - 1])],
        )


IN_L1 = -1
"""Where an owner begins whose memory is in L1: what accesses it is not in the log."""

WRITE = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_void_p] * 3, ctypes.c_int64)


@native_entry("int64", "uint32*", "int64*", "int64*", "int64")
def write_log(accesses_at: Any, firsts_at: Any, log_at: Any, count: int) -> int:
    """Write the log of `count` accesses, a row of entries and one of sites as long; return how many are in it.

    The arrays: columns of accesses one after the other, where the memory of each owner begins or IN_L1, and the log.
    """
    accesses, firsts, written = words_at(accesses_at), words_at(firsts_at), words_at(log_at)
    kept = 0
    for number in range(count):
        first = firsts[accesses[OWNER * count + number]]
        if first != IN_L1:
            stamp, kind = accesses[STAMP * count + number], accesses[KIND * count + number]
            place = first + accesses[BYTE * count + number]
            written[kept] = stamp << log.STAMP_BIT | kind << log.KIND_BIT | place
            written[count + kept] = accesses[SITE * count + number]
            kept += 1
    return kept


def _logged(accesses: Accesses, firsts: NDArray[np.int64]) -> Table:
    """Return the log of accesses for a board: a row of entries and one of sites."""
    columns, written = np.ascontiguousarray(accesses.T), np.empty((2, len(accesses)), np.int64)
    arrays = (ctypes.c_void_p(each.ctypes.data) for each in (columns, firsts, written))
    return written[:, : WRITE(write_log.address())(*arrays, len(accesses))]


def translated(
    work: FrameWork,
    firsts: NDArray[np.int64],
    outside: NDArray[np.bool_],
    copies_made: Table,
    events: EventSpec,
) -> Translated:
    """Return the operations of a frame for a board.

    `firsts`: where in the arena the memory of each owner begins, and `outside`: whether it is outside of L1. `copies_made`: what is
    behind COPY for each copy, in the order of their first use. `events`: what the board's cores take for registers.
    """
    operations, kinds = np.ascontiguousarray(work.operations), work.operations[:, 0]
    log_of_frame = _logged(work.accesses, np.where(outside, firsts, IN_L1))
    runs = np.flatnonzero(kinds == w.ACCESS)
    counts = np.zeros(len(kinds), np.int64)
    counts[runs] = work.operations[runs, 3]
    ends = np.cumsum(counts)
    log_ends, begins = ends, ends[runs] - counts[runs]
    if log_of_frame.shape[1] < len(work.accesses):
        kept = np.concatenate([[0], np.cumsum(outside[work.accesses[:, OWNER]])])
        log_ends, begins = kept[ends], kept[begins]
    operations[runs, 3], operations[runs, 4] = begins, log_ends[runs]
    setups = np.flatnonzero(kinds == w.SET_UP)
    _, writes, reads, accounts, _ = work.operations[setups].T
    operations[setups, 1] = writes * events.mmr_write_cclk + reads * events.mmr_read_cclk
    operations[setups, 2] = accounts
    copies = np.flatnonzero(kinds == w.COPY)
    operations[copies, 1:4] = copies_made[work.operations[copies, 1]]
    return Translated(
        operations,
        np.flatnonzero(kinds == CALL).tolist(),
        log_of_frame,
        log_ends,
        runs,
        work.operations[runs, 4],
    )
