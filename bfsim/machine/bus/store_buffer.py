"""The store buffer of a core, compiled: a store goes in, waits only if the buffer is full, and is written when its bus is free."""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import ask, bytes_of, next_entry, site_of, stall
from bfsim.machine.bus.core_logs import kind_of
from bfsim.machine.bus.l2_port import hold_l2
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.bus.sdram import access, stream
from bfsim.machine.bus.state import State
from bfsim.machine.bus.traffic import count_access, count_traffic

WHAT_MASK = (1 << log.STAMP_BIT) - 1
"""Kind and offset of an entry of the log. In the store buffer, the site replaces the stamp."""


@native
def wait_for_buffer(state: State, core: int, what: int) -> int:
    """Let the core wait until its store buffer has room, or is empty."""
    state[w.JOBS_AT + core * w.JOB_WORDS + w.STATE] = what
    state[w.MASTERS_AT + w.CORE_A + core + w.READY] = w.NEVER
    return w.NONE


@native
def store(state: State, core: int, at: int, entry: int) -> int:
    """Put a store into the core's buffer."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    if state[job + w.STORES] >= state[w.STORE_DEPTH]:
        return wait_for_buffer(state, core, w.BUFFER_FULL)
    put(state, core, at, entry, site_of(state, core))
    state[job + w.ENTRY] += 1
    return next_entry(state, core, at)


@native
def put(state: State, core: int, at: int, entry: int, site: int) -> None:
    """Put a store of a site into the core's buffer, which has room for it, at tick `at`."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    put_at(state, job, state[job + w.STORE_HEAD] + state[job + w.STORES], entry, site)
    state[job + w.STORES] += 1
    if state[job + w.STORES] == 1:
        prepare_drain(state, core, at)


@native
def put_at(state: State, job: int, place: int, entry: int, site: int) -> None:
    """Write a store of a site to a place of the buffer's ring."""
    state[job + w.STORE_QUEUE + place % w.MAX_STORES] = site << log.STAMP_BIT | entry & WHAT_MASK


@native
def prepare_drain(state: State, core: int, at: int) -> None:
    """Let the oldest store request its bus from tick `at` on."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    master = w.MASTERS_AT + w.STORES_A + core
    if state[job + w.STORES] == 0:
        state[master + w.READY] = w.NEVER
        return
    ask(state, master, state[job + w.STORE_QUEUE + state[job + w.STORE_HEAD]] & log.OFFSET_MASK, at)


@native
def take_out(state: State, core: int, at: int) -> None:
    """Take the oldest store out of a core's buffer. The next one requests its bus from tick `at` on."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    state[job + w.STORE_HEAD] = (state[job + w.STORE_HEAD] + 1) % w.MAX_STORES
    state[job + w.STORES] -= 1
    prepare_drain(state, core, at)


@native
def serve_stores(state: State, core: int, at: int) -> int:
    """Write the oldest store of a core's buffer, and let the core go on if it waited for this."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    entry = state[job + w.STORE_QUEUE + state[job + w.STORE_HEAD]]
    offset, nbytes = entry & log.OFFSET_MASK, bytes_of(state, kind_of(entry))
    owner = owner_for(state, core, offset, entry >> log.STAMP_BIT)
    if offset < state[w.SDRAM_END]:
        access(state, at, offset, True)
        more = (nbytes >> state[w.WORD_BITS]) - 1
        if more > 0:
            stream(state, more, True, offset)
        state[w.LAST_CORE] = core
        count_access(state, w.STORES_A + core, owner, 1 + max(0, more))
        free = state[w.COMMAND_FREE]
    else:
        free = hold_l2(state, core, at, nbytes)
    count_traffic(state, w.STORES_A + core, owner, True, nbytes)
    take_out(state, core, free)
    waited = state[job + w.STATE]
    if waited == w.BUFFER_FULL or (waited == w.BUFFER_NOT_EMPTY and state[job + w.STORES] == 0):
        state[job + w.STATE] = w.RUNNING
        stall(state, core, free + state[w.CCLK], w.STORE_BUFFER)
        return next_entry(state, core, free)
    return w.NONE


@native
def is_in_buffer(state: State, job: int, offset: int, nbytes: int) -> bool:
    """Whether the store buffer has any of the `nbytes` (a power of two) at `offset`, or a line that contains them."""
    return is_among(state, job, state[job + w.STORE_HEAD], state[job + w.STORES], offset, nbytes)


@native
def is_among(state: State, job: int, head: int, stores: int, offset: int, nbytes: int) -> bool:
    """Whether any of so many stores from place `head` of the buffer's ring on has any of these bytes."""
    for number in range(stores):
        entry = state[job + w.STORE_QUEUE + (head + number) % w.MAX_STORES]
        size = max(nbytes, bytes_of(state, kind_of(entry)))
        if (entry ^ offset) & log.OFFSET_MASK < size:
            return True
    return False
