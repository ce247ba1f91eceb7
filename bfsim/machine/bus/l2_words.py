"""Loads and stores of words of L2, compiled: one core's, with the tries of the other one if that spins on a lock.

What they do is what `core_requests` would do with each. All that changes is in local variables, and is kept in the state at the end: it
saves the host's time only. Where buffers lie in L2, nearly all that the bus does is this.
"""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import charge_site, cycles_until
from bfsim.machine.bus.core_logs import kind_of
from bfsim.machine.bus.fetch_requests import stall_of_word
from bfsim.machine.bus.l2_port import count_tries, has_turn, hold_of, tries_before
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.bus.state import State
from bfsim.machine.bus.store_buffer import is_among, put_at
from bfsim.machine.bus.traffic import count_traffic

NOBODY, ACCESS, DRAIN, TRY = range(4)
"""Who comes first at the port: nobody in time, the core itself, its store buffer, or the other core, which tries a lock."""


@native
def is_word_in_l2(state: State, entry: int) -> bool:
    """Whether an entry of the log is a load or a store of a word of L2."""
    return kind_of(entry) in (log.LOAD, log.STORE) and entry & log.OFFSET_MASK >= state[w.SDRAM_END]


@native
def is_followed(state: State, core: int, number: int, fetches_at: int) -> bool:
    """Whether a core's next access is that `number` of its log, behind no fetch and not of another kind."""
    entry = state[w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + number]
    is_logged = number < state[w.JOBS_AT + core * w.JOB_WORDS + w.END]
    return is_logged and entry >> log.STAMP_BIT <= fetches_at and is_word_in_l2(state, entry)


@native
def drain(state: State, core: int, head: int) -> int:
    """Count the write of the oldest store of a core's buffer, at the place `head`; return the place of the next one."""
    entry = state[w.JOBS_AT + core * w.JOB_WORDS + w.STORE_QUEUE + head]
    owner = owner_for(state, core, entry & log.OFFSET_MASK, entry >> log.STAMP_BIT)
    count_traffic(state, w.STORES_A + core, owner, True, w.CORE_WORD_BYTES)
    return (head + 1) % w.MAX_STORES


@native
def put(state: State, core: int, place: int, entry: int, site: int) -> None:
    """Put a store of a site into a core's buffer, all of which is for L2."""
    put_at(state, w.JOBS_AT + core * w.JOB_WORDS, place, entry, site)
    state[w.MASTERS_AT + w.STORES_A + core + w.USES] = w.L2


@native
def end_wait(state: State, core: int, site: int, issued: int, free: int) -> int:
    """Charge an access that was `issued` at a tick, and waited for the store buffer until the port was `free`; return the cycles."""
    cycles = cycles_until(state, issued, free + state[w.CCLK])
    charge_site(state, core, site, w.STORE_BUFFER, cycles)
    return cycles


@native
def load(state: State, core: int, entry: int, site: int, issued: int, at: int, latency: int) -> int:
    """Count a load at tick `at`, and charge what it waits for the port and, `latency`, for its data; return the cycles."""
    owner = owner_for(state, core, entry & log.OFFSET_MASK, site)
    count_traffic(state, w.CORE_A + core, owner, False, w.CORE_WORD_BYTES)
    state[w.JOBS_AT + core * w.JOB_WORDS + w.LINE_DONE] = at + state[w.L2_READ]
    charge_site(state, core, site, w.L2_LATENCY, latency)
    if at <= issued:
        return latency
    waited = cycles_until(state, issued, at + state[w.CCLK])
    charge_site(state, core, site, w.L2_PORT, waited)
    return waited + latency


@native
def wait_of(state: State, job: int, entry: int, head: int, stores: int) -> int:
    """Return what an access waits for at the store buffer, RUNNING if for nothing."""
    if kind_of(entry) == log.STORE:
        return w.BUFFER_FULL if stores >= state[w.STORE_DEPTH] else w.RUNNING
    if stores and is_among(state, job, head, stores, entry & log.OFFSET_MASK, w.CORE_WORD_BYTES):
        return w.BUFFER_NOT_EMPTY
    return w.RUNNING


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
    began, fetches_at, cclk = state[job + w.BEGIN], state[job + w.NEXT_FETCH], state[w.CCLK]
    held, reads, latency = hold_of(state, w.CORE_WORD_BYTES), state[w.L2_READ], stall_of_word(state)
    spin = state[w.JOBS_AT + other * w.JOB_WORDS + w.SPIN]
    turn = reads + state[w.L2_NEXT] + spin
    free, drains = state[w.L2_FREE], state[w.MASTERS_AT + w.STORES_A + core + w.READY]
    tries, its_turn = state[w.MASTERS_AT + w.CORE_A + other + w.READY], has_turn(state, other)
    ready = issued = state[job + w.ISSUED_AT]
    stalled, head, stores = state[job + w.STALLED], state[job + w.STORE_HEAD], state[job + w.STORES]
    number, entry, site = state[job + w.ENTRY], state[job + w.PRESENT], state[job + w.SITE]
    waits, tried = w.RUNNING, 0
    while True:
        is_store = kind_of(entry) == log.STORE
        at = ready if is_store else max(ready, free)
        who = first_of(at, max(drains, free), max(tries, free), limit, is_store, its_turn)
        if who == NOBODY:
            break
        if who == TRY:
            times = tries_before(max(tries, free), turn, min(limit, ready, drains))
            tried, tries, its_turn = tried + times, max(tries, free) + times * turn, False
            free = tries - spin
            continue
        if who == DRAIN:
            head, stores = drain(state, core, head), stores - 1
            free, its_turn = max(drains, free) + held, True
            drains = free if stores else w.NEVER
            if waits != w.BUFFER_FULL and (waits == w.RUNNING or stores):
                continue
            stalled += end_wait(state, core, site, issued, free) * cclk
            at, waits = free, w.RUNNING
        else:
            waits = wait_of(state, job, entry, head, stores)
            if waits != w.RUNNING:
                ready = w.NEVER
                continue
            if not is_followed(state, core, number + 1, fetches_at):
                break
            if is_store:
                put(state, core, head + stores, entry, site)
                drains, stores = drains if stores else at, stores + 1
            else:
                stalled += load(state, core, entry, site, issued, at, latency) * cclk
                free, its_turn, at = at + held, True, at + reads
            number += 1
            entry, site = state[entries + number], state[entries + w.LOG_ENTRIES + number]
        ready = issued = max(at, began + (entry >> log.STAMP_BIT) * cclk + stalled)
    keep_port(state, core, other, free, tries, tried, its_turn)
    keep_buffer(state, core, head, stores, drains)
    keep_access(state, core, number, waits, stalled, issued, ready)


@native
def keep_access(
    state: State, core: int, number: int, waits: int, stalled: int, issued: int, ready: int
) -> None:
    """Keep which access of the log is a core's present one, what it waits for, and when it was `issued` and is `ready` to be made."""
    job, master = w.JOBS_AT + core * w.JOB_WORDS, w.MASTERS_AT + w.CORE_A + core
    entry = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + number
    state[job + w.ENTRY], state[job + w.PRESENT] = number, state[entry]
    state[job + w.SITE] = state[entry + w.LOG_ENTRIES]
    state[job + w.STATE], state[job + w.STALLED], state[job + w.ISSUED_AT] = waits, stalled, issued
    state[master + w.READY] = ready
    state[master + w.USES] = w.NOTHING if kind_of(state[entry]) == log.STORE else w.L2


@native
def keep_port(state: State, core: int, other: int, free: int, tries: int, tried: int, its_turn: bool) -> None:
    """Keep when the port is free, whose turn it is then, and how often the other core `tried` a lock and `tries` again."""
    if free != state[w.L2_FREE]:
        state[w.L2_FREE], state[w.IMDMA_HAD_L2] = free, 0
        state[w.LAST_CORE_AT_L2] = core if its_turn else other
    if tried:
        state[w.MASTERS_AT + w.CORE_A + other + w.READY] = tries
        count_tries(state, other, tried)


@native
def keep_buffer(state: State, core: int, head: int, stores: int, drains: int) -> None:
    """Keep what a core's store buffer has, and when the oldest store asks."""
    job, master = w.JOBS_AT + core * w.JOB_WORDS, w.MASTERS_AT + w.STORES_A + core
    state[job + w.STORE_HEAD], state[job + w.STORES] = head, stores
    state[master + w.READY] = drains
