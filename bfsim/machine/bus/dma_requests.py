"""DMA on the bus, compiled: what moves when a request is granted."""

from __future__ import annotations

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.pacing import aligned, arrival, burst_of, lose, next_paced, step_device
from bfsim.machine.bus.runs import l2_alone_until, move_run, take_turn
from bfsim.machine.bus.sdram import access, stream
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.traffic import count_access, count_traffic
from bfsim.machine.bus.transfers import after_move, moved, next_on_chip


@native
def access_burst(state: State, number: int, at: int, offset: int, step: int, count: int, write: bool) -> int:
    """Access `count` elements, `step` bytes apart, one after the other; return when the last one is through."""
    transfer = w.TRANSFERS_AT + state[w.MASTERS_AT + number + w.TRANSFER] * w.TRANSFER_WORDS
    beats = max(1, 1 << state[transfer + w.ELEMENT_BITS] >> state[w.WORD_BITS])
    owner = state[transfer + (w.TO_OWNER if write else w.FROM_OWNER)]
    through = at
    for element in range(count):
        through = access(state, at, offset + element * step, write)
        if beats > 1:
            through = stream(state, beats - 1, write, offset)
        count_access(state, number, owner, 1)
    return through


@native
def exchange(state: State, memory: Memory, number: int, at: int) -> int:
    """Move an element within SDRAM, into the FIFO or out of it: when that is full, all of it is written again."""
    master = w.MASTERS_AT + number
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    if state[master + w.WRITES]:
        through = access_burst(state, number, at, state[transfer + w.TO], 0, 1, True)
        count_traffic(
            state, number, state[transfer + w.TO_OWNER], True, 1 << state[transfer + w.ELEMENT_BITS]
        )
        state[master + w.IN_FIFO] -= 1
        state[master + w.WRITES] = state[master + w.IN_FIFO] > 0
        state[master + w.READY] = state[w.COMMAND_FREE]
        moved(state, memory, transfer, 1)
        return after_move(state, master, transfer, through)
    offset = state[transfer + w.FROM] + state[master + w.IN_FIFO] * state[transfer + w.FROM_X_MODIFY]
    through = access_burst(state, number, at, offset, 0, 1, False)
    count_traffic(state, number, state[transfer + w.FROM_OWNER], False, 1 << state[transfer + w.ELEMENT_BITS])
    take_turn(state, master, 1)
    state[master + w.IN_FIFO] += 1
    state[master + w.READY] = state[w.COMMAND_FREE]
    if state[master + w.IN_FIFO] == min(
        state[w.BURST_WORDS], state[transfer + w.FROM_X_LEFT], state[transfer + w.TO_X_LEFT]
    ):
        state[master + w.WRITES] = 1
        state[master + w.READY] = aligned(through, state[w.SCLK])
    return w.NONE


@native
def copy_on_chip(state: State, memory: Memory, number: int, at: int) -> int:
    """End a row of a transfer between L1 and L2: all of it moves at its end."""
    master = w.MASTERS_AT + number
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    first, end = state[w.L2_FIRST], state[w.L2_END]
    left = state[transfer + w.TO_X_LEFT]
    nbytes = left << state[transfer + w.ELEMENT_BITS]
    if first <= state[transfer + w.FROM] < end:
        count_traffic(state, number, state[transfer + w.FROM_OWNER], False, nbytes)
    if first <= state[transfer + w.TO] < end:
        count_traffic(state, number, state[transfer + w.TO_OWNER], True, nbytes)
    while left:
        count = min(state[transfer + w.FROM_X_LEFT], left)
        moved(state, memory, transfer, count)
        left -= count
    if state[transfer + w.LEFT]:
        next_on_chip(state, master, transfer)
    return after_move(state, master, transfer, at)


@native
def copy_through_l2_port(state: State, memory: Memory, number: int, at: int, until: int) -> int:
    """Move the next word of the internal DMA, and those behind it before which nobody else can want the port of L2.

    A word that had to wait for the port makes all that follow later. Within L2 it holds the port twice: read and written.
    """
    master = w.MASTERS_AT + number
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    first, end, word = state[w.L2_FIRST], state[w.L2_END], state[transfer + w.ELEMENT]
    reads, writes = first <= state[transfer + w.FROM] < end, first <= state[transfer + w.TO] < end
    holds = (reads + writes) * state[w.L2_NEXT]
    step = max(word, holds)
    alone = (l2_alone_until(state, number, until) - at - 1) // step
    more = max(0, min(alone, state[transfer + w.FROM_X_LEFT] - 1, state[transfer + w.TO_X_LEFT] - 1))
    nbytes = (1 + more) << state[transfer + w.ELEMENT_BITS]
    if reads:
        count_traffic(state, number, state[transfer + w.FROM_OWNER], False, nbytes)
    if writes:
        count_traffic(state, number, state[transfer + w.TO_OWNER], True, nbytes)
    at += more * step
    state[w.L2_FREE], state[w.IMDMA_HAD_L2] = at + holds, 1
    state[master + w.READY] = at + word
    moved(state, memory, transfer, 1 + more)
    return after_move(state, master, transfer, at + word)


@native
def exchange_with_device(state: State, memory: Memory, number: int, at: int) -> int:
    """Move the next burst to or from a device that sets the pace, and lose what came too late."""
    master = w.MASTERS_AT + number
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    write = state[transfer + w.MODE] == w.PACED_IN
    if write and at > state[master + w.READY]:
        lose(state, memory, master, transfer, at)
    count = burst_of(state, transfer)
    offset = state[transfer + w.TO] if write else state[transfer + w.FROM]
    through, nbytes = at, count << state[transfer + w.ELEMENT_BITS]
    owner = state[transfer + (w.TO_OWNER if write else w.FROM_OWNER)]
    if state[master + w.USES] == w.SDRAM:
        through = access_burst(
            state,
            number,
            at,
            offset,
            state[transfer + (w.TO_X_MODIFY if write else w.FROM_X_MODIFY)],
            count,
            write,
        )
        count_traffic(state, number, owner, write, nbytes)
    elif state[w.L2_FIRST] <= offset < state[w.L2_END]:
        count_traffic(state, number, owner, write, nbytes)
    if not write:
        # a link that has nothing to send holds its clock until it has
        state[transfer + w.START] += max(0, through - arrival(state, transfer, -1))
        through = arrival(state, transfer, count - 1)
    moved(state, memory, transfer, count)
    step_device(state, transfer, count)
    if state[transfer + w.LEFT]:
        next_paced(state, master, transfer)
    return after_move(state, master, transfer, through)


@native
def serve_dma(state: State, memory: Memory, number: int, at: int, until: int, quiet_until: int) -> int:
    """Grant the request of a DMA at tick `at`; return the number of the transfer that wakes somebody, or NONE.

    `quiet_until`: see `others_quiet_until`, and earlier where nothing is done at once.
    """
    where = w.MASTERS_AT + number
    mode = state[w.TRANSFERS_AT + state[where + w.TRANSFER] * w.TRANSFER_WORDS + w.MODE]
    if mode in (w.READ, w.WRITE):
        return move_run(state, memory, number, at, until, quiet_until)
    if mode == w.BOTH:
        return exchange(state, memory, number, at)
    if mode == w.ON_CHIP:
        return copy_on_chip(state, memory, number, at)
    if mode == w.THROUGH_L2_PORT:
        return copy_through_l2_port(state, memory, number, at, until)
    return exchange_with_device(state, memory, number, at)
