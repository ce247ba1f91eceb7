"""Loads of words of L2, compiled: those of both cores, in order, for as long as nobody else can come between.

What they do is what `l2_words` would do with each: it saves the host's time only, where tables lie in L2 that both cores read.
"""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import cycles_until
from bfsim.machine.bus.core_logs import kind_of, site_at
from bfsim.machine.bus.fetch_requests import stall_of_word
from bfsim.machine.bus.l2_port import has_turn, hold_l2
from bfsim.machine.bus.l2_requests import is_eligible
from bfsim.machine.bus.l2_words import is_followed
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.bus.runs import buffers_quiet_until
from bfsim.machine.bus.state import State
from bfsim.machine.bus.traffic import count_traffic

A, B = range(w.CORES)

LoadState = tuple[int, int, int, int, int, int, int]
"""How far a core is with its loads: the numbers below."""
NUMBER, ASKS_AT, STALLED, WAITS, DONE_AT, FETCHES_AT, LOADS = range(7)
"""Its next access in the log, when that asks for the port, the ticks that its call was stalled, the cycles of these for the port, when its last
load was done, the stamp of the next fetch of its code, and whether it loads a word of L2 next, and another access of these follows."""


@native
def load_ahead(state: State, until: int) -> bool:
    """Make loads of the cores until one of them does something else; return whether there were any.

    Until tick `until` no DMA can want the port. The last access of a call is left, and so is one before something else. Beside a core that
    spins on a lock none is made: `access_ahead` plays its tries, too.
    """
    if state[w.JOBS_AT + w.SPIN] or state[w.JOBS_AT + w.JOB_WORDS + w.SPIN]:
        return False
    one, other = progress_of(state, A), progress_of(state, B)
    if not (one[LOADS] or other[LOADS]):
        return False
    limit = buffers_quiet_until(state, until)
    free, others_turn, last_at, latency = state[w.L2_FREE], has_turn(state, B), w.NONE, stall_of_word(state)
    while True:
        at, other_at = max(one[ASKS_AT], free), max(other[ASKS_AT], free)
        is_other = other_at < at or (other_at == at and others_turn)
        at = min(at, other_at)
        if at >= limit or not (other[LOADS] if is_other else one[LOADS]):
            break
        if is_other:
            other = after_load(state, B, other, at, latency)
        else:
            one = after_load(state, A, one, at, latency)
        free, others_turn, last_at = at + state[w.L2_NEXT], not is_other, at
    if last_at == w.NONE:
        return False
    hold_l2(state, A if others_turn else B, last_at, w.CORE_WORD_BYTES)
    keep(state, A, one, latency)
    keep(state, B, other, latency)
    return True


@native
def progress_of(state: State, core: int) -> LoadState:
    """Return how far a core is."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    number, fetches_at = state[job + w.ENTRY], state[job + w.NEXT_FETCH]
    loads = (
        kind_of(state[job + w.PRESENT]) == log.LOAD
        and not state[job + w.STORES]
        and is_eligible(state, core, w.CORES - 1 - core)
        and is_followed(state, core, number + 1, fetches_at)
    )
    asks_at = state[w.MASTERS_AT + w.CORE_A + core + w.READY]
    return number, asks_at, state[job + w.STALLED], 0, state[job + w.LINE_DONE], fetches_at, int(loads)


@native
def after_load(state: State, core: int, before: LoadState, at: int, latency: int) -> LoadState:
    """Make the next load of a core at tick `at`, and return how far it is then."""
    job, cclk, number = w.JOBS_AT + core * w.JOB_WORDS, state[w.CCLK], before[NUMBER]
    entry = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + number
    site = state[entry + w.LOG_ENTRIES]
    row, owner = site_at(core, site), owner_for(state, core, state[entry] & log.OFFSET_MASK, site)
    count_traffic(state, w.CORE_A + core, owner, False, w.CORE_WORD_BYTES)
    waited = cycles_until(state, before[ASKS_AT], at + cclk) if at > before[ASKS_AT] else 0
    if waited:
        state[row + w.L2_PORT] += waited
    state[row + w.L2_LATENCY] += latency
    stalled, done_at = before[STALLED] + (waited + latency) * cclk, at + state[w.L2_READ]
    issued = state[job + w.BEGIN] + (state[entry + 1] >> log.STAMP_BIT) * cclk + stalled
    loads = kind_of(state[entry + 1]) == log.LOAD and is_followed(state, core, number + 2, before[FETCHES_AT])
    return (
        number + 1,
        max(done_at, issued),
        stalled,
        before[WAITS] + waited,
        done_at,
        before[FETCHES_AT],
        int(loads),
    )


@native
def keep(state: State, core: int, progress: LoadState, latency: int) -> None:
    """Keep in the state how far a core is, if it has loaded anything."""
    job, number = w.JOBS_AT + core * w.JOB_WORDS, progress[NUMBER]
    if number == state[job + w.ENTRY]:
        return
    state[job + w.STALL + w.L2_LATENCY] += (number - state[job + w.ENTRY]) * latency
    state[job + w.STALL + w.L2_PORT] += progress[WAITS]
    entry = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + number
    state[job + w.ENTRY], state[job + w.PRESENT] = number, state[entry]
    state[job + w.SITE] = state[entry + w.LOG_ENTRIES]
    state[job + w.STALLED], state[job + w.LINE_DONE] = progress[STALLED], progress[DONE_AT]
    master = w.MASTERS_AT + w.CORE_A + core
    state[job + w.ISSUED_AT] = state[master + w.READY] = progress[ASKS_AT]
    state[master + w.USES] = w.L2 if kind_of(state[entry]) == log.LOAD else w.NOTHING
