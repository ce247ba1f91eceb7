"""A core on the bus, compiled: the accesses of a kernel call outside L1, one after the other, with the stalls of each.

Loads, line fills and fetches wait for their data. A store goes into the store buffer and waits only if that is full.
Loads overtake stores, but a load from an address in the store buffer waits until the buffer is empty.
"""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import bytes_of, charge, go_past, next_entry, site_of, wait, whole_cycles
from bfsim.machine.bus.core_logs import kind_of, site_at
from bfsim.machine.bus.l2_port import read_l2, test_and_set, try_lock
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.bus.runs import cores_quiet_until
from bfsim.machine.bus.sdram import access, stream
from bfsim.machine.bus.state import State
from bfsim.machine.bus.store_buffer import is_in_buffer, store, wait_for_buffer
from bfsim.machine.bus.traffic import count_access, count_traffic


@native
def serve_core(state: State, core: int, at: int, until: int) -> int:
    """Make the core's current access at tick `at`. Return the number of its job if that is done, otherwise NONE.

    Until tick `until`, no DMA can need the port of L2.
    """
    job = w.JOBS_AT + core * w.JOB_WORDS
    entry = state[job + w.PRESENT]
    kind, offset = kind_of(entry), entry & log.OFFSET_MASK
    if kind in (log.STORE, log.WRITE_BACK):
        return store(state, core, at, entry)
    if is_in_buffer(state, job, offset, bytes_of(state, kind)):
        return wait_for_buffer(state, core, w.BUFFER_NOT_EMPTY)
    if kind == log.TEST_AND_SET:
        if state[job + w.SPIN]:
            try_lock(state, core, at, cores_quiet_until(state, w.CORE_A + core, until))
            return w.NONE
        done = test_and_set(state, core, at)
    elif offset < state[w.SDRAM_END]:
        done = read_sdram(state, core, at, kind, offset)
    else:
        done = read_l2(state, core, at, kind, offset)
    if kind == log.FILL:
        state[site_at(core, site_of(state, core)) + w.FILLS] += 1
    go_past(state, core)
    return next_entry(state, core, done)


@native
def read_sdram(state: State, core: int, at: int, kind: int, offset: int) -> int:
    """Read from SDRAM. Return when the first data reach the core.

    The wait for an SCLK edge is part of the synchronisation cycles. Until the bus is free, the core waits for
    arbitration, then perhaps for a refresh, and otherwise for the page.
    """
    job = w.JOBS_AT + core * w.JOB_WORDS
    through = access(state, at, offset, False)
    nbytes = bytes_of(state, kind)
    more = max(0, (nbytes >> state[w.WORD_BITS]) - 1)
    if kind == log.LOAD and more:
        through = stream(state, more, False, offset)  # a load needs all of its word
    elif more:  # the core goes on once it has the first word
        whole = stream(state, more, False, offset) + state[w.CORE_SYNC] - state[w.SCLK]
        if kind != log.FETCH:
            state[job + w.LINE_DONE] = whole
    count_read(state, core, offset, more, nbytes)
    reason = (
        w.PAGE_HIT + state[w.PAGE_CLASS]
        if kind == log.LOAD
        else w.CACHE_FILL
        if kind == log.FILL
        else w.CODE_FETCH
    )
    return charge_read(state, core, through, reason)


@native
def count_read(state: State, core: int, offset: int, more: int, nbytes: int) -> None:
    """Count what a core's current access has just read from SDRAM: a word and `more` further ones."""
    owner = owner_for(state, core, offset, site_of(state, core))
    count_access(state, w.CORE_A + core, owner, 1 + more)
    count_traffic(state, w.CORE_A + core, owner, False, nbytes)
    state[w.LAST_CORE] = core


@native
def charge_read(state: State, core: int, through: int, reason: int) -> int:
    """Charge the wait of a core's current access for SDRAM data that arrive at tick `through`. Return when the core has them."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    edge = state[w.MASTERS_AT + w.CORE_A + core + w.READY]
    done = through + state[w.CORE_SYNC] - state[w.SCLK] - (edge - state[job + w.ISSUED_AT])
    cycles = wait(state, core, done)
    waited, refreshed = min(cycles, whole_cycles(state, max(0, state[w.BEGAN] - edge))), 0
    if state[w.REFRESH_WAIT] > 0:
        granted = state[w.BEGAN] + state[w.REFRESH_WAIT]
        refreshed = min(cycles - waited, whole_cycles(state, granted - max(edge, state[w.BEGAN])))
    charge(state, core, reason, cycles - waited - refreshed)
    charge(state, core, w.ARBITRATION, waited)  # often nothing, but the host does not know when
    if refreshed:
        charge(state, core, w.REFRESHING, refreshed)
    return done
