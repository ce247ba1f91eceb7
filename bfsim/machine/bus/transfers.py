"""The transfers of each master, one after the other: posted, begun, moved, ended."""

from __future__ import annotations

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.pacing import aligned, next_paced
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.traffic import count_in_l1
from bfsim.machine.bus.walk import move


@native
def accept(state: State) -> None:
    """Append the posted transfers to their masters' queues. A master that has none begins at once."""
    for post in range(state[w.POSTED]):
        master, place = w.MASTERS_AT + state[w.POSTS_AT + 2 * post], state[w.POSTS_AT + 2 * post + 1]
        if state[master + w.TRANSFER] == w.NONE:
            state[master + w.TRANSFER] = place
            begin(state, master, w.TRANSFERS_AT + place * w.TRANSFER_WORDS, state[master + w.FREE_AT])
        else:
            state[w.TRANSFERS_AT + state[master + w.LAST_TRANSFER] * w.TRANSFER_WORDS + w.NEXT] = place
        state[master + w.LAST_TRANSFER] = place
    state[w.POSTED] = 0


@native
def begin(state: State, master: int, transfer: int, at: int) -> None:
    """Start a transfer at tick `at`, or at its own time if that is later."""
    mode, end = state[transfer + w.MODE], state[w.SDRAM_END]
    start = aligned(max(at, state[transfer + w.AT]) + state[transfer + w.SETUP], state[w.SCLK])
    state[master + w.USES] = w.SDRAM
    state[master + w.WRITES] = mode == w.WRITE
    state[master + w.IN_FIFO] = 0
    if mode == w.PACED_IN:
        state[master + w.USES] = w.SDRAM if state[transfer + w.TO] < end else w.NOTHING
        state[master + w.WRITES] = 1
        next_paced(state, master, transfer)
    elif mode == w.PACED_OUT:
        state[master + w.USES] = w.SDRAM if state[transfer + w.FROM] < end else w.NOTHING
        next_paced(state, master, transfer)
    elif mode == w.ON_CHIP:
        state[master + w.USES] = w.NOTHING
        state[transfer + w.START] = start
        next_on_chip(state, master, transfer)
    elif mode == w.THROUGH_L2_PORT:
        state[master + w.USES] = w.L2
        state[master + w.READY] = start
    else:
        state[master + w.READY] = start


@native
def next_on_chip(state: State, master: int, transfer: int) -> None:
    """Note when the next row between L1 and L2 is complete."""
    parts = (state[transfer + w.MOVED] + state[transfer + w.TO_X_LEFT]) * state[transfer + w.ELEMENT]
    state[master + w.READY] = (
        state[transfer + w.START] + (parts + state[transfer + w.PARTS] - 1) // state[transfer + w.PARTS]
    )


@native
def soonest_wake(state: State, master: int) -> int:
    """Return a tick before which a master cannot wake a waiter at the end of a transfer or row: it moves at most one element per cycle."""
    if state[master + w.TRANSFER] == w.NONE:
        return w.NEVER
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    wakes, ready = state[transfer + w.WAKE], state[master + w.READY]
    if wakes == w.AT_ROWS or state[transfer + w.MODE] == w.ON_CHIP:
        return ready
    if wakes == 0 and state[transfer + w.NEXT] == w.NONE:
        return w.NEVER
    return ready + (state[transfer + w.LEFT] - 1) * state[w.SCLK]


@native
def moved(state: State, memory: Memory, transfer: int, count: int) -> None:
    """Move the bytes of `count` elements, and count traffic with L1."""
    count_in_l1(state, transfer, count)
    move(state, memory, transfer, count)


@native
def after_move(state: State, master: int, transfer: int, through: int) -> int:
    """Check whether the elements just moved ended the transfer or a row of it. Return the number that is woken, or NONE."""
    if state[transfer + w.LEFT] == 0:
        return finish(state, master, transfer, through)
    if (
        state[transfer + w.WAKE] == w.AT_ROWS
        and state[transfer + w.TO_X_LEFT] == state[transfer + w.TO_X_COUNT]
    ):
        state[w.DONE_AT] = through
        return state[transfer + w.IDENTITY]
    return w.NONE


@native
def finish(state: State, master: int, transfer: int, at: int) -> int:
    """End a transfer at tick `at` and begin the next one. Return its number if it wakes a waiter, otherwise NONE."""
    number, wakes = state[transfer + w.IDENTITY], state[transfer + w.WAKE]
    state[w.ENDS_AT + number % w.ENDS] = at
    state[master + w.FREE_AT] = at
    state[w.FREE_PLACES_AT + state[w.FREE_TRANSFERS]] = state[master + w.TRANSFER]
    state[w.FREE_TRANSFERS] += 1
    state[master + w.TRANSFER] = state[transfer + w.NEXT]
    if state[transfer + w.NEXT] == w.NONE:
        state[master + w.LAST_TRANSFER] = w.NONE
        state[master + w.READY] = w.NEVER
    else:
        begin(state, master, w.TRANSFERS_AT + state[transfer + w.NEXT] * w.TRANSFER_WORDS, at)
    if wakes == 0:
        return w.NONE
    state[w.DONE_AT] = at
    return number
