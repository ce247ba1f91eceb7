"""Code that a core fetches from L2, compiled: the words that come while nobody else can want the port but a core that spins on a lock.

What they do is what `core_requests` would do with each. Alone at the port every word stalls the core for as long as the others.
"""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import charge, cycles_until, go_past_code, next_entry, site_of
from bfsim.machine.bus.core_logs import site_at
from bfsim.machine.bus.l2_port import has_turn, hold_l2, hold_of, lock_l2, tries_before
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

    What changes with a word is in local variables.
    """
    job, cclk, limit = w.JOBS_AT + core * w.JOB_WORDS, state[w.CCLK], buffers_quiet_until(state, until)
    ready = state[w.MASTERS_AT + w.CORE_A + core + w.READY]
    tries = state[w.MASTERS_AT + w.CORE_A + other + w.READY]
    held, reads, latency = hold_of(state, w.FETCH_BYTES), state[w.L2_READ], stall_of_word(state)
    spin = state[w.JOBS_AT + other * w.JOB_WORDS + w.SPIN]
    turn = reads + state[w.L2_NEXT] + spin
    stamp, logged = state[job + w.PRESENT] >> log.STAMP_BIT, logged_stamp(state, core)
    free, its_turn, stalled, last = state[w.L2_FREE], has_turn(state, other), state[job + w.STALLED], w.NONE
    words, tried, waits, most = 0, 0, 0, words_in_row(state, core)
    while words < most and stamp < logged:
        at, tries_at = max(ready, free), max(tries, free)
        if min(at, tries_at) >= limit:
            break
        if tries_at < at or (tries_at == at and its_turn):
            times = tries_before(tries_at, turn, min(limit, ready))
            tried, tries, its_turn = tried + times, tries_at + times * turn, False
            free = tries - spin
        else:
            waited = cycles_until(state, ready, at + cclk)
            words, free, last, its_turn = words + 1, at + held, at, True
            waits, stalled = waits + waited, stalled + (waited + latency) * cclk
            stamp = (state[job + w.FETCHED] + words) * state[job + w.TOTAL] // state[job + w.FETCHES]
            ready = max(at + reads, state[job + w.BEGIN] + stamp * cclk + stalled)
    if tried:
        lock_l2(state, other, free, tried)
        state[w.MASTERS_AT + w.CORE_A + other + w.READY] = tries
    if words:
        if waits:
            charge(state, core, w.L2_PORT, waits)
        keep_fetched(state, core, words, last, stalled)
        state[w.L2_FREE], state[w.LAST_CORE_AT_L2] = free, core if its_turn else other
    return words + tried > 0


@native
def words_in_row(state: State, core: int) -> int:
    """How many words of one routine and of one owner a core fetches next, and another one behind them: 0 where a word is not all that it waits for."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    offset = state[job + w.PRESENT] & log.OFFSET_MASK
    if (
        offset < state[w.SDRAM_END]
        or state[job + w.STORES]
        or 1 << state[w.L2_PORT_BITS] < w.FETCH_BYTES
        or state[w.L2_NEXT] > state[w.L2_READ]
    ):
        return 0
    row = site_at(core, state[job + w.SITE])
    piece = piece_for(state, row, offset)
    return min(
        state[job + w.FETCHES] - state[job + w.FETCHED] - 1,
        state[row + w.CODE_WORDS] - state[job + w.WORD],
        (state[w.PIECES_AT + piece + 1] - offset) // w.FETCH_BYTES,
    )


@native
def logged_stamp(state: State, core: int) -> int:
    """Return the stamp of the next access in a core's log, NEVER if there is none."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    if state[job + w.ENTRY] >= state[job + w.END]:
        return w.NEVER
    return state[w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + state[job + w.ENTRY]] >> log.STAMP_BIT


@native
def words_alone(state: State, core: int, at: int, until: int) -> int:
    """How many words a core is sure to fetch alike from tick `at` on, and another one behind them before tick `until`."""
    job, cclk = w.JOBS_AT + core * w.JOB_WORDS, state[w.CCLK]
    stamp = state[job + w.PRESENT] >> log.STAMP_BIT
    is_late = at != state[job + w.BEGIN] + stamp * cclk + state[job + w.STALLED]  # or waits for the port
    if is_late or state[job + w.TOTAL] < state[job + w.FETCHES]:
        return 0
    apart = state[job + w.TOTAL] // state[job + w.FETCHES] + 1  # cycles from a word to the next, at most
    return min(
        words_in_row(state, core),
        (until - at - 1) // ((apart + stall_of_word(state)) * cclk),
        (logged_stamp(state, core) - stamp - 1) // apart,
    )


@native
def stall_of_word(state: State) -> int:
    """Return for how many cycles a word stalls a core that has the port to itself."""
    return cycles_until(state, 0, state[w.L2_READ])


@native
def fetch_words(state: State, core: int, words: int) -> None:
    """Fetch so many words of a core's code, as many as `words_alone` says at most."""
    job, cclk, stalled = w.JOBS_AT + core * w.JOB_WORDS, state[w.CCLK], stall_of_word(state)
    stamp = (state[job + w.FETCHED] + words - 1) * state[job + w.TOTAL] // state[job + w.FETCHES]
    last = state[job + w.BEGIN] + state[job + w.STALLED] + (stamp + (words - 1) * stalled) * cclk
    keep_fetched(state, core, words, last, state[job + w.STALLED] + words * stalled * cclk)


@native
def keep_fetched(state: State, core: int, words: int, last: int, stalled: int) -> None:
    """Count so many words of code that a core has fetched, the `last` one from a tick on, and the ticks that its call was stalled by then."""
    job, row = w.JOBS_AT + core * w.JOB_WORDS, site_at(core, site_of(state, core))
    owner = state[w.PIECES_AT + w.MAX_PIECES + state[row + w.PIECE]]
    count_traffic(state, w.CORE_A + core, owner, False, words * w.FETCH_BYTES)
    charge(state, core, w.CODE_FETCH, words * stall_of_word(state))
    go_past_code(state, job, row, words)
    state[job + w.STALLED], state[job + w.LINE_DONE] = stalled, last + state[w.L2_READ]
    hold_l2(state, core, last, w.FETCH_BYTES)
    next_entry(state, core, state[job + w.LINE_DONE])
