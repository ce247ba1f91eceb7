"""Cameras on the bus, compiled: words that come while nobody else wants the bus, into pages that are open. Most requests are such.

What they do is what `dma_requests` and `sdram` would do with each; what cannot come up among them is left out.
"""

from __future__ import annotations

from bfsim.kernel.native import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.pacing import next_paced
from bfsim.machine.bus.sdram import hits_ahead
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.traffic import traffic_at
from bfsim.machine.bus.walk import WORD_BITS, WORD_BYTES

SLOW_SCLK = 4
"""A camera whose words are so far apart loses none, and none gets urgent, while it waits for a word of the other one."""


@native
def hits_of(state: State, number: int) -> int:
    """How many words of a PPI are sure to be hits, and to be followed by another one in their line: 0 where it does anything else."""
    master = w.MASTERS_AT + number
    if (
        state[master + w.TRANSFER] == w.NONE
        or state[master + w.USES] != w.SDRAM
        or state[master + w.FIFO] < 2
    ):
        return 0
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    if (
        state[transfer + w.MODE] != w.PACED_IN
        or state[transfer + w.ELEMENT_BITS] != WORD_BITS
        or state[w.WORD_BITS] != WORD_BITS
        or state[transfer + w.FROM] >= state[w.L1_FIRST]
        or state[transfer + w.FROM_X_MODIFY] != WORD_BYTES
        or state[transfer + w.TO_X_MODIFY] != WORD_BYTES
        or state[transfer + w.ELEMENT] < SLOW_SCLK * state[w.SCLK] * state[transfer + w.PARTS]
    ):
        return 0
    in_line = min(
        state[transfer + w.FROM_X_LEFT],
        state[transfer + w.TO_X_LEFT],
        state[transfer + w.LINE_ELEMENTS] - state[transfer + w.PLACE],
    )
    return min(hits_ahead(state, state[transfer + w.TO], WORD_BYTES), in_line - 1)


@native
def take_hit(state: State, memory: Memory, number: int, at: int) -> None:
    """Write the next word of a PPI at tick `at` into the page that is open for it."""
    master = w.MASTERS_AT + number
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    source, target = state[transfer + w.FROM], state[transfer + w.TO]
    memory[target >> WORD_BITS] = memory[source >> WORD_BITS]
    state[transfer + w.FROM], state[transfer + w.TO] = source + WORD_BYTES, target + WORD_BYTES
    state[transfer + w.FROM_X_LEFT] -= 1
    state[transfer + w.TO_X_LEFT] -= 1
    state[transfer + w.MOVED] += 1
    state[transfer + w.LEFT] -= 1
    state[transfer + w.PLACE] += 1
    next_paced(state, master, transfer)
    through = at + state[w.SCLK]
    state[w.WRITTEN + (target >> state[w.BANK_BITS])] = through
    state[w.BEGAN], state[w.COMMAND_FREE], state[w.DATA_FREE] = at, through, through
    state[w.REFRESH_WAIT], state[w.PAGE_CLASS] = 0, 0
    traffic = traffic_at(state[transfer + w.TO_OWNER], number)
    state[traffic + w.WRITTEN_BYTES] += WORD_BYTES
    state[traffic + w.HITS] += 1
    state[traffic + w.BUSY] += state[w.SCLK]


@native
def take_hits(state: State, memory: Memory, limit: int) -> None:
    """Take the words of both PPIs that come before tick `limit`, up to which nobody else wants the bus and no refresh is due."""
    if not state[w.LAST_WRITE] or state[w.DATA_FREE] > state[w.COMMAND_FREE]:
        return
    if min(state[w.MASTERS_AT + w.PPI0 + w.READY], state[w.MASTERS_AT + w.PPI1 + w.READY]) >= limit:
        return
    left, right = hits_of(state, w.PPI0), hits_of(state, w.PPI1)
    while True:
        left_ready, right_ready = (
            state[w.MASTERS_AT + w.PPI0 + w.READY],
            state[w.MASTERS_AT + w.PPI1 + w.READY],
        )
        free = state[w.COMMAND_FREE]
        left_at, right_at = max(left_ready, free), max(right_ready, free)
        at = min(left_at, right_at)
        if at >= limit or at == state[w.REFRESH_ENDS] or at - min(left_ready, right_ready) > state[w.SCLK]:
            return
        if left_at <= right_at:  # of two at a time the left one has the better rank
            number, left, hits = w.PPI0, left - 1, left
        else:
            number, right, hits = w.PPI1, right - 1, right
        if hits <= 0:
            return
        take_hit(state, memory, number, at)
