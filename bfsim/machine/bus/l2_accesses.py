"""Each thing that a core can do at L2 with a word, compiled, and what it wants next then: `l2_words` says what comes when."""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import charge_site, cycles_until
from bfsim.machine.bus.core_logs import kind_of
from bfsim.machine.bus.l2_port import count_tries, tries_before
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.bus.state import State
from bfsim.machine.bus.store_buffer import is_among, put_at
from bfsim.machine.bus.traffic import count_traffic

Request = tuple[int, int, int, int, int, int, int]
CORE, READY, DRAINS_AT, SPIN, PUTS, PLACE, ORIGIN = range(7)
"""What a core wants next: which core, from when on its access can be made and its oldest store drained, NEVER if there is none; the ticks
from a try of its lock to the next one, 0 if it tries none; whether the access is a store, which needs no port but room in the buffer;
where it stands in the log; and the tick at which its call would have begun without all stalls so far."""


@native
def is_word_in_l2(state: State, entry: int) -> bool:
    """Whether an entry of the log is a load or a store of a word of L2."""
    return kind_of(entry) in (log.LOAD, log.STORE) and entry & log.OFFSET_MASK >= state[w.SDRAM_END]


@native
def is_followed(state: State, request: Request) -> bool:
    """Whether a core's next access is the next one of its log, behind no fetch and not of another kind."""
    core = request[CORE]
    job, behind = w.JOBS_AT + core * w.JOB_WORDS, request[PLACE] + 1
    is_logged = behind < first_place(core) + state[job + w.END]
    entry = state[behind]
    return is_logged and entry >> log.STAMP_BIT <= state[job + w.NEXT_FETCH] and is_word_in_l2(state, entry)


@native
def first_place(core: int) -> int:
    """Return where a core's log begins."""
    return w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG


@native
def is_held(state: State, request: Request) -> bool:
    """Whether an access must wait for the store buffer; if so, let the core wait for it."""
    job = w.JOBS_AT + request[CORE] * w.JOB_WORDS
    stores = state[job + w.STORES]
    if request[PUTS]:
        if stores >= state[w.STORE_DEPTH]:
            state[job + w.STATE] = w.BUFFER_FULL
            return True
    elif stores:
        offset = state[request[PLACE]] & log.OFFSET_MASK
        if is_among(state, job, state[job + w.STORE_HEAD], stores, offset, w.CORE_WORD_BYTES):
            state[job + w.STATE] = w.BUFFER_NOT_EMPTY
            return True
    return False


@native
def issue(state: State, core: int, place: int, not_before: int, origin: int, drains_at: int) -> Request:
    """Have a core come to the access at a place of its log, not before a tick; its buffer is drained from `drains_at` on."""
    entry = state[place]
    issued = max(not_before, origin + (entry >> log.STAMP_BIT) * state[w.CCLK])
    state[w.JOBS_AT + core * w.JOB_WORDS + w.ISSUED_AT] = issued
    return core, issued, drains_at, 0, int(kind_of(entry) == log.STORE), place, origin


@native
def load(state: State, request: Request, at: int, latency: int) -> Request:
    """Load a word at tick `at`, and charge what the core waits for the port and, `latency`, for its data."""
    core, place = request[CORE], request[PLACE]
    site, cycles = state[place + w.LOG_ENTRIES], latency
    owner = owner_for(state, core, state[place] & log.OFFSET_MASK, site)
    count_traffic(state, w.CORE_A + core, owner, False, w.CORE_WORD_BYTES)
    charge_site(state, core, site, w.L2_LATENCY, latency)
    if at > request[READY]:
        waited = cycles_until(state, request[READY], at + state[w.CCLK])
        charge_site(state, core, site, w.L2_PORT, waited)
        cycles += waited
    done = state[w.JOBS_AT + core * w.JOB_WORDS + w.LINE_DONE] = at + state[w.L2_READ]
    return issue(state, core, place + 1, done, request[ORIGIN] + cycles * state[w.CCLK], request[DRAINS_AT])


@native
def store(state: State, request: Request, at: int) -> Request:
    """Put a word into the core's buffer at tick `at`."""
    core, place = request[CORE], request[PLACE]
    job = w.JOBS_AT + core * w.JOB_WORDS
    stores = state[job + w.STORES]
    put_at(state, job, state[job + w.STORE_HEAD] + stores, state[place], state[place + w.LOG_ENTRIES])
    state[job + w.STORES] = stores + 1
    state[w.MASTERS_AT + w.STORES_A + core + w.USES] = w.L2
    return issue(state, core, place + 1, at, request[ORIGIN], request[DRAINS_AT] if stores else at)


@native
def drain(state: State, request: Request, free: int) -> Request:
    """Write the oldest store of a core's buffer, until the port is `free` again, and let the core go on if it waited for that."""
    core = request[CORE]
    job = w.JOBS_AT + core * w.JOB_WORDS
    head, stores = state[job + w.STORE_HEAD], state[job + w.STORES] - 1
    entry = state[job + w.STORE_QUEUE + head]
    owner = owner_for(state, core, entry & log.OFFSET_MASK, entry >> log.STAMP_BIT)
    count_traffic(state, w.STORES_A + core, owner, True, w.CORE_WORD_BYTES)
    state[job + w.STORE_HEAD], state[job + w.STORES] = (head + 1) % w.MAX_STORES, stores
    drains_at = free if stores else w.NEVER
    waits_for = state[job + w.STATE]
    if waits_for != w.BUFFER_FULL and (waits_for != w.BUFFER_NOT_EMPTY or stores):
        return core, request[READY], drains_at, request[SPIN], request[PUTS], request[PLACE], request[ORIGIN]
    cycles = cycles_until(state, state[job + w.ISSUED_AT], free + state[w.CCLK])
    charge_site(state, core, state[request[PLACE] + w.LOG_ENTRIES], w.STORE_BUFFER, cycles)
    state[job + w.STATE] = w.RUNNING
    return issue(state, core, request[PLACE], free, request[ORIGIN] + cycles * state[w.CCLK], drains_at)


@native
def try_lock(state: State, request: Request, at: int, until: int) -> Request:
    """Let a core that spins try its lock from tick `at` on, as often as nobody else wants the port until a tick."""
    turn = state[w.L2_READ] + state[w.L2_NEXT] + request[SPIN]
    tries = tries_before(at, turn, until)
    count_tries(state, request[CORE], tries)
    ready = at + tries * turn
    return request[CORE], ready, request[DRAINS_AT], request[SPIN], 0, request[PLACE], request[ORIGIN]
