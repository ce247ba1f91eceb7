"""Loads of words of L2 by both cores, compiled: now one has the port and now the other, and nobody else can come between.

What they do is what `l2_requests` would do with each. It saves the host's time only: where both cores look things up in L2, one of them
comes between nearly all loads of the other.
"""

from __future__ import annotations

from bfsim.kernel import access_trace as log
from bfsim.kernel.native import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import next_fetch
from bfsim.machine.bus.core_logs import kind_of
from bfsim.machine.bus.l2_port import has_turn
from bfsim.machine.bus.l2_requests import is_eligible, is_followed, load
from bfsim.machine.bus.state import State

A, B = range(w.CORES)


@native
def load_in_turns(state: State, until: int) -> bool:
    """Make loads of both cores, until one of them does something else next; return whether there were any.

    Until tick `until` no DMA can want the port. The last access of a call is left, and so is one before something else.
    """
    if not (loads_next(state, A) and loads_next(state, B)):
        return False
    a_fetches_at, b_fetches_at = next_fetch(state, w.JOBS_AT), next_fetch(state, w.JOBS_AT + w.JOB_WORDS)
    loaded = False
    while True:
        core, at = first_load(state)
        if at >= until or not load_before(state, core, at, b_fetches_at if core else a_fetches_at):
            return loaded
        loaded = True
        if kind_of(state[w.JOBS_AT + core * w.JOB_WORDS + w.PRESENT]) == log.STORE:
            state[w.MASTERS_AT + w.CORE_A + core + w.USES] = w.NOTHING
            return True


@native
def loads_next(state: State, core: int) -> bool:
    """Whether a core loads a word of L2 next, and no store of it is still in its buffer."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    is_load = kind_of(state[job + w.PRESENT]) == log.LOAD
    return is_load and not state[job + w.STORES] and is_eligible(state, core, w.CORES - 1 - core)


@native
def first_load(state: State) -> tuple[int, int]:
    """Return the core that has the port of L2 next for what it loads, and when."""
    cores, free = w.MASTERS_AT + w.CORE_A + w.READY, state[w.L2_FREE]
    a_at, b_at = max(state[cores + A], free), max(state[cores + B], free)
    if b_at < a_at or (b_at == a_at and has_turn(state, B)):
        return B, b_at
    return A, a_at


@native
def load_before(state: State, core: int, at: int, fetches_at: int) -> bool:
    """Make a core's load at tick `at` if it loads or stores another word of L2 after it; return whether it does."""
    job, number = w.JOBS_AT + core * w.JOB_WORDS, state[w.JOBS_AT + core * w.JOB_WORDS + w.ENTRY] + 1
    if not is_followed(state, core, number, fetches_at):
        return False
    waited = load(state, core, state[job + w.PRESENT], state[job + w.SITE], state[job + w.ISSUED_AT], at)
    state[job + w.STALLED] += waited * state[w.CCLK]
    entry = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + number
    state[job + w.ENTRY], state[job + w.PRESENT], state[job + w.SITE] = (
        number,
        state[entry],
        state[entry + w.LOG_ENTRIES],
    )
    issued = state[job + w.BEGIN] + (state[entry] >> log.STAMP_BIT) * state[w.CCLK] + state[job + w.STALLED]
    ready = max(at + state[w.L2_READ], issued)
    state[job + w.ISSUED_AT] = state[w.MASTERS_AT + w.CORE_A + core + w.READY] = ready
    return True
