"""Words of L2 that the cores load and store, compiled: all that both want of the port, in order, for as long as no DMA comes between.

What it does is what `core_requests` and `store_buffer` would do with each request: it saves the host's time only. Where buffers or tables
lie in L2, nearly all that the bus does is this.
"""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import kind_of
from bfsim.machine.bus.fetch_requests import stall_of_word
from bfsim.machine.bus.l2_accesses import (
    CORE,
    DRAINS_AT,
    ORIGIN,
    PLACE,
    PUTS,
    READY,
    SPIN,
    Request,
    drain,
    first_place,
    is_followed,
    is_held,
    is_word_in_l2,
    load,
    store,
    try_lock,
)
from bfsim.machine.bus.l2_port import hold_of
from bfsim.machine.bus.state import State

PUT, LOAD, DRAIN = range(3)
"""What a core asks for, by rank: to put a store into its buffer, which needs no port; to load or to try a lock; to drain its buffer."""


@native
def play_words(state: State, core: int, until: int) -> bool:
    """Play what the cores want of L2, `core` first, until one of them wants something else; return whether there was anything.

    Until tick `until` no DMA can want the port. The last access of a call is left, and so is one before something else.
    """
    mine = request_of(state, core)
    if not begins(state, mine):
        return False
    its = request_of(state, w.CORES - 1 - core)
    limit = min(until, left_until(state, w.CORES - 1 - core, its))
    free, last, had_any = state[w.L2_FREE], state[w.LAST_CORE_AT_L2], False
    held, latency = hold_of(state, w.CORE_WORD_BYTES), stall_of_word(state)
    while True:
        at, drains_at = asks_at(mine, free), max(mine[DRAINS_AT], free)
        its_at, its_drains_at = asks_at(its, free), max(its[DRAINS_AT], free)
        first, its_first = min(at, drains_at), min(its_at, its_drains_at)
        if min(first, its_first) >= limit:
            break
        if its_first < first or (
            its_first == first
            and is_behind(mine, last, rank_of(mine, at, drains_at), rank_of(its, its_at, its_drains_at))
        ):
            mine, its, at, drains_at = its, mine, its_at, its_drains_at
        if drains_at < at:
            free, last = drains_at + held, mine[CORE]
            mine = drain(state, mine, free)
        elif mine[SPIN]:
            mine = try_lock(state, mine, at, min(limit, mine[DRAINS_AT], its[READY], its[DRAINS_AT]))
            free, last = mine[READY] - mine[SPIN], mine[CORE]
        elif is_held(state, mine):
            mine = mine[CORE], w.NEVER, mine[DRAINS_AT], 0, mine[PUTS], mine[PLACE], mine[ORIGIN]
        elif not is_followed(state, mine):
            break
        elif mine[PUTS]:
            mine = store(state, mine, at)
        else:
            free, last = at + held, mine[CORE]
            mine = load(state, mine, at, latency)
        had_any = True
    keep_port(state, free, last)
    keep(state, mine)
    keep(state, its)
    return had_any


@native
def begins(state: State, request: Request) -> bool:
    """Whether a core's next access is played here: most often it is soon known where none is."""
    return request[CORE] != w.NONE and (request[SPIN] != 0 or is_followed(state, request))


@native
def asks_at(request: Request, free: int) -> int:
    """Return when a core makes its access, the port being free from a tick on."""
    return request[READY] if request[PUTS] else max(request[READY], free)


@native
def rank_of(request: Request, at: int, drains_at: int) -> int:
    """Return what a core asks for first that makes its access at a tick, and drains its buffer at another."""
    return DRAIN if drains_at < at else PUT if request[PUTS] else LOAD


@native
def is_behind(request: Request, last: int, rank: int, other_rank: int) -> bool:
    """Whether a core comes behind the other one that asks at the same tick; `last`: who had the port last."""
    if rank != other_rank:
        return other_rank < rank
    return rank != PUT and (last == request[CORE] or (last == w.NONE and request[CORE] != 0))


@native
def is_playable(state: State, core: int) -> bool:
    """Whether all that a core wants next is such as is played here. One that is idle may have a buffer to drain."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    if state[job + w.STATE] != w.IDLE and not is_at_word(state, job):
        return False
    for number in range(state[job + w.STORES]):
        entry = state[job + w.STORE_QUEUE + (state[job + w.STORE_HEAD] + number) % w.MAX_STORES]
        if kind_of(entry) != log.STORE or entry & log.OFFSET_MASK < state[w.SDRAM_END]:
            return False
    return True


@native
def is_at_word(state: State, job: int) -> bool:
    """Whether a core that is at work is at a word of L2, or tries a lock there, and at nothing else."""
    return (
        not state[job + w.IN_TURN]
        and (state[job + w.SPIN] != 0 or is_word_in_l2(state, state[job + w.PRESENT]))
        and state[job + w.LINE_DONE] <= state[job + w.ISSUED_AT]
    )


@native
def request_of(state: State, core: int) -> Request:
    """Return what a core wants of L2 next, of no core if it wants something else."""
    if not is_playable(state, core):
        return w.NONE, w.NEVER, w.NEVER, 0, 0, 0, 0
    job = w.JOBS_AT + core * w.JOB_WORDS
    return (
        core,
        state[w.MASTERS_AT + w.CORE_A + core + w.READY],
        state[w.MASTERS_AT + w.STORES_A + core + w.READY],
        state[job + w.SPIN],
        int(kind_of(state[job + w.PRESENT]) == log.STORE),
        first_place(core) + state[job + w.ENTRY],
        state[job + w.BEGIN] + state[job + w.STALLED],
    )


@native
def left_until(state: State, core: int, request: Request) -> int:
    """Return when a core asks for what is not played here."""
    if request[CORE] != w.NONE:
        return w.NEVER
    return min(
        state[w.MASTERS_AT + w.CORE_A + core + w.READY], state[w.MASTERS_AT + w.STORES_A + core + w.READY]
    )


@native
def keep_port(state: State, free: int, last: int) -> None:
    """Keep when the port is free, and who had it last."""
    if free != state[w.L2_FREE]:
        state[w.L2_FREE], state[w.LAST_CORE_AT_L2], state[w.IMDMA_HAD_L2] = free, last, 0


@native
def keep(state: State, request: Request) -> None:
    """Keep what a core wants next, if that was played here."""
    core = request[CORE]
    if core == w.NONE:
        return
    job, master = w.JOBS_AT + core * w.JOB_WORDS, w.MASTERS_AT + w.CORE_A + core
    state[w.MASTERS_AT + w.STORES_A + core + w.READY] = request[DRAINS_AT]
    if state[job + w.STATE] == w.IDLE:
        return
    state[master + w.READY] = request[READY]
    if not request[SPIN]:
        place = request[PLACE]
        state[job + w.PRESENT], state[job + w.SITE] = state[place], state[place + w.LOG_ENTRIES]
        state[job + w.ENTRY], state[job + w.STALLED] = (
            place - first_place(core),
            request[ORIGIN] - state[job + w.BEGIN],
        )
        state[master + w.USES] = w.NOTHING if request[PUTS] else w.L2
