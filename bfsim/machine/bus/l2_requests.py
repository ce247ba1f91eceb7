"""Loads and stores of words of L2, compiled: those between which nobody can come but a core that spins on a lock.

What they do is what `core_requests` would do with each; what that looks up or keeps in the state is in local variables here. It saves
the host's time only: where buffers lie in L2, nearly all that the bus does is this.
"""

from __future__ import annotations

from bfsim.kernel import access_trace as log
from bfsim.kernel.native import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import charge_site, cycles_until
from bfsim.machine.bus.core_logs import kind_of
from bfsim.machine.bus.fetch_requests import stall_of_word
from bfsim.machine.bus.l2_port import has_turn, hold_l2, try_lock
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.bus.state import State
from bfsim.machine.bus.store_buffer import is_in_buffer, put, take_out
from bfsim.machine.bus.traffic import count_traffic

NOBODY, ACCESS, DRAIN, TRY = range(4)
"""Who comes first at the port: nobody in time, the core itself, its store buffer, or the other core, which tries a lock."""


@native
def access_ahead(state: State, core: int, until: int) -> bool:
    """Make a core's loads and stores of L2, and what a spinning core does meanwhile; return whether there was anything to do.

    Until tick `until` no DMA can want the port. The last access of a call is left, and so is one before something else.
    """
    job, other = w.JOBS_AT + core * w.JOB_WORDS, w.CORES - 1 - core
    if not is_eligible(state, core, other):
        return False
    limit = min(until, state[w.MASTERS_AT + w.STORES_A + other + w.READY])
    if not state[w.JOBS_AT + other * w.JOB_WORDS + w.SPIN]:
        limit = min(limit, state[w.MASTERS_AT + w.CORE_A + other + w.READY])
    before = state[job + w.ENTRY], state[job + w.STORES], state[w.L2_FREE]
    play_words(state, core, other, limit)
    return before != (state[job + w.ENTRY], state[job + w.STORES], state[w.L2_FREE])


@native
def is_word_in_l2(state: State, entry: int) -> bool:
    """Whether an entry of the log is a load or a store of a word of L2."""
    return kind_of(entry) in (log.LOAD, log.STORE) and entry & log.OFFSET_MASK >= state[w.SDRAM_END]


@native
def is_eligible(state: State, core: int, other: int) -> bool:
    """Whether all that a core does next is such as `play_words` plays."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    if (
        state[job + w.STATE] != w.RUNNING
        or state[job + w.IN_TURN]
        or not is_word_in_l2(state, state[job + w.PRESENT])
        or state[job + w.LINE_DONE] > state[job + w.ISSUED_AT]
        or state[w.JOBS_AT + other * w.JOB_WORDS + w.STORES]
    ):
        return False
    for number in range(state[job + w.STORES]):
        place = (state[job + w.STORE_HEAD] + number) % w.MAX_STORES
        if state[job + w.STORE_QUEUE + place] & log.OFFSET_MASK < state[w.SDRAM_END]:
            return False
    return True


@native
def is_followed(state: State, core: int, number: int, fetches_at: int) -> bool:
    """Whether a core's next access is that `number` of its log, behind no fetch and not of another kind."""
    entry = state[w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + number]
    is_logged = number < state[w.JOBS_AT + core * w.JOB_WORDS + w.END]
    return is_logged and entry >> log.STAMP_BIT <= fetches_at and is_word_in_l2(state, entry)


@native
def drain(state: State, core: int, at: int) -> None:
    """Write the oldest store of a core's buffer at tick `at`."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    entry = state[job + w.STORE_QUEUE + state[job + w.STORE_HEAD]]
    owner = owner_for(state, core, entry & log.OFFSET_MASK, entry >> log.STAMP_BIT)
    count_traffic(state, w.STORES_A + core, owner, True, w.CORE_WORD_BYTES)
    take_out(state, core, hold_l2(state, core, at, w.CORE_WORD_BYTES))


@native
def end_wait(state: State, core: int, site: int, issued: int) -> int:
    """Charge an access that was `issued` at a tick, and waited until the port is free again; return the cycles."""
    cycles = cycles_until(state, issued, state[w.L2_FREE] + state[w.CCLK])
    charge_site(state, core, site, w.STORE_BUFFER, cycles)
    return cycles


@native
def load(state: State, core: int, entry: int, site: int, issued: int, at: int) -> int:
    """Make a load of a site at tick `at`, and charge what it waits for the port and for its data; return the cycles."""
    owner = owner_for(state, core, entry & log.OFFSET_MASK, site)
    count_traffic(state, w.CORE_A + core, owner, False, w.CORE_WORD_BYTES)
    hold_l2(state, core, at, w.CORE_WORD_BYTES)
    state[w.JOBS_AT + core * w.JOB_WORDS + w.LINE_DONE] = at + state[w.L2_READ]
    waited, latency = 0, stall_of_word(state)
    if at > issued:
        waited = cycles_until(state, issued, at + state[w.CCLK])
        charge_site(state, core, site, w.L2_PORT, waited)
    charge_site(state, core, site, w.L2_LATENCY, latency)
    return waited + latency


@native
def wait_of(state: State, job: int, entry: int) -> int:
    """Return what an access waits for at the store buffer, RUNNING if for nothing."""
    if kind_of(entry) == log.STORE:
        return w.BUFFER_FULL if state[job + w.STORES] >= state[w.STORE_DEPTH] else w.RUNNING
    is_there = is_in_buffer(state, job, entry & log.OFFSET_MASK, w.CORE_WORD_BYTES)
    return w.BUFFER_NOT_EMPTY if is_there else w.RUNNING


@native
def first_of(at: int, drains: int, tries: int, limit: int, is_store: bool, its_turn: bool) -> int:
    """Return who comes first before tick `limit`: a core, its store buffer, or the other core that tries a lock.

    Of two at a time the try comes before a drain, and before a load where it is the other core's turn.
    """
    first = min(at, drains)
    if min(first, tries) >= limit:
        return NOBODY
    if tries < first or (tries == first and (drains < at or (its_turn and not is_store))):
        return TRY
    return DRAIN if drains < at else ACCESS


@native
def play_words(state: State, core: int, other: int, limit: int) -> None:
    """Play the port up to tick `limit`: a core's loads and stores, its store buffer, and the tries of the other core if it spins."""
    job, entries = w.JOBS_AT + core * w.JOB_WORDS, w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG
    me, buffer, its = (
        w.MASTERS_AT + w.CORE_A + core,
        w.MASTERS_AT + w.STORES_A + core,
        w.MASTERS_AT + w.CORE_A + other,
    )
    began, fetches_at, cclk = state[job + w.BEGIN], state[job + w.NEXT_FETCH], state[w.CCLK]
    ready = issued = state[job + w.ISSUED_AT]
    stalled, number, waits = state[job + w.STALLED], state[job + w.ENTRY], w.RUNNING
    entry, site = state[job + w.PRESENT], state[job + w.SITE]
    while True:
        is_store = kind_of(entry) == log.STORE
        free, drains, tries = state[w.L2_FREE], state[buffer + w.READY], state[its + w.READY]
        at = ready if is_store else max(ready, free)
        who = first_of(at, max(drains, free), max(tries, free), limit, is_store, has_turn(state, other))
        if who == NOBODY:
            break
        if who == TRY:
            try_lock(state, other, max(tries, free), min(limit, ready, drains))
            continue
        if who == DRAIN:
            drain(state, core, max(drains, free))
            if waits != w.BUFFER_FULL and (waits == w.RUNNING or state[job + w.STORES]):
                continue
            stalled += end_wait(state, core, site, issued) * cclk
            at, waits = state[w.L2_FREE], w.RUNNING
        else:
            waits = wait_of(state, job, entry)
            if waits != w.RUNNING:
                ready = w.NEVER
                continue
            if not is_followed(state, core, number + 1, fetches_at):
                break
            if is_store:
                put(state, core, at, entry, site)
            else:
                stalled += load(state, core, entry, site, issued, at) * cclk
                at += state[w.L2_READ]
            number += 1
            entry, site = state[entries + number], state[entries + w.LOG_ENTRIES + number]
            state[job + w.ENTRY], state[job + w.PRESENT], state[job + w.SITE] = number, entry, site
        ready = issued = max(at, began + (entry >> log.STAMP_BIT) * cclk + stalled)
    state[job + w.STATE], state[job + w.STALLED], state[job + w.ISSUED_AT] = waits, stalled, issued
    state[me + w.READY], state[me + w.USES] = ready, w.NOTHING if is_store else w.L2
