"""The calls of a core that machine code finds, compiled: by the addresses of the kernel and of the rows that firmware passes.

No other device can notice these calls, so they are made as soon as the firmware asks for them (`machine_code.asking`). Calls that
are not found here are looked up by Python, which adds them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bfsim.kernel import Kernel
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus.state import State

ALWAYS = -1
"""Instead of a turn: the call can be made in any."""

STAGE, FREE, COUNT = range(3)
"""Fields of the table: the stage whose calls are found, where the next call has room, and the number of calls."""
KERNELS_AT, MOST_KERNELS = 3, 1 << 9  # each kernel, and a bit for each argument that is a row
PLACES_AT, PLACES = (
    KERNELS_AT + 2 * MOST_KERNELS,
    1 << 13,
)  # where each call is: a hash table with linear probing
CALLS_AT, ROOM = PLACES_AT + PLACES, 1 << 16
OF_STAGE, TURN, NOTE, BLOCK, NUMBER, GIVEN, ARGUMENTS = range(7)
"""Fields of a call: its stage, the turn in which it can be made, three words that are the answer, the number of arguments, and the
kernel and its rows among the arguments, with 0 for numbers."""
MOST_ARGUMENTS = 32
SAME_BITS = 4
"""Low bits of an address that are the same for all objects."""


@native
def kernel_at(table: State, kernel: int) -> int:
    """Return where a kernel is, or the place for it."""
    place = kernel >> SAME_BITS & MOST_KERNELS - 1
    while table[KERNELS_AT + 2 * place] not in (0, kernel):
        place = place + 1 & MOST_KERNELS - 1
    return KERNELS_AT + 2 * place


@native
def place_of(table: State, arguments: State, count: int) -> int:
    """Return the place that says where a call is, or the first free place for it."""
    rows = table[kernel_at(table, arguments[0]) + 1]
    place = (arguments[0] >> SAME_BITS) + table[STAGE]
    for number in range(1, count):
        if rows >> number & 1:
            place = 31 * (place & PLACES - 1) + (arguments[number] >> SAME_BITS)
    place &= PLACES - 1
    while table[PLACES_AT + place] and not is_at(table, table[PLACES_AT + place], arguments, count):
        place = place + 1 & PLACES - 1
    return PLACES_AT + place


@native
def is_at(table: State, call: int, arguments: State, count: int) -> bool:
    """Whether a call is the one with these arguments."""
    if table[call + OF_STAGE] != table[STAGE] or table[call + GIVEN] != count:
        return False
    for number in range(count):  # noqa: SIM110  # numba knows no generator
        if table[call + ARGUMENTS + number] not in (0, arguments[number]):
            return False
    return True


@native_entry("int64", "int64*", "int64*", "int64", "int64")
def find_call(table_at: Any, arguments_at: Any, count: int, turn: int) -> int:
    """Return where the answer for a call is if it can be made in this turn, otherwise 0."""
    table, arguments = words_at(table_at), words_at(arguments_at)
    if not 0 < count <= MOST_ARGUMENTS:
        return 0
    call = table[place_of(table, arguments, count)]
    if call and table[call + TURN] in (ALWAYS, turn):
        return int(call + NOTE)
    return 0


class ReadyCalls:
    """The table of one core."""

    def __init__(self) -> None:
        self._table = np.zeros(CALLS_AT + ROOM, np.int64)
        self._words: Any = self._table.data
        self._words[FREE] = CALLS_AT
        self._stages: dict[str, int] = {}
        self._places: dict[int, int] = {}  # where each call is, by its number
        self._kernels = 0
        self.at: int = self._table.ctypes.data
        """Address of the table."""

    def enter(self, stage: str) -> None:
        """Find the calls of a stage from now on."""
        self._words[STAGE] = self._stages.setdefault(stage, len(self._stages))

    def lay(self, kernel: Kernel, arguments: Sequence[Any], turn: int, asked: Sequence[int]) -> None:
        """Add a call with the three words of its answer, `asked`. Kernel and rows must live as long as this table."""
        words, count = self._words, 1 + len(arguments)
        if call := self._places.get(asked[-1]):
            words[call + TURN] = turn
            return
        if count > MOST_ARGUMENTS:
            return
        if words[COUNT] == PLACES // 2 or words[FREE] + ARGUMENTS + count > len(words):
            self._clear()
        at = kernel_at(words, id(kernel))
        if not words[at]:
            if self._kernels == MOST_KERNELS // 2:
                return
            self._kernels += 1
            words[at], words[at + 1] = id(kernel), sum(2 << each for each in kernel.array_positions)
        told = [id(kernel), *map(id, arguments)]
        place = place_of(words, told, count)
        call = words[place] = self._places[asked[-1]] = words[FREE]
        words[FREE] += ARGUMENTS + count
        words[COUNT] += 1
        by_address = [each if words[at + 1] >> number & 1 else 0 for number, each in enumerate(told)]
        self._table[call : words[FREE]] = words[STAGE], turn, *asked, count, id(kernel), *by_address[1:]

    def _clear(self) -> None:
        """Begin anew: calls that are still needed are added again."""
        self._table[PLACES_AT:CALLS_AT] = 0
        self._words[FREE], self._words[COUNT] = CALLS_AT, 0
        self._places.clear()
