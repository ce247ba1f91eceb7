"""The port of L2 as used by the cores, compiled: reads of words, lines and code, and TESTSET."""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import bytes_of, site_of, stall
from bfsim.machine.bus.memory_owners import owner_for
from bfsim.machine.bus.state import State
from bfsim.machine.bus.traffic import count_traffic


@native
def hold_l2(state: State, core: int, at: int, nbytes: int) -> int:
    """Let a core have the port of L2 from tick `at` on for `nbytes`. Return when the port is free again."""
    state[w.LAST_CORE_AT_L2], state[w.IMDMA_HAD_L2] = core, 0
    state[w.L2_FREE] = at + hold_of(state, nbytes)
    return state[w.L2_FREE]


@native
def hold_of(state: State, nbytes: int) -> int:
    """Return the ticks for which `nbytes` hold the port."""
    return ((nbytes - 1 >> state[w.L2_PORT_BITS]) + 1) * state[w.L2_NEXT]


@native
def wait_for_l2(state: State, core: int, at: int) -> None:
    """Stall a core from its current access until it gets the port of L2, at tick `at`."""
    stall(state, core, at + state[w.CCLK], w.L2_PORT)
    state[w.JOBS_AT + core * w.JOB_WORDS + w.ISSUED_AT] = at


@native
def read_l2(state: State, core: int, at: int, kind: int, offset: int) -> int:
    """Read from L2 through the port that both cores share. Return when the first data are there."""
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
def test_and_set(state: State, core: int, at: int) -> int:
    """Read and write a byte of L2 with the port locked. Return when that is done."""
    locked = state[w.L2_READ] + state[w.L2_NEXT]
    wait_for_l2(state, core, at)
    stall(state, core, at + locked + state[w.CCLK], w.L2_LATENCY)
    lock_l2(state, core, at + locked, 1)
    return at + locked


@native
def try_lock(state: State, core: int, at: int, until: int) -> None:
    """Let a spinning core try its lock from tick `at` on. Until tick `until`, nothing else needs the port."""
    locked = state[w.L2_READ] + state[w.L2_NEXT]
    turn = locked + state[w.JOBS_AT + core * w.JOB_WORDS + w.SPIN]
    tries = tries_before(at, turn, until)
    lock_l2(state, core, at + (tries - 1) * turn + locked, tries)
    state[w.MASTERS_AT + w.CORE_A + core + w.READY] = at + tries * turn


@native
def lock_l2(state: State, core: int, free: int, times: int) -> None:
    """Let a core have the port of L2 until tick `free`, and count what it has read and written in so many tries."""
    state[w.LAST_CORE_AT_L2], state[w.IMDMA_HAD_L2], state[w.L2_FREE] = core, 0, free
    count_tries(state, core, times)


@native
def tries_before(at: int, turn: int, until: int) -> int:
    """Return how often a spinning core tries its lock from tick `at` on, every `turn` ticks, before tick `until`: at least once."""
    room = until - at - 1
    if room < 2 * turn:  # the usual case; a division takes the host longer than everything else here
        return 1 if room < turn else 2
    return 1 + room // turn


@native
def count_tries(state: State, core: int, times: int) -> None:
    """Count what a core has read and written by trying a lock so many times."""
    for write in (False, True):
        count_traffic(state, w.CORE_A + core, w.NO_BUFFER_IN_L2, write, times * w.CORE_WORD_BYTES)


@native
def has_turn(state: State, core: int) -> bool:
    """Whether a core goes before the other one at the port."""
    last = state[w.LAST_CORE_AT_L2]
    return last == w.CORES - 1 - core or (last == w.NONE and core == 0)
