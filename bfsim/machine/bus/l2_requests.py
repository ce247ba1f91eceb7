"""Loads and stores of words of L2, compiled: which of them nobody can come between but a core that spins on a lock."""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.l2_words import is_word_in_l2, play_words
from bfsim.machine.bus.state import State


@native
def access_ahead(state: State, core: int, until: int) -> bool:
    """Make loads and stores of L2, a core's and the other one's in turns, and what a spinning core does meanwhile; return whether there were any.

    Until tick `until` no DMA can want the port. The last access of a call is left, and so is one before something else.
    """
    had_any = False
    while access_before_other(state, core, until):
        had_any, core = True, w.CORES - 1 - core
    return had_any


@native
def access_before_other(state: State, core: int, until: int) -> bool:
    """Make a core's loads and stores of L2 that come before the other one does anything but try a lock; return whether there were any."""
    job, other = w.JOBS_AT + core * w.JOB_WORDS, w.CORES - 1 - core
    if not is_eligible(state, core, other):
        return False
    limit = min(until, state[w.MASTERS_AT + w.STORES_A + other + w.READY])
    if not state[w.JOBS_AT + other * w.JOB_WORDS + w.SPIN]:
        limit = min(limit, state[w.MASTERS_AT + w.CORE_A + other + w.READY])
    before = state[job + w.ENTRY], state[job + w.STORES], state[w.L2_FREE]
    play_words(state, core, other, limit)
    return before != (state[job + w.ENTRY], state[job + w.STORES], state[w.L2_FREE])


@native
def is_eligible(state: State, core: int, other: int) -> bool:
    """Whether all that a core does next is such as `play_words` plays."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    if (
        state[job + w.STATE] != w.RUNNING
        or state[job + w.IN_TURN]
        or not is_word_in_l2(state, state[job + w.PRESENT])
        or state[job + w.LINE_DONE] > state[job + w.ISSUED_AT]
        or state[w.JOBS_AT + other * w.JOB_WORDS + w.STORES]
    ):
        return False
    for number in range(state[job + w.STORES]):
        place = (state[job + w.STORE_HEAD] + number) % w.MAX_STORES
        if state[job + w.STORE_QUEUE + place] & log.OFFSET_MASK < state[w.SDRAM_END]:
            return False
    return True
