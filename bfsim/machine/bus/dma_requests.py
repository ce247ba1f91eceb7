"""DMA on the bus, compiled: when a transfer's next element can move, and what moves with it."""

from __future__ import annotations

from bfsim.kernel.compiled import compiled
from bfsim.machine.bus import state as w
from bfsim.machine.bus.sdram import access, hits_ahead, stream
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.walk import copy_element, go_on, move


@compiled
def aligned(tick: int, period: int) -> int:
    """Return the first edge of a clock of `period` ticks at or after `tick`."""
    return (tick + period - 1) // period * period


@compiled
def arrival(state: State, slot: int, ahead: int) -> int:
    """Return when a device has the element `ahead` of the next one, or has sent it: the end of its time on the wire."""
    place, began = state[slot + w.PLACE] + ahead, state[slot + w.LINE_BEGAN]
    while place >= state[slot + w.LINE_ELEMENTS]:
        place -= state[slot + w.LINE_ELEMENTS]
        began += state[slot + w.LINE]
    while place < 0:
        place += state[slot + w.LINE_ELEMENTS]
        began -= state[slot + w.LINE]
    ticks, parts = began + (place + 1) * state[slot + w.ELEMENT], state[slot + w.PARTS]
    if parts > 1:
        ticks = (ticks + parts - 1) // parts
    return state[slot + w.START] + ticks


@compiled
def step_device(state: State, slot: int, count: int) -> None:
    """Go on by `count` elements of the device's line."""
    state[slot + w.PLACE] += count
    if state[slot + w.PLACE] == state[slot + w.LINE_ELEMENTS]:
        state[slot + w.PLACE] = 0
        state[slot + w.LINE_BEGAN] += state[slot + w.LINE]


@compiled
def count_traffic(state: State, master: int, memory: int, write: bool, nbytes: int) -> None:
    """Count bytes that a master moved to or from a memory."""
    at = w.TRAFFIC_AT + (master * w.MEMORIES + memory) * w.TRAFFIC_WORDS
    state[at + (w.WRITTEN_BYTES if write else w.READ_BYTES)] += nbytes


@compiled
def count_access(state: State, master: int, elements: int) -> None:
    """Count `elements` accesses of SDRAM, the first of which was the controller's last one, and the time they took."""
    at = w.TRAFFIC_AT + (master * w.MEMORIES + w.IN_SDRAM) * w.TRAFFIC_WORDS
    state[at + w.HITS + state[w.PAGE_CLASS]] += 1
    state[at + w.HITS] += elements - 1
    state[at + w.BUSY] += state[w.COMMAND_FREE] - state[w.BEGAN] - state[w.REFRESH_WAIT]


@compiled
def lot_of(state: State, slot: int) -> int:
    """How many elements a device's DMA moves at once: each as it comes in, but half a FIFO on its way out.

    So the other half is there while the DMA waits for the bus.
    """
    if state[slot + w.MODE] == w.PACED_IN:
        return 1
    left = min(state[slot + w.FROM_X_LEFT], state[slot + w.TO_X_LEFT])
    return min(max(1, state[w.LOT] // 2), left, state[slot + w.LINE_ELEMENTS] - state[slot + w.PLACE])


@compiled
def next_paced(state: State, master: int, slot: int) -> None:
    """Set when the device's next lot wants to move: when it is there, or when the FIFO has room for it."""
    lot, ready = lot_of(state, slot), state[slot + w.START]
    if state[slot + w.MODE] == w.PACED_IN:
        ready = arrival(state, slot, lot - 1)
    elif state[slot + w.MOVED] >= state[master + w.FIFO]:
        ready = arrival(state, slot, lot - 1 - state[master + w.FIFO])
    state[master + w.READY] = aligned(ready, state[w.SCLK])


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
        state[master + w.READY] = (
            start
            + (state[slot + w.LEFT] * state[slot + w.ELEMENT] + state[slot + w.PARTS] - 1)
            // state[slot + w.PARTS]
        )
    else:
        state[master + w.READY] = start


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


@compiled
def count_subbanks(state: State, side: int, count: int) -> None:
    """Count what the next `count` elements of a side move to or from each sub-bank of L1."""
    first, bits = state[w.L1_FIRST], state[w.SUBBANK_BITS]
    at = state[side + w.POSITION] - first
    if at < 0:
        return
    if (at + (count - 1) * state[side + w.X_MODIFY]) >> bits == at >> bits:
        state[w.SUBBANKS_AT + (at >> bits)] += count
        return
    for _ in range(count):
        state[w.SUBBANKS_AT + (at >> bits)] += 1
        at += state[side + w.X_MODIFY]


@compiled
def moved(state: State, memory: Memory, slot: int, count: int) -> None:
    """Move the bytes of `count` elements, and count what goes to and from the sub-banks of L1."""
    count_subbanks(state, slot + w.FROM, count)
    count_subbanks(state, slot + w.TO, count)
    move(state, memory, slot, count)


@compiled
def alone_until(state: State, number: int, until: int) -> int:
    """Until when a master has the bus to itself: nobody else asks for it before, or does anything that needs none of it."""
    limit = min(until, state[w.NEXT_REFRESH])
    for other in range(w.MASTERS):
        if other != number:
            limit = min(limit, state[w.MASTERS_AT + other + w.READY])
    return limit


@compiled
def preferred_until(state: State, number: int, until: int) -> int:
    """Until when a master that just had the bus has it again whenever it asks, if it leaves no gap."""
    limit = min(until, state[w.NEXT_REFRESH])
    rank = state[w.MASTERS_AT + number + w.RANK]
    for other in range(w.MASTERS):
        at = w.MASTERS_AT + other
        ready = state[at + w.READY]
        if other != number and ready < limit:
            waits = ready <= state[w.BEGAN] and state[at + w.USES_BUS] and state[at + w.RANK] > rank
            waits = waits and other > w.SPI  # a device that waits gets urgent
            if not waits:
                limit = ready
    return limit


@compiled
def run_ahead(state: State, number: int, slot: int, ahead: int, ticks: int, until: int) -> int:
    """How many of `ahead` more elements of `ticks` each, all page hits, nobody can come between.

    Where nobody else wants the bus the pauses of a memory DMA that reads are part of the run; else a run ends with the first.
    """
    master = w.MASTERS_AT + number
    if state[w.DEB_PERIOD] or state[w.MDMA_PERIOD]:
        return 0
    ahead = min(ahead, min(state[slot + w.FROM_X_LEFT], state[slot + w.TO_X_LEFT]) - 1)
    reads = state[slot + w.MODE] == w.READ and state[master + w.GAP_NUMERATOR] > 0
    if not reads:
        room = preferred_until(state, number, until) - state[w.COMMAND_FREE]
        return max(0, min(ahead, (room + ticks - 1) // ticks))
    parts = state[master + w.GAP_DENOMINATOR]
    room = alone_until(state, number, until) - state[w.COMMAND_FREE]
    longest = ticks * parts + state[w.LOT] * state[w.SCLK] * state[master + w.GAP_NUMERATOR]
    alone = max(0, min(ahead, (room - state[w.LOT] * state[w.SCLK]) * parts // longest))
    if alone:
        return alone
    room = preferred_until(state, number, until) - state[w.COMMAND_FREE]
    to_gap = (parts - 1 - state[master + w.GAP]) // state[master + w.GAP_NUMERATOR] - 1
    return max(0, min(ahead, to_gap, (room + ticks - 1) // ticks))


@compiled
def pause(state: State, master: int, elements: int) -> int:
    """Add up what a memory DMA pauses for `elements` that it reads; return the ticks that are due.

    It pauses for as long as another stream moves a FIFO of words ([assumed]; the sum of the pauses is data of the chip).
    """
    state[master + w.GAP] += elements * state[master + w.GAP_NUMERATOR]
    lots = state[master + w.GAP] // state[master + w.GAP_DENOMINATOR]
    state[master + w.GAP] -= lots * state[master + w.GAP_DENOMINATOR]
    return lots * state[w.LOT] * state[w.SCLK]


@compiled
def take_turn(state: State, master: int, count: int) -> None:
    """Count what a stream moved; when it and its partner have had their periods, both begin anew."""
    state[master + w.SERVED] += count
    partner, period = state[master + w.PARTNER], state[w.MDMA_PERIOD]
    if partner != w.NONE and state[master + w.SERVED] >= period <= state[w.MASTERS_AT + partner + w.SERVED]:
        state[master + w.SERVED] = 0
        state[w.MASTERS_AT + partner + w.SERVED] = 0


@compiled
def burst(state: State, memory: Memory, number: int, at: int, until: int) -> int:
    """Move the next elements of a memory DMA with one side in SDRAM; return who is woken."""
    master = w.MASTERS_AT + number
    slot = w.SLOTS_AT + state[master + w.SLOT] * w.SLOT_WORDS
    write = state[slot + w.MODE] == w.WRITE
    offset, step = state[slot + w.FROM], state[slot + w.FROM_X_MODIFY]
    if write:
        offset, step = state[slot + w.TO], state[slot + w.TO_X_MODIFY]
    beats = max(1, 1 << state[slot + w.ELEMENT_BITS] >> state[w.WORD_BITS])
    through = access(state, at, offset, write)
    if beats > 1:
        through = stream(state, beats - 1, write, offset)
    ahead = hits_ahead(state, offset + step, step)
    more = run_ahead(state, number, slot, ahead, beats * state[w.SCLK], until)
    paused = 0
    if more:
        paused = 0 if write else pause(state, master, more)
        state[w.COMMAND_FREE] += paused
        state[w.DATA_FREE] += paused
        through = stream(state, more * beats, write, offset)
    state[master + w.READY] = state[w.COMMAND_FREE] + (0 if write else pause(state, master, 1))
    count_access(state, number, 1 + more)
    state[w.TRAFFIC_AT + (number * w.MEMORIES + w.IN_SDRAM) * w.TRAFFIC_WORDS + w.BUSY] -= paused
    nbytes = (1 + more) << state[slot + w.ELEMENT_BITS]
    count_traffic(state, number, w.IN_SDRAM, write, nbytes)
    on_chip = state[slot + w.FROM] if write else state[slot + w.TO]
    if state[w.L2_FIRST] <= on_chip < state[w.L2_END]:
        count_traffic(state, number, w.IN_L2, not write, nbytes)
    moved(state, memory, slot, 1 + more)
    take_turn(state, master, 1 + more)
    return after_move(state, master, slot, through)


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
def access_lot(state: State, number: int, at: int, offset: int, step: int, count: int, write: bool) -> int:
    """Access `count` elements, `step` bytes apart, one after the other; return when the last one is through."""
    slot = w.SLOTS_AT + state[w.MASTERS_AT + number + w.SLOT] * w.SLOT_WORDS
    beats = max(1, 1 << state[slot + w.ELEMENT_BITS] >> state[w.WORD_BITS])
    through = at
    for element in range(count):
        through = access(state, at, offset + element * step, write)
        if beats > 1:
            through = stream(state, beats - 1, write, offset)
        count_access(state, number, 1)
    return through


@compiled
def exchange(state: State, memory: Memory, number: int, at: int) -> int:
    """Move an element within SDRAM, into the FIFO or out of it: when that is full, all of it is written again."""
    master = w.MASTERS_AT + number
    slot = w.SLOTS_AT + state[master + w.SLOT] * w.SLOT_WORDS
    if state[master + w.WRITES]:
        through = access_lot(state, number, at, state[slot + w.TO], 0, 1, True)
        count_traffic(state, number, w.IN_SDRAM, True, 1 << state[slot + w.ELEMENT_BITS])
        state[master + w.IN_FIFO] -= 1
        state[master + w.WRITES] = state[master + w.IN_FIFO] > 0
        state[master + w.READY] = state[w.COMMAND_FREE]
        moved(state, memory, slot, 1)
        return after_move(state, master, slot, through)
    offset = state[slot + w.FROM] + state[master + w.IN_FIFO] * state[slot + w.FROM_X_MODIFY]
    through = access_lot(state, number, at, offset, 0, 1, False)
    count_traffic(state, number, w.IN_SDRAM, False, 1 << state[slot + w.ELEMENT_BITS])
    take_turn(state, master, 1)
    state[master + w.IN_FIFO] += 1
    state[master + w.READY] = state[w.COMMAND_FREE]
    if state[master + w.IN_FIFO] == min(state[w.LOT], state[slot + w.FROM_X_LEFT], state[slot + w.TO_X_LEFT]):
        state[master + w.WRITES] = 1
        state[master + w.READY] = aligned(through, state[w.SCLK])
    return w.NONE


@compiled
def copy_on_chip(state: State, memory: Memory, number: int, at: int) -> int:
    """End a transfer between L1 and L2: all of it moves at its end."""
    master = w.MASTERS_AT + number
    slot = w.SLOTS_AT + state[master + w.SLOT] * w.SLOT_WORDS
    first, end = state[w.L2_FIRST], state[w.L2_END]
    nbytes = state[slot + w.LEFT] << state[slot + w.ELEMENT_BITS]
    if first <= state[slot + w.FROM] < end:
        count_traffic(state, number, w.IN_L2, False, nbytes)
    if first <= state[slot + w.TO] < end:
        count_traffic(state, number, w.IN_L2, True, nbytes)
    while state[slot + w.LEFT]:
        moved(state, memory, slot, min(state[slot + w.FROM_X_LEFT], state[slot + w.TO_X_LEFT]))
    return finish(state, master, slot, at)


@compiled
def lose(state: State, memory: Memory, master: int, slot: int, at: int) -> None:
    """Drop the elements that came before tick `at` and found the FIFO full; the picture goes on without them.

    Those in the FIFO take the places of the last ones dropped, where the device's memory is read next.
    """
    fifo, lost = state[master + w.FIFO], 0
    while state[slot + w.LEFT] > fifo + lost and arrival(state, slot, fifo + lost) < at:
        lost += 1
    if lost == 0:
        return
    first, step = state[slot + w.FROM], state[slot + w.FROM_X_MODIFY]
    for element in range(fifo - 1, -1, -1):
        copy_element(
            memory, first + element * step, first + (element + lost) * step, state[slot + w.ELEMENT_BITS]
        )
    for _ in range(lost):
        go_on(state, slot + w.FROM, 1)
        step_device(state, slot, 1)
    state[slot + w.MOVED] += lost
    state[slot + w.LEFT] -= lost
    state[slot + w.LOST] += lost
    state[master + w.ALL_LOST] += lost


@compiled
def exchange_with_device(state: State, memory: Memory, number: int, at: int) -> int:
    """Move the next lot to or from a device that sets the pace, and lose what came too late."""
    master = w.MASTERS_AT + number
    slot = w.SLOTS_AT + state[master + w.SLOT] * w.SLOT_WORDS
    write = state[slot + w.MODE] == w.PACED_IN
    if write and at > state[master + w.READY]:
        lose(state, memory, master, slot, at)
    count = lot_of(state, slot)
    offset = state[slot + w.TO] if write else state[slot + w.FROM]
    through, nbytes = at, count << state[slot + w.ELEMENT_BITS]
    if state[master + w.USES_BUS]:
        through = access_lot(
            state,
            number,
            at,
            offset,
            state[slot + (w.TO_X_MODIFY if write else w.FROM_X_MODIFY)],
            count,
            write,
        )
        count_traffic(state, number, w.IN_SDRAM, write, nbytes)
    elif state[w.L2_FIRST] <= offset < state[w.L2_END]:
        count_traffic(state, number, w.IN_L2, write, nbytes)
    if not write:
        # a link that has nothing to send holds its clock until it has
        state[slot + w.START] += max(0, through - arrival(state, slot, -1))
        through = arrival(state, slot, count - 1)
    moved(state, memory, slot, count)
    step_device(state, slot, count)
    if state[slot + w.LEFT]:
        next_paced(state, master, slot)
    return after_move(state, master, slot, through)


@compiled
def serve_dma(state: State, memory: Memory, number: int, at: int, until: int) -> int:
    """Grant the request of a DMA at tick `at`; return the number of the transfer that wakes somebody, or NONE."""
    where = w.MASTERS_AT + number
    mode = state[w.SLOTS_AT + state[where + w.SLOT] * w.SLOT_WORDS + w.MODE]
    if mode == w.BOTH:
        return exchange(state, memory, number, at)
    if mode == w.ON_CHIP:
        return copy_on_chip(state, memory, number, at)
    if mode in (w.PACED_IN, w.PACED_OUT):
        return exchange_with_device(state, memory, number, at)
    return burst(state, memory, number, at, until)
