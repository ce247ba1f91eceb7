"""What a core wants of L2 next, compiled: read from the state of the bus, and kept there."""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import kind_of
from bfsim.machine.bus.l2_accesses import (
    CORE,
    DRAINS_AT,
    ORIGIN,
    PLACE,
    PUTS,
    READY,
    SPIN,
    Request,
    first_place,
    is_word_in_l2,
)
from bfsim.machine.bus.state import State


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
def is_playable(state: State, core: int) -> bool:
    """Whether all that a core wants next is such as `l2_words` plays. One that is idle may have a buffer to drain."""
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
def left_until(state: State, core: int, request: Request) -> int:
    """Return when a core asks for what `l2_words` does not play."""
    if request[CORE] != w.NONE:
        return w.NEVER
    return min(
        state[w.MASTERS_AT + w.CORE_A + core + w.READY], state[w.MASTERS_AT + w.STORES_A + core + w.READY]
    )


@native
def keep(state: State, request: Request) -> None:
    """Keep what a core wants next, if `l2_words` has played that."""
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
