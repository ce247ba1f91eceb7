"""The transfers of each master, one after the other: posted, begun, moved on, ended."""

from __future__ import annotations

from bfsim.kernel.compiled import compiled
from bfsim.machine.bus import state as w
from bfsim.machine.bus.pacing import aligned, next_paced
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.traffic import count_subbanks
from bfsim.machine.bus.walk import move


@compiled
def accept(state: State) -> None:
    """Put the transfers that were posted behind those of their masters; a master that has none begins at once."""
    for post in range(state[w.POSTED]):
        master, place = w.MASTERS_AT + state[w.POSTS_AT + 2 * post], state[w.POSTS_AT + 2 * post + 1]
        if state[master + w.SLOT] == w.NONE:
            state[master + w.SLOT] = place
            begin(state, master, w.SLOTS_AT + place * w.SLOT_WORDS, state[master + w.FREE_AT])
        else:
            state[w.SLOTS_AT + state[master + w.LAST_SLOT] * w.SLOT_WORDS + w.NEXT] = place
        state[master + w.LAST_SLOT] = place
    state[w.POSTED] = 0


@compiled
def begin(state: State, master: int, slot: int, at: int) -> None:
    """Start a transfer at tick `at`, or at its own time if that is later."""
    mode, end = state[slot + w.MODE], state[w.SDRAM_END]
    start = aligned(max(at, state[slot + w.AT]) + state[slot + w.SETUP], state[w.SCLK])
    state[master + w.USES_BUS] = 1
    state[master + w.WRITES] = mode == w.WRITE
    state[master + w.IN_FIFO] = 0
    if mode == w.PACED_IN:
        state[master + w.USES_BUS] = state[slot + w.TO] < end
        state[master + w.WRITES] = 1
        next_paced(state, master, slot)
    elif mode == w.PACED_OUT:
        state[master + w.USES_BUS] = state[slot + w.FROM] < end
        next_paced(state, master, slot)
    elif mode == w.ON_CHIP:
        state[master + w.USES_BUS] = 0
        state[slot + w.START] = start
        next_on_chip(state, master, slot)
    else:
        state[master + w.READY] = start


@compiled
def next_on_chip(state: State, master: int, slot: int) -> None:
    """Note when the next row between L1 and L2 is through."""
    parts = (state[slot + w.MOVED] + state[slot + w.TO_X_LEFT]) * state[slot + w.ELEMENT]
    state[master + w.READY] = (
        state[slot + w.START] + (parts + state[slot + w.PARTS] - 1) // state[slot + w.PARTS]
    )


@compiled
def moved(state: State, memory: Memory, slot: int, count: int) -> None:
    """Move the bytes of `count` elements, and count what goes to and from the sub-banks of L1."""
    count_subbanks(state, slot + w.FROM, count)
    count_subbanks(state, slot + w.TO, count)
    move(state, memory, slot, count)


@compiled
def after_move(state: State, master: int, slot: int, through: int) -> int:
    """See whether the transfer is done, or a row of it, with the elements that just moved; return who is woken."""
    if state[slot + w.LEFT] == 0:
        return finish(state, master, slot, through)
    if state[slot + w.WAKE] == w.AT_ROWS and state[slot + w.TO_X_LEFT] == state[slot + w.TO_X_COUNT]:
        state[w.DONE_AT] = through
        return state[slot + w.IDENTITY]
    return w.NONE


@compiled
def finish(state: State, master: int, slot: int, at: int) -> int:
    """End a transfer at tick `at` and begin the next one; return its number if it wakes somebody."""
    number, wakes = state[slot + w.IDENTITY], state[slot + w.WAKE]
    state[w.ENDS_AT + number % w.ENDS] = at
    state[master + w.FREE_AT] = at
    state[w.FREE_AT_STACK + state[w.FREE_SLOTS]] = state[master + w.SLOT]
    state[w.FREE_SLOTS] += 1
    state[master + w.SLOT] = state[slot + w.NEXT]
    if state[slot + w.NEXT] == w.NONE:
        state[master + w.LAST_SLOT] = w.NONE
        state[master + w.READY] = w.NEVER
    else:
        begin(state, master, w.SLOTS_AT + state[slot + w.NEXT] * w.SLOT_WORDS, at)
    if wakes == 0:
        return w.NONE
    state[w.DONE_AT] = at
    return number
