"""Memory DMA between SDRAM and a memory on the chip: elements that nobody can come between move at once."""

from __future__ import annotations

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.sdram import access, hits_ahead, stream_until
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.traffic import count_access, count_subbanks, count_traffic
from bfsim.machine.bus.transfers import after_move, soonest_wake
from bfsim.machine.bus.walk import move


@native
def others_quiet_until(state: State, until: int) -> int:
    """Until when only PPIs and memory DMAs do anything, none of it without the SDRAM bus, and no refresh is due."""
    limit = cores_quiet_until(state, w.NONE, min(until, state[w.NEXT_REFRESH]))
    for other in range(w.IMDMA_0):
        master = w.MASTERS_AT + other
        is_another = w.PPI1 < other < w.MDMA1_0 or state[master + w.USES] != w.SDRAM
        limit = min(limit, state[master + w.READY] if is_another else w.NEVER)
    return min(limit, state[w.MASTERS_AT + w.IMDMA_0 + w.READY], state[w.MASTERS_AT + w.IMDMA_1 + w.READY])


@native
def devices_quiet_until(state: State, until: int) -> int:
    """Until when no DMA but a memory DMA asks for its bus."""
    limit = until
    for number in range(w.MDMA1_0):
        limit = min(limit, state[w.MASTERS_AT + number + w.READY])
    return min(limit, state[w.MASTERS_AT + w.IMDMA_0 + w.READY], state[w.MASTERS_AT + w.IMDMA_1 + w.READY])


@native
def copies_quiet_until(state: State, until: int) -> int:
    """Until when none of the memory DMAs asks for its bus."""
    limit = until
    for number in range(w.MDMA1_0, w.MDMA2_1 + 1):
        limit = min(limit, state[w.MASTERS_AT + number + w.READY])
    return limit


@native
def alone_until(state: State, quiet_until: int) -> int:
    """Until when a master that asks for nothing just now has the bus to itself, the others but PPIs and memory DMAs being quiet until a tick."""
    left, right = state[w.MASTERS_AT + w.PPI0 + w.READY], state[w.MASTERS_AT + w.PPI1 + w.READY]
    return copies_quiet_until(state, min(quiet_until, left, right))


@native
def l2_left_until(state: State, number: int, until: int) -> int:
    """Until when the DMAs but `number` leave the port of L2 to others: none asks for it before, nor wakes anybody, to ask for it then."""
    limit = until
    for other in range(w.STORES_A):
        master = w.MASTERS_AT + other
        ready = state[master + w.READY]
        if ready < limit and other != number:
            limit = ready if other >= w.IMDMA_0 else min(limit, soonest_wake(state, master))
    return limit


@native
def l2_alone_until(state: State, number: int, until: int) -> int:
    """Until when a master has the port of L2 to itself."""
    return cores_quiet_until(state, number, l2_left_until(state, number, until))


@native
def cores_quiet_until(state: State, number: int, until: int) -> int:
    """Until when no core asks for anything, with what it waits for or its store buffer; that of `number` does not count."""
    limit = until
    for other in range(w.STORES_A, w.MASTERS):
        if other != number:
            limit = min(limit, state[w.MASTERS_AT + other + w.READY])
    return limit


@native
def buffers_quiet_until(state: State, until: int) -> int:
    """Until when neither core's store buffer asks for anything."""
    return min(until, state[w.MASTERS_AT + w.STORES_A + w.READY], state[w.MASTERS_AT + w.STORES_B + w.READY])


@native
def preferred_until(state: State, number: int, until: int) -> int:
    """Until when a master that just had the bus has it again whenever it asks, if it leaves no gap, others waiting for it."""
    began, rank = state[w.BEGAN], state[w.MASTERS_AT + number + w.RANK]
    limit = min(until, state[w.NEXT_REFRESH])
    for other in range(w.MASTERS):
        at = w.MASTERS_AT + other
        ready = state[at + w.READY]
        if ready < limit and other != number:
            waits = ready <= began and state[at + w.USES] == w.SDRAM and state[at + w.RANK] > rank
            waits = waits and other >= w.MDMA1_0  # a device that waits gets urgent
            if not waits:
                limit = ready
    return limit


@native
def preferred_with_cameras(state: State, number: int, quiet_until: int) -> int:
    """`preferred_until` of a memory DMA that asks for nothing just now, if only PPIs and memory DMAs wait: see `others_quiet_until`.

    They are numbered in the order of their ranks.
    """
    began = state[w.BEGAN]
    limit = min(quiet_until, state[w.MASTERS_AT + w.PPI0 + w.READY], state[w.MASTERS_AT + w.PPI1 + w.READY])
    for other in range(w.MDMA1_0, w.MDMA2_1 + 1):
        ready = state[w.MASTERS_AT + other + w.READY]
        if ready < limit and (ready > began or other < number):
            limit = ready
    return limit


@native
def run_ahead(
    state: State, number: int, transfer: int, ahead: int, ticks: int, free: int, until: int, quiet_until: int
) -> int:
    """How many of `ahead` more elements of `ticks` each, all page hits, nobody can come between, the bus being `free` at a tick.

    `quiet_until`: see `others_quiet_until`.

    Where nobody else wants the bus the pauses of a memory DMA that reads are part of the run; else a run ends with the first.
    Each division is left out where it would change nothing, which is most often so: it takes the host longer than all else here.
    """
    if ahead <= 0 or state[w.DEB_PERIOD] or state[w.MDMA_PERIOD]:
        return 0
    master = w.MASTERS_AT + number
    if quiet_until > state[w.BEGAN]:
        room = preferred_with_cameras(state, number, quiet_until) - free
    else:
        room = preferred_until(state, number, until) - free
    if room <= 0:
        return 0
    numerator, parts = state[master + w.GAP_NUMERATOR], state[master + w.GAP_DENOMINATOR]
    if state[transfer + w.MODE] == w.READ and numerator > 0:
        pause = state[w.BURST_WORDS] * state[w.SCLK]
        longest = ticks * parts + pause * numerator
        with_pauses = (alone_until(state, quiet_until) - free - pause) * parts
        if with_pauses >= longest:
            return ahead if ahead * longest <= with_pauses else with_pauses // longest
        if state[master + w.GAP] + ahead * numerator >= parts:
            ahead = (parts - 1 - state[master + w.GAP]) // numerator
    return ahead if (ahead - 1) * ticks < room else (room + ticks - 1) // ticks


@native
def pause(state: State, master: int, elements: int) -> int:
    """Add up what a memory DMA pauses for `elements` that it reads; return the ticks that are due.

    It pauses for as long as another stream moves a FIFO of words ([assumed]; the sum of the pauses is data of the chip).
    """
    state[master + w.GAP] += elements * state[master + w.GAP_NUMERATOR]
    if state[master + w.GAP] < state[master + w.GAP_DENOMINATOR]:
        return 0  # most often; a division takes the host longer
    bursts = state[master + w.GAP] // state[master + w.GAP_DENOMINATOR]
    state[master + w.GAP] -= bursts * state[master + w.GAP_DENOMINATOR]
    return bursts * state[w.BURST_WORDS] * state[w.SCLK]


@native
def take_turn(state: State, master: int, count: int) -> None:
    """Count what a stream moved; when it and its partner have had their periods, both begin anew."""
    state[master + w.SERVED] += count
    partner, period = state[master + w.PARTNER], state[w.MDMA_PERIOD]
    if partner != w.NONE and state[master + w.SERVED] >= period <= state[w.MASTERS_AT + partner + w.SERVED]:
        state[master + w.SERVED] = 0
        state[w.MASTERS_AT + partner + w.SERVED] = 0


@native
def move_run(state: State, memory: Memory, number: int, at: int, until: int, quiet_until: int) -> int:
    """Move the next elements of a memory DMA with one side in SDRAM; return who is woken."""
    master = w.MASTERS_AT + number
    state[master + w.READY] = w.NEVER  # until the end of its run
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    write = state[transfer + w.MODE] == w.WRITE
    in_sdram, on_chip = transfer + w.FROM, transfer + w.TO
    owner, other = state[transfer + w.FROM_OWNER], state[transfer + w.TO_OWNER]
    if write:
        in_sdram, on_chip, owner, other = on_chip, in_sdram, other, owner
    offset, step, bits = state[in_sdram], state[in_sdram + w.X_MODIFY], state[transfer + w.ELEMENT_BITS]
    beats = max(1, 1 << bits >> state[w.WORD_BITS])
    ticks = beats * state[w.SCLK]
    access(state, at, offset, write)
    free = state[w.COMMAND_FREE] - state[w.SCLK] + ticks
    in_line = min(state[in_sdram + w.X_LEFT], state[on_chip + w.X_LEFT])
    ahead = hits_ahead(state, offset + step, step, in_line - 1)
    more = run_ahead(state, number, transfer, ahead, ticks, free, until, quiet_until)
    paused = pause(state, master, more) if more and not write else 0
    free += more * ticks + paused
    through = stream_until(state, free, write, offset)
    state[master + w.READY] = free + (0 if write else pause(state, master, 1))
    count = 1 + more
    count_access(state, number, owner, count, paused)
    count_traffic(state, number, owner, write, count << bits)
    in_l1 = state[on_chip] >= state[w.L1_FIRST]
    if in_l1 or state[w.L2_FIRST] <= state[on_chip] < state[w.L2_END]:
        count_traffic(state, number, other, not write, count << bits)
    if in_l1:
        count_subbanks(state, on_chip, count)
    move(state, memory, transfer, count)
    if state[w.MDMA_PERIOD]:
        take_turn(state, master, count)
    return after_move(state, master, transfer, through)
