"""Words of L2 that the cores load and store, compiled: all that both want of the port, in order, for as long as no DMA comes between.

What it does is what `core_requests` and `store_buffer` would do with each request: it saves the host's time only. Where buffers or tables
lie in L2, nearly all that the bus does is this.
"""

from __future__ import annotations

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
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
    is_followed,
    is_held,
    load,
    store,
    try_lock,
)
from bfsim.machine.bus.l2_port import hold_of
from bfsim.machine.bus.l2_requests import keep, left_until, request_of
from bfsim.machine.bus.state import State

PUT, LOAD, DRAIN = range(3)
"""What a core asks for, by rank: to put a store into its buffer, which needs no port; to load or to try a lock; to drain its buffer."""


@native
def play_l2_words(state: State, core: int, until: int) -> bool:
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
def keep_port(state: State, free: int, last: int) -> None:
    """Keep when the port is free, and who had it last."""
    if free != state[w.L2_FREE]:
        state[w.L2_FREE], state[w.LAST_CORE_AT_L2], state[w.IMDMA_HAD_L2] = free, last, 0
