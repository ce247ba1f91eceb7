"""Code that a core fetches from L2, compiled: the words that come while nobody else can want the port but a core that spins on a lock.

What they do is what `core_requests` would do with each. Alone at the port every word stalls the core for as long as the others.
"""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import charge, count_fetched, cycles_until, go_past, next_entry
from bfsim.machine.bus.core_logs import site_at
from bfsim.machine.bus.l2_port import has_turn, hold_l2, read_l2, try_lock
from bfsim.machine.bus.memory_owners import piece_for
from bfsim.machine.bus.runs import buffers_quiet_until, cores_quiet_until
from bfsim.machine.bus.state import State
from bfsim.machine.bus.traffic import count_traffic


@native
def fetch_ahead(state: State, core: int, at: int, until: int) -> bool:
    """Fetch what a core fetches from tick `at` on; return whether there is anything. Until tick `until` no DMA can want the port."""
    if not state[w.JOBS_AT + core * w.JOB_WORDS + w.IN_TURN]:
        return False
    other = w.CORES - 1 - core
    if state[w.JOBS_AT + other * w.JOB_WORDS + w.SPIN]:
        return fetch_among_tries(state, core, other, until)
    words = words_alone(state, core, at, cores_quiet_until(state, w.CORE_A + core, until))
    if words > 0:
        fetch_words(state, core, words)
    return words > 0


@native
def fetch_among_tries(state: State, core: int, other: int, until: int) -> bool:
    """Fetch a core's code and let the `other` one try its lock, each in its turn, before tick `until`; return whether either had one.

    The last access of a call is left.
    """
    me, its, job = (
        w.MASTERS_AT + w.CORE_A + core,
        w.MASTERS_AT + w.CORE_A + other,
        w.JOBS_AT + core * w.JOB_WORDS,
    )
    limit = buffers_quiet_until(state, until)
    had_one = False
    while state[job + w.IN_TURN] and state[job + w.PRESENT] & log.OFFSET_MASK >= state[w.SDRAM_END]:
        ready, free = state[me + w.READY], state[w.L2_FREE]
        at, tries_at = max(ready, free), max(state[its + w.READY], free)
        if min(at, tries_at) >= limit or state[job + w.STORES]:
            break
        if tries_at < at or (tries_at == at and has_turn(state, other)):
            try_lock(state, other, tries_at, min(limit, ready))
        elif state[job + w.FETCHED] + 1 < state[job + w.FETCHES]:
            done = read_l2(state, core, at, log.FETCH, state[job + w.PRESENT] & log.OFFSET_MASK)
            go_past(state, core)
            next_entry(state, core, done)
        else:
            break
        had_one = True
    return had_one


@native
def words_alone(state: State, core: int, at: int, until: int) -> int:
    """How many words a core is sure to fetch alike from tick `at` on, and another one behind them before tick `until`."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    cclk, stamp = state[w.CCLK], state[job + w.PRESENT] >> log.STAMP_BIT
    offset = state[job + w.PRESENT] & log.OFFSET_MASK
    if (
        offset < state[w.SDRAM_END]
        or state[job + w.STORES]
        or at
        != state[job + w.BEGIN] + stamp * cclk + state[job + w.STALLED]  # it is late, or waits for the port
        or 1 << state[w.L2_PORT_BITS] < w.FETCH_BYTES
        or state[w.L2_NEXT] > state[w.L2_READ]
        or state[job + w.TOTAL] < state[job + w.FETCHES]
    ):
        return 0
    apart = state[job + w.TOTAL] // state[job + w.FETCHES] + 1  # cycles from a word to the next, at most
    row = site_at(core, state[job + w.SITE])
    piece = piece_for(state, row, offset)
    words = min(
        (until - at - 1) // ((apart + stall_of_word(state)) * cclk),
        state[job + w.FETCHES] - state[job + w.FETCHED] - 1,
        state[row + w.CODE_WORDS] - state[job + w.WORD] - 1,
        (state[w.PIECES_AT + piece + 1] - offset) // w.FETCH_BYTES,
    )
    if state[job + w.ENTRY] < state[job + w.END]:
        logged = state[w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + state[job + w.ENTRY]]
        words = min(words, ((logged >> log.STAMP_BIT) - stamp - 1) // apart)
    return words


@native
def stall_of_word(state: State) -> int:
    """Return for how many cycles a word stalls a core that has the port to itself."""
    return cycles_until(state, 0, state[w.L2_READ])


@native
def fetch_words(state: State, core: int, words: int) -> None:
    """Fetch so many words of a core's code, as many as `words_alone` says at most."""
    job, cclk = w.JOBS_AT + core * w.JOB_WORDS, state[w.CCLK]
    row, stalled = site_at(core, state[job + w.SITE]), stall_of_word(state)
    owner = state[w.PIECES_AT + w.MAX_PIECES + state[row + w.PIECE]]
    count_traffic(state, w.CORE_A + core, owner, False, words * w.FETCH_BYTES)
    if stalled:
        charge(state, core, w.CODE_FETCH, words * stalled)
    stamp = (state[job + w.FETCHED] + words - 1) * state[job + w.TOTAL] // state[job + w.FETCHES]
    count_fetched(state, job, state[job + w.FETCHED] + words)
    state[job + w.WORD] += words
    last = state[job + w.BEGIN] + state[job + w.STALLED] + (stamp + (words - 1) * stalled) * cclk
    state[job + w.STALLED] += words * stalled * cclk
    hold_l2(state, core, last, w.FETCH_BYTES)
    state[job + w.LINE_DONE] = last + state[w.L2_READ]
    next_entry(state, core, state[job + w.LINE_DONE])
