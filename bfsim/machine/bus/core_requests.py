"""A core on the bus, compiled: the accesses outside L1 that a kernel call made, one after the other, and what each stalls.

A load, a line fill and a fetch wait for their data; a store goes into the store buffer and waits only when that is full.
Loads overtake stores, except that a load from an address in the store buffer waits until that is empty.
"""

from __future__ import annotations

from bfsim.kernel import access_trace as log
from bfsim.kernel.native import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import kind_of, site_at
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.bus.pacing import aligned
from bfsim.machine.bus.runs import cores_quiet_until
from bfsim.machine.bus.sdram import access, stream
from bfsim.machine.bus.state import State
from bfsim.machine.bus.traffic import count_access, count_traffic

WHAT_MASK = (1 << log.STAMP_BIT) - 1
"""Of an entry of the log: kind and offset. In the store buffer the site takes the place of the stamp."""


@native
def bytes_of(state: State, kind: int) -> int:
    """Return what an access of this kind moves: a 32-bit word whatever its width, a cache line, or 64 bits of code."""
    if kind in (log.LOAD, log.STORE, log.TEST_AND_SET):
        return w.CORE_WORD_BYTES
    return w.FETCH_BYTES if kind == log.FETCH else state[w.LINE_BYTES]


@native
def site_of(state: State, core: int) -> int:
    """Return the site of the core's present access."""
    return state[w.JOBS_AT + core * w.JOB_WORDS + w.SITE]


@native
def charge(state: State, core: int, reason: int, cycles: int) -> None:
    """Charge what the core's present access stalls."""
    charge_site(state, core, site_of(state, core), reason, cycles)


@native
def charge_site(state: State, core: int, site: int, reason: int, cycles: int) -> None:
    """Charge what an access of a core's site stalls."""
    state[w.JOBS_AT + core * w.JOB_WORDS + w.STALL + reason] += cycles
    state[site_at(core, site) + reason] += cycles


@native
def next_fetch(state: State, job: int) -> int:
    """Return the stamp of the next fetch of a core's code, behind that of all accesses if there is none."""
    if state[job + w.FETCHED] == state[job + w.FETCHES]:
        return w.NEVER
    return state[job + w.FETCHED] * state[job + w.TOTAL] // state[job + w.FETCHES]


@native
def find_present(state: State, core: int) -> bool:
    """Find what the core accesses next, in its log or in code that it fetches; return whether there is anything.

    Fetches are spread evenly over the call; of a fetch and accesses of its cycle these come first.
    """
    job = w.JOBS_AT + core * w.JOB_WORDS
    at = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + state[job + w.ENTRY]
    is_logged = state[job + w.ENTRY] < state[job + w.END]
    stamp = next_fetch(state, job)
    if stamp != w.NEVER and (not is_logged or stamp < state[at] >> log.STAMP_BIT):
        site = state[job + w.SITE] = state[job + w.ROUTINE]
        code = state[site_at(core, site) + w.CODE]
        place = code + state[job + w.WORD] * w.FETCH_BYTES
        state[job + w.PRESENT] = stamp << log.STAMP_BIT | log.FETCH << log.KIND_BIT | place
        state[job + w.IN_TURN] = 1
        return True
    state[job + w.IN_TURN] = 0
    if is_logged:
        state[job + w.PRESENT], state[job + w.SITE] = state[at], state[at + w.LOG_ENTRIES]
    return is_logged


@native
def go_past(state: State, core: int) -> None:
    """Leave the present access behind: of the code, in turn, or of the log."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    if not state[job + w.IN_TURN]:
        state[job + w.ENTRY] += 1
        return
    row = site_at(core, state[job + w.SITE])
    state[job + w.FETCHED] += 1
    state[job + w.WORD] += 1
    if state[job + w.WORD] == state[row + w.CODE_WORDS]:
        state[job + w.WORD], state[job + w.ROUTINE] = 0, state[row + w.NEXT_ROUTINE]


@native
def next_entry(state: State, core: int, not_before: int) -> int:
    """Set the core's next access up; after the last one end the job and return its number, NONE - 1 - core."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    master = w.MASTERS_AT + w.CORE_A + core
    cclk = state[w.CCLK]
    if not find_present(state, core):
        state[job + w.STATE] = w.IDLE
        state[master + w.READY] = w.NEVER
        state[w.DONE_AT] = state[job + w.BEGIN] + state[job + w.TOTAL] * cclk + state[job + w.STALLED]
        return w.NONE - 1 - core
    entry = state[job + w.PRESENT]
    issued = max(not_before, state[job + w.BEGIN] + (entry >> log.STAMP_BIT) * cclk + state[job + w.STALLED])
    kind = kind_of(entry)
    waits = kind not in (log.STORE, log.WRITE_BACK)
    if waits and state[job + w.LINE_DONE] > issued:  # a core reads one line at a time
        cycles = (state[job + w.LINE_DONE] - issued + cclk - 1) // cclk
        charge(state, core, w.CODE_FETCH if kind == log.FETCH_LINE else w.CACHE_FILL, cycles)
        state[job + w.STALLED] += cycles * cclk
        issued += cycles * cclk
    state[job + w.ISSUED_AT] = issued
    if waits:
        ask(state, master, entry & log.OFFSET_MASK, issued)
    else:  # the store buffer asks, when it has it
        state[master + w.USES], state[master + w.READY] = w.NOTHING, issued
    return w.NONE


@native
def ask(state: State, master: int, offset: int, at: int) -> None:
    """Let a core ask from tick `at` on for the SDRAM bus or for the port of L2, whichever `offset` needs."""
    in_sdram = offset < state[w.SDRAM_END]
    state[master + w.USES] = w.SDRAM if in_sdram else w.L2
    state[master + w.READY] = aligned(at, state[w.SCLK]) if in_sdram else at


@native
def start_jobs(state: State) -> None:
    """Let the cores begin with what was handed to them."""
    for core in range(w.CORES):
        job = w.JOBS_AT + core * w.JOB_WORDS
        if state[job + w.STATE] == w.STARTING:
            start_job(state, core, state[job + w.BEGIN], state[job + w.TOTAL], 0, state[job + w.END])


@native
def start_job(state: State, core: int, begin: int, cclk: int, first: int, end: int) -> None:
    """Let a core begin with the accesses from `first` to before `end` of its log, of a call of `cclk` cycles from tick `begin`."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    state[job + w.STATE] = w.RUNNING
    state[job + w.BEGIN], state[job + w.TOTAL], state[job + w.STALLED] = begin, cclk, 0
    state[job + w.ENTRY], state[job + w.END] = first, end
    state[job + w.FETCHES], state[job + w.FETCHED] = 0, 0
    last = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + end - 1
    if first < end and kind_of(state[last]) == log.FETCHES:
        state[job + w.END] -= 1
        state[job + w.FETCHES] = state[last] >> log.STAMP_BIT
        state[job + w.ROUTINE], state[job + w.WORD] = state[last + w.LOG_ENTRIES], 0
    for reason in range(w.STALLS):
        state[job + w.STALL + reason] = 0
    next_entry(state, core, begin)


@native
def cycles_until(state: State, issued: int, done: int) -> int:
    """Return for how many cycles an access that was `issued` at a tick stalls a core if it is `done` at another: all but its own one."""
    ticks, cclk = done - issued, state[w.CCLK]
    cycles = (
        ticks if cclk == 1 else (ticks + cclk - 1) // cclk
    )  # a division takes the host longer than all else here
    return max(0, cycles - 1)


@native
def wait(state: State, core: int, done: int) -> int:
    """Stall the core from its present access until `done`; return the cycles, to be charged."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    cycles = cycles_until(state, state[job + w.ISSUED_AT], done)
    state[job + w.STALLED] += cycles * state[w.CCLK]
    return cycles


@native
def stall(state: State, core: int, done: int, reason: int) -> None:
    """Stall the core for `reason` from its present access until `done`."""
    cycles = wait(state, core, done)
    if cycles:
        charge(state, core, reason, cycles)


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
    place = (state[job + w.STORE_HEAD] + state[job + w.STORES]) % w.MAX_STORES
    state[job + w.STORE_QUEUE + place] = site << log.STAMP_BIT | entry & WHAT_MASK
    state[job + w.STORES] += 1
    if state[job + w.STORES] == 1:
        prepare_drain(state, core, at)


@native
def prepare_drain(state: State, core: int, at: int) -> None:
    """Let the oldest store ask for its bus from tick `at` on."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    master = w.MASTERS_AT + w.STORES_A + core
    if state[job + w.STORES] == 0:
        state[master + w.READY] = w.NEVER
        return
    ask(state, master, state[job + w.STORE_QUEUE + state[job + w.STORE_HEAD]] & log.OFFSET_MASK, at)


@native
def take_out(state: State, core: int, at: int) -> None:
    """Take the oldest store out of a core's buffer; the next one asks for its bus from tick `at` on."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    state[job + w.STORE_HEAD] = (state[job + w.STORE_HEAD] + 1) % w.MAX_STORES
    state[job + w.STORES] -= 1
    prepare_drain(state, core, at)


@native
def serve_stores(state: State, core: int, at: int) -> int:
    """Write the oldest store of a core's buffer, and let the core go on if it waited for that."""
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
    """Whether the store buffer has anything of the `nbytes` (a power of two) at `offset`, or a line that holds them."""
    for number in range(state[job + w.STORES]):
        entry = state[job + w.STORE_QUEUE + (state[job + w.STORE_HEAD] + number) % w.MAX_STORES]
        size = max(nbytes, bytes_of(state, kind_of(entry)))
        if ((entry ^ offset) & log.OFFSET_MASK) // size == 0:
            return True
    return False


@native
def serve_core(state: State, core: int, at: int, until: int) -> int:
    """Make the core's present access at tick `at`; return the number of its job when that is done, else NONE.

    Until tick `until` no DMA can want the port of L2.
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
def hold_l2(state: State, core: int, at: int, nbytes: int) -> int:
    """Let a core have the port of L2 from tick `at` on for `nbytes`; return when it is free again."""
    state[w.LAST_CORE_AT_L2], state[w.IMDMA_HAD_L2] = core, 0
    state[w.L2_FREE] = at + ((nbytes - 1 >> state[w.L2_PORT_BITS]) + 1) * state[w.L2_NEXT]
    return state[w.L2_FREE]


@native
def wait_for_l2(state: State, core: int, at: int) -> None:
    """Stall a core from its present access until it has the port of L2, at tick `at`."""
    stall(state, core, at + state[w.CCLK], w.L2_PORT)
    state[w.JOBS_AT + core * w.JOB_WORDS + w.ISSUED_AT] = at


@native
def test_and_set(state: State, core: int, at: int) -> int:
    """Read and write a byte of L2 with the port locked; return when that is done."""
    locked = state[w.L2_READ] + state[w.L2_NEXT]
    wait_for_l2(state, core, at)
    stall(state, core, at + locked + state[w.CCLK], w.L2_LATENCY)
    lock_l2(state, core, at + locked, 1)
    return at + locked


@native
def try_lock(state: State, core: int, at: int, until: int) -> None:
    """Let a core that spins try its lock from tick `at` on, as often as nobody else wants the port until a tick."""
    locked = state[w.L2_READ] + state[w.L2_NEXT]
    turn, room = locked + state[w.JOBS_AT + core * w.JOB_WORDS + w.SPIN], until - at - 1
    tries = 1 + (room // turn if room >= turn else 0)  # a division takes the host longer than all else here
    lock_l2(state, core, at + (tries - 1) * turn + locked, tries)
    state[w.MASTERS_AT + w.CORE_A + core + w.READY] = at + tries * turn


@native
def lock_l2(state: State, core: int, free: int, times: int) -> None:
    """Let a core have the port of L2 until it is free again at a tick, and count what it has read and written so many times."""
    state[w.LAST_CORE_AT_L2], state[w.IMDMA_HAD_L2], state[w.L2_FREE] = core, 0, free
    for write in (False, True):
        count_traffic(state, w.CORE_A + core, w.NO_BUFFER_IN_L2, write, times * w.CORE_WORD_BYTES)


@native
def read_l2(state: State, core: int, at: int, kind: int, offset: int) -> int:
    """Read from L2 through the port that both cores share; return when the first data are there."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    nbytes = bytes_of(state, kind)
    hold_l2(state, core, at, nbytes)
    count_traffic(state, w.CORE_A + core, owner_for(state, core, offset, site_of(state, core)), False, nbytes)
    wait_for_l2(state, core, at)
    done = at + state[w.L2_READ]
    state[job + w.LINE_DONE] = done + (nbytes - 1 >> state[w.L2_PORT_BITS]) * state[w.L2_NEXT]
    reason = w.L2_LATENCY if kind == log.LOAD else w.CACHE_FILL if kind == log.FILL else w.CODE_FETCH
    stall(state, core, done, reason)
    return done


@native
def read_sdram(state: State, core: int, at: int, kind: int, offset: int) -> int:
    """Read from SDRAM; return when the first data are at the core.

    The wait for an SCLK edge is part of the cycles of synchronisation. Until the bus is free the core waits for
    arbitration, then perhaps for a refresh, and else for the page.
    """
    job = w.JOBS_AT + core * w.JOB_WORDS
    cclk = state[w.CCLK]
    through = access(state, at, offset, False)
    nbytes = bytes_of(state, kind)
    more = max(0, (nbytes >> state[w.WORD_BITS]) - 1)
    if kind == log.LOAD and more:
        through = stream(state, more, False, offset)  # a load needs all of its word
    elif more:  # the core goes on with the first word
        whole = stream(state, more, False, offset) + state[w.CORE_SYNC] - state[w.SCLK]
        if kind != log.FETCH:
            state[job + w.LINE_DONE] = whole
    owner = owner_for(state, core, offset, site_of(state, core))
    count_access(state, w.CORE_A + core, owner, 1 + more)
    count_traffic(state, w.CORE_A + core, owner, False, nbytes)
    state[w.LAST_CORE] = core
    edge = aligned(state[job + w.ISSUED_AT], state[w.SCLK])
    done = through + state[w.CORE_SYNC] - state[w.SCLK] - (edge - state[job + w.ISSUED_AT])
    cycles = wait(state, core, done)
    waited = min(cycles, max(0, state[w.BEGAN] - edge) // cclk)
    granted = state[w.BEGAN] + state[w.REFRESH_WAIT]
    refreshed = min(cycles - waited, (granted - max(edge, state[w.BEGAN])) // cclk)
    reason = (
        w.PAGE_HIT + state[w.PAGE_CLASS]
        if kind == log.LOAD
        else w.CACHE_FILL
        if kind == log.FILL
        else w.CODE_FETCH
    )
    charge(state, core, reason, cycles - waited - refreshed)
    if refreshed:
        charge(state, core, w.REFRESHING, refreshed)
    if waited:
        charge(state, core, w.ARBITRATION, waited)
    return done
