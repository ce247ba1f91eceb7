"""Words of SDRAM, compiled: loads and stores of both cores, what their store buffers write, and copies within SDRAM that come between.

What is done with each is what the rest of the weave would do, without what only others need: it saves the host's time only. Where buffers lie
in SDRAM, nearly all that the bus does is this.
"""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import ask, next_entry
from bfsim.machine.bus.core_logs import kind_of
from bfsim.machine.bus.core_requests import charge_read, count_read, serve_core
from bfsim.machine.bus.dma_requests import exchange
from bfsim.machine.bus.runs import copies_quiet_until
from bfsim.machine.bus.sdram import access_at, stream
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.store_buffer import is_among, put, serve_stores, wait_for_buffer

A, B = range(w.CORES)
ACCESS, DRAIN, COPY = range(3)
"""What comes first: an access of a core, a store out of its buffer, or an element of a copy."""


@native
def is_word(state: State, number: int) -> bool:
    """Whether what a core or its store buffer asks for is a word of data: no line, and no code."""
    job = w.JOBS_AT + (number - w.STORES_A) % w.CORES * w.JOB_WORDS
    place = w.PRESENT if number >= w.CORE_A else w.STORE_QUEUE + state[job + w.STORE_HEAD]
    return kind_of(state[job + place]) <= log.STORE


@native
def play_sdram_words(state: State, memory: Memory, until: int) -> int:
    """Play words of SDRAM before tick `until`, and what a core does between two of its own; return who is woken.

    By then no DMA but a memory DMA asks for anything, nor does one want the port of L2.
    """
    until, copies_at, woken, goes_on = (
        sdram_only_until(state, until),
        copies_quiet_until(state, w.NEVER),
        w.NONE,
        True,
    )
    while woken == w.NONE and goes_on:
        what, core, at = first_of(state, copies_at)
        if at >= until:
            break
        if what == COPY:
            number = first_copy(state, at)
            woken = exchange(state, memory, number, at)
            copies_at, goes_on = copies_quiet_until(state, w.NEVER), is_copy(state, number)
        elif what == DRAIN:
            woken = serve_stores(state, core, at)
            goes_on = state[w.MASTERS_AT + w.USES + w.STORES_A + core] == w.SDRAM
        elif is_word_of_sdram(state, core):
            woken = access(state, core, at)
        else:
            goes_on = is_alone(state, core, at)
            if goes_on:
                woken = serve_core(state, core, at, until)
                goes_on = state[w.MASTERS_AT + w.USES + w.CORE_A + core] != w.L2
    return woken


@native
def sdram_only_until(state: State, until: int) -> int:
    """Until when no refresh is due, store buffers have nothing for L2, and memory DMAs do nothing but copy within SDRAM."""
    limit = min(until, state[w.NEXT_REFRESH])
    for core in range(w.CORES):
        stores = w.MASTERS_AT + w.STORES_A + core
        if state[stores + w.USES] != w.SDRAM:
            limit = min(limit, state[stores + w.READY])
    for number in range(w.MDMA1_0, w.MDMA2_1 + 1):
        if not is_copy(state, number):
            limit = min(limit, state[w.MASTERS_AT + w.READY + number])
    return limit


@native
def is_copy(state: State, number: int) -> bool:
    """Whether a memory DMA copies within SDRAM, and its rank is always the same."""
    place = state[w.MASTERS_AT + w.TRANSFER + number]
    if place == w.NONE or state[w.DEB_PERIOD] or state[w.MDMA_PERIOD]:
        return False
    return state[w.TRANSFERS_AT + place * w.TRANSFER_WORDS + w.MODE] == w.BOTH


@native
def first_of(state: State, copies_at: int) -> tuple[int, int, int]:
    """Return what comes first, of which core if it is one's, and when. Of copies the first asks for the bus at a tick."""
    free = state[w.COMMAND_FREE]
    core, at, other_at = A, asks_at(state, A, free), asks_at(state, B, free)
    if other_at < at or (other_at == at and is_other_first(state)):
        core, at = B, other_at
    left, right = state[w.MASTERS_AT + w.READY + w.STORES_A], state[w.MASTERS_AT + w.READY + w.STORES_B]
    drains_at, copies_at = max(min(left, right), free), max(copies_at, free)
    first_at = min(at, drains_at)
    if copies_at < first_at or (copies_at == first_at and is_copy_first(state, core, at == first_at)):
        return COPY, A, copies_at
    if drains_at < at:
        left, right = max(left, free), max(right, free)
        return DRAIN, B if right < left or (right == left and state[w.LAST_CORE] == A) else A, drains_at
    return ACCESS, core, at


@native
def asks_at(state: State, core: int, free: int) -> int:
    """Return when a core can make its next access, the SDRAM bus being `free` at a tick."""
    master = w.MASTERS_AT + w.CORE_A + core
    ready, uses = state[master + w.READY], state[master + w.USES]
    if uses == w.SDRAM:
        return max(ready, free)
    return max(ready, state[w.L2_FREE]) if uses == w.L2 else ready


@native
def is_other_first(state: State) -> bool:
    """Whether core B comes first of two that ask at once: what needs nothing does, then SDRAM."""
    one, other = state[w.MASTERS_AT + w.USES + w.CORE_A], state[w.MASTERS_AT + w.USES + w.CORE_B]
    return other < one or (one == other == w.SDRAM and state[w.LAST_CORE] == A)


@native
def is_copy_first(state: State, core: int, is_access: bool) -> bool:
    """Whether a copy comes before a core that asks at once, with an access or else with its store buffer."""
    if is_access and state[w.MASTERS_AT + w.USES + w.CORE_A + core] == w.NOTHING:
        return False
    return state[w.MASTERS_AT + w.RANK + w.MDMA1_0] < state[w.MASTERS_AT + w.RANK + w.CORE_A]


@native
def first_copy(state: State, at: int) -> int:
    """Return the memory DMA that has the bus at a tick, when one has it: of several the first in rank, and in number."""
    number = w.MDMA1_0
    while state[w.MASTERS_AT + w.READY + number] > at:
        number += 1
    return number


@native
def is_word_of_sdram(state: State, core: int) -> bool:
    """Whether a core's present access is a load or a store of a word of SDRAM."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    entry = state[job + w.PRESENT]
    return kind_of(entry) <= log.STORE and entry & log.OFFSET_MASK < state[w.SDRAM_END]


@native
def is_alone(state: State, core: int, at: int) -> bool:
    """Whether a core's access at a tick is one that reads, once, and the other core does nothing at once."""
    kind, other = kind_of(state[w.JOBS_AT + core * w.JOB_WORDS + w.PRESENT]), w.CORES - 1 - core
    reads = kind not in (log.STORE, log.WRITE_BACK) and kind != log.TEST_AND_SET
    return reads and asks_at(state, other, state[w.COMMAND_FREE]) != at


@native
def access(state: State, core: int, at: int) -> int:
    """Make a core's present access, of a word of SDRAM, at a tick; return the number of its job when that is done, else NONE."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    entry, stores = state[job + w.PRESENT], state[job + w.STORES]
    offset = entry & log.OFFSET_MASK
    if kind_of(entry) == log.STORE:
        if stores >= state[w.STORE_DEPTH]:
            return wait_for_buffer(state, core, w.BUFFER_FULL)
        put(state, core, at, entry, state[job + w.SITE])
    else:
        if stores and is_among(state, job, state[job + w.STORE_HEAD], stores, offset, w.CORE_WORD_BYTES):
            return wait_for_buffer(state, core, w.BUFFER_NOT_EMPTY)
        at = load(state, core, at, offset)
    return go_on(state, core, at)


@native
def load(state: State, core: int, at: int, offset: int) -> int:
    """Load a word from tick `at` on; return when it is at the core."""
    more = max(0, (w.CORE_WORD_BYTES >> state[w.WORD_BITS]) - 1)
    through = access_at(state, at, offset, False)
    if more:
        through = stream(state, more, False, offset)
    count_read(state, core, offset, more, w.CORE_WORD_BYTES)
    return charge_read(state, core, through, w.PAGE_HIT + state[w.PAGE_CLASS])


@native
def go_on(state: State, core: int, at: int) -> int:
    """Set a core's next access up behind one of its log, as `next_entry` does; return the number of its job when that is done, else NONE."""
    job, master = w.JOBS_AT + core * w.JOB_WORDS, w.MASTERS_AT + w.CORE_A + core
    number = state[job + w.ENTRY] + 1
    where = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + number
    entry = state[where]
    stamp, kind = entry >> log.STAMP_BIT, kind_of(entry)
    issued = max(at, state[job + w.BEGIN] + stamp * state[w.CCLK] + state[job + w.STALLED])
    state[job + w.ENTRY] = number
    if (
        number >= state[job + w.END]
        or stamp > state[job + w.NEXT_FETCH]
        or kind > log.STORE
        or state[job + w.LINE_DONE] > issued
    ):
        return next_entry(state, core, at)
    state[job + w.PRESENT], state[job + w.SITE] = entry, state[where + w.LOG_ENTRIES]
    state[job + w.ISSUED_AT] = issued
    if kind == log.STORE:
        state[master + w.USES], state[master + w.READY] = w.NOTHING, issued
    else:
        ask(state, master, entry & log.OFFSET_MASK, issued)
    return w.NONE
