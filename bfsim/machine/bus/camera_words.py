"""Cameras on the bus, compiled: words into open pages while nothing else needs the bus. Most requests are of this kind.

The effect is what `dma_requests` and `sdram` would do for each word, without the cases that cannot occur here.
"""

from __future__ import annotations

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.pacing import aligned, arrival
from bfsim.machine.bus.sdram import hits_ahead
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.traffic import traffic_at
from bfsim.machine.bus.walk import WORD_BITS, WORD_BYTES

SLOW_SCLK = 4
"""A camera whose words are at least so many SCLK apart loses none, and none becomes urgent, while it waits for the other camera's."""


@native
def transfer_of(state: State, number: int) -> int:
    """Return where the transfer of a master is."""
    return w.TRANSFERS_AT + state[w.MASTERS_AT + number + w.TRANSFER] * w.TRANSFER_WORDS


@native
def hits_of(state: State, number: int) -> int:
    """Return how many words of a PPI are sure to hit and to be followed by another one in their line, 0 if it does anything else."""
    master = w.MASTERS_AT + number
    if (
        state[master + w.TRANSFER] == w.NONE
        or state[master + w.USES] != w.SDRAM
        or state[master + w.FIFO] < 2
    ):
        return 0
    transfer = transfer_of(state, number)
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
    return hits_ahead(state, state[transfer + w.TO], WORD_BYTES, in_line - 1)


@native
def take_hits(state: State, memory: Memory, limit: int) -> None:
    """Take the words of both PPIs that come before tick `limit`, until which nothing else needs the bus and no refresh is due.

    This works for all at once because a camera's words are so far apart that each gets the bus as soon as it is there, or
    right after the left camera's word of the same time, which has the better rank.
    """
    left_ready, right_ready = state[w.MASTERS_AT + w.PPI0 + w.READY], state[w.MASTERS_AT + w.PPI1 + w.READY]
    free, sclk, first = state[w.COMMAND_FREE], state[w.SCLK], min(left_ready, right_ready)
    if first >= limit or first < free or first == state[w.REFRESH_ENDS]:
        return
    if not state[w.LAST_WRITE] or state[w.DATA_FREE] > free:
        return
    left_hits, right_hits = hits_of(state, w.PPI0), hits_of(state, w.PPI1)
    left_end = word_at(state, w.PPI0, left_hits) if left_hits > 0 else left_ready
    right_end = word_at(state, w.PPI1, right_hits) if right_hits > 0 else right_ready
    end = min(limit, left_end, right_end)
    left = words_before(state, w.PPI0, end) if left_hits > 0 else 0
    right = words_before(state, w.PPI1, end) if right_hits > 0 else 0
    if right and granted_at(state, right - 1, left) >= limit:
        right -= 1
    left_free = word_at(state, w.PPI0, left - 1) + sclk if left else free
    right_free = granted_at(state, right - 1, left) + sclk if right else free
    take_words(state, memory, w.PPI0, left, left_free)
    take_words(state, memory, w.PPI1, right, right_free)


@native
def word_at(state: State, number: int, ahead: int) -> int:
    """Return when a PPI requests the bus for the word `ahead` words after its next one, in the same line."""
    return aligned(arrival(state, transfer_of(state, number), ahead), state[w.SCLK])


@native
def words_before(state: State, number: int, tick: int) -> int:
    """Return for how many words of its line a PPI requests the bus before a tick."""
    transfer, sclk = transfer_of(state, number), state[w.SCLK]
    last_edge = (tick - 1) // sclk * sclk
    there = state[transfer + w.LINE_BEGAN] + (state[transfer + w.PLACE] + 1) * state[transfer + w.ELEMENT]
    parts = (last_edge - state[transfer + w.START]) * state[transfer + w.PARTS] - there
    return parts // state[transfer + w.ELEMENT] + 1 if parts >= 0 else 0


@native
def granted_at(state: State, ahead: int, left: int) -> int:
    """Return when the right PPI gets the bus for the word `ahead` words after its next one, if the left one has it for `left` words."""
    at, sclk = word_at(state, w.PPI1, ahead), state[w.SCLK]
    if left == 0:
        return at
    before = words_before(state, w.PPI0, at + sclk)
    return at + sclk if 0 < before <= left and word_at(state, w.PPI0, before - 1) == at else at


@native
def take_words(state: State, memory: Memory, number: int, count: int, free: int) -> None:
    """Write so many words of a PPI into its open page. The bus is free after them at tick `free`."""
    if count == 0:
        return
    master, transfer, sclk = w.MASTERS_AT + number, transfer_of(state, number), state[w.SCLK]
    source, target = state[transfer + w.FROM] >> WORD_BITS, state[transfer + w.TO] >> WORD_BITS
    for word in range(count):
        memory[target + word] = memory[source + word]
    state[w.WRITTEN + (state[transfer + w.TO] >> state[w.BANK_BITS])] = free
    state[master + w.READY] = word_at(state, number, count)
    for side in (transfer + w.FROM, transfer + w.TO):
        state[side + w.POSITION] += count * WORD_BYTES
        state[side + w.X_LEFT] -= count
    state[transfer + w.MOVED] += count
    state[transfer + w.LEFT] -= count
    state[transfer + w.PLACE] += count
    state[w.COMMAND_FREE] = max(free, state[w.COMMAND_FREE])
    state[w.DATA_FREE], state[w.BEGAN] = state[w.COMMAND_FREE], state[w.COMMAND_FREE] - sclk
    state[w.REFRESH_WAIT], state[w.PAGE_CLASS] = 0, 0
    traffic = traffic_at(state[transfer + w.TO_OWNER], number)
    state[traffic + w.WRITTEN_BYTES] += count * WORD_BYTES
    state[traffic + w.HITS] += count
    state[traffic + w.BUSY] += count * sclk
