"""The weave, compiled: every word that a DMA, a camera or a core moves over the SDRAM bus or the port of L2, in order of time.

`advance` plays the masters against each other up to a tick. The one whose request comes first has the bus; of several, the
one with the best rank. Runs of words that nobody can interrupt are done at once, which saves the host's time only.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from numpy.typing import NDArray

from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.camera_words import take_hits
from bfsim.machine.bus.core_jobs import start_jobs
from bfsim.machine.bus.core_requests import serve_core
from bfsim.machine.bus.dma_requests import serve_dma
from bfsim.machine.bus.fetch_requests import fetch_ahead
from bfsim.machine.bus.l2_words import play_l2_words
from bfsim.machine.bus.pacing import arrival
from bfsim.machine.bus.runs import copies_quiet_until, devices_quiet_until, l2_left_until, others_quiet_until
from bfsim.machine.bus.sdram import hold_up
from bfsim.machine.bus.sdram_words import is_word, play_sdram_words
from bfsim.machine.bus.state import Memory, State
from bfsim.machine.bus.store_buffer import serve_stores
from bfsim.machine.bus.stretches import act, resume, who_acts
from bfsim.machine.bus.transfers import accept
from bfsim.machine_code.built_in import built_in

# What changes a rank (HRM of the BF537, 5-50 to 5-54): an urgent request comes before everything else, one against the
# direction of the traffic behind all of its kind. A request that needs nothing cannot keep anybody waiting. At the port of
# L2 the internal DMA and the cores take turns [assumed].
NEEDS_NOTHING, URGENT, AGAINST, HAD_ITS_TURN, HAD_THE_BUS, IMDMA_FIRST = -10_000, -1_000, 100, 2, 2, -1_000


@native
def rank_of(state: State, number: int, at: int) -> int:
    """Return the rank of a master's request at tick `at`."""
    if number >= w.STORES_A:
        return rank_of_core(state, number)
    master = w.MASTERS_AT + number
    rank = state[master + w.RANK]
    uses = state[master + w.USES]
    if uses == w.NOTHING:
        return rank + NEEDS_NOTHING
    if uses == w.L2:
        return rank + (-IMDMA_FIRST if state[w.IMDMA_HAD_L2] else IMDMA_FIRST)
    if state[w.DEB_LEFT] > 0 and state[master + w.WRITES] != state[w.LAST_WRITE]:
        rank += AGAINST
    if state[master + w.PARTNER] != w.NONE and 0 < state[w.MDMA_PERIOD] <= state[master + w.SERVED]:
        rank += HAD_ITS_TURN
    return rank + (URGENT if is_urgent(state, master, at) else 0)


@native
def rank_of_core(state: State, number: int) -> int:
    """Return the rank of what a core or its store buffer asks for: the cores take turns, with their loads and with their stores."""
    master = w.MASTERS_AT + number
    rank, uses = state[master + w.RANK], state[master + w.USES]
    if uses == w.NOTHING:
        return rank + NEEDS_NOTHING
    last = state[w.LAST_CORE] if uses == w.SDRAM else state[w.LAST_CORE_AT_L2]
    return rank + (HAD_THE_BUS if last == (number - w.STORES_A) % w.CORES else 0)


@native
def is_urgent(state: State, master: int, at: int) -> bool:
    """Whether a device's FIFO is more than half full at tick `at`, or less than half of what it has to send is left."""
    transfer = w.TRANSFERS_AT + state[master + w.TRANSFER] * w.TRANSFER_WORDS
    half = state[master + w.FIFO] // 2
    if state[transfer + w.MODE] == w.PACED_IN:
        return arrival(state, transfer, half) <= at
    return state[transfer + w.MODE] == w.PACED_OUT and arrival(state, transfer, -1 - half) <= at


@native
def count_direction(state: State, before: int) -> None:
    """Begin the period in which requests of the same direction are preferred, or use up a transfer of it."""
    if state[w.LAST_WRITE] != before:
        state[w.DEB_LEFT] = state[w.DEB_PERIOD]
    elif state[w.DEB_LEFT] > 0:
        state[w.DEB_LEFT] -= 1


@native
def first_request(state: State, until: int) -> tuple[int, int]:
    """Return whose request can be served first, and when; NONE if nobody's before tick `until`."""
    first, first_at = first_of_cores(state, until)
    for number in range(w.STORES_A):
        master = w.MASTERS_AT + number
        at = state[master + w.READY]
        if at <= first_at:
            at = max(at, free_for(state, state[master + w.USES]))
            if at < first_at or (
                at == first_at and first != w.NONE and rank_of(state, number, at) < rank_of(state, first, at)
            ):
                first, first_at = number, at
    return first, first_at


@native
def free_for(state: State, uses: int) -> int:
    """Return when what a request needs is free."""
    if uses == w.NOTHING:
        return 0
    return state[w.L2_FREE] if uses == w.L2 else state[w.COMMAND_FREE]


@native
def first_of_cores(state: State, until: int) -> tuple[int, int]:
    """Return which of the cores and their store buffers that is."""
    first, at = sooner(state, w.CORE_A, w.NONE, until)
    first, at = sooner(state, w.CORE_B, first, at)
    first, at = sooner(state, w.STORES_A, first, at)
    return sooner(state, w.STORES_B, first, at)


@native
def sooner(state: State, number: int, first: int, first_at: int) -> tuple[int, int]:
    """Return who comes first, and when: a core or its store buffer, or the `first` of others, which can be served at a tick."""
    ready = state[w.MASTERS_AT + number + w.READY]
    if ready > first_at:
        return first, first_at
    at = max(ready, free_for(state, state[w.MASTERS_AT + number + w.USES]))
    if at < first_at or (
        at == first_at and first != w.NONE and rank_of_core(state, number) < rank_of_core(state, first)
    ):
        return number, at
    return first, first_at


@native
def serve_with_cameras(state: State, memory: Memory, number: int, at: int, until: int) -> int:
    """Serve a PPI or a memory DMA, and go on while only they can want the bus; return who is woken.

    Most requests are theirs; this saves looking at everybody each time. One whose next transfer needs no bus is left to `grant`.
    """
    quiet_until = others_quiet_until(state, until)
    while True:
        woken = serve_dma(state, memory, number, at, until, quiet_until)
        if woken != w.NONE or state[w.MASTERS_AT + number + w.USES] != w.SDRAM:
            return woken
        number, at = first_with_cameras(state, quiet_until)
        if number in (w.PPI0, w.PPI1):
            take_hits(state, memory, copies_quiet_until(state, quiet_until))
            number, at = first_with_cameras(state, quiet_until)
        if number == w.NONE:
            return w.NONE


@native
def first_with_cameras(state: State, until: int) -> tuple[int, int]:
    """Return which of the PPIs and the memory DMAs has the SDRAM bus next, and when; NONE if not before tick `until`.

    They are numbered in the order of their ranks; of the others none asks before `until`. Most often somebody waits, and the branches that find who are predicted well.
    """
    free = state[w.COMMAND_FREE]
    if free >= until:
        return w.NONE, until
    left, right = state[w.MASTERS_AT + w.PPI0 + w.READY], state[w.MASTERS_AT + w.PPI1 + w.READY]
    if min(left, right) <= free:
        return first_camera(state, max(left, free), max(right, free)), free
    for number in range(w.MDMA1_0, w.MDMA2_1 + 1):
        if state[w.MASTERS_AT + number + w.READY] <= free:
            return number, free
    first, at = w.NONE, until
    for number in range(w.MDMA1_0, w.MDMA2_1 + 1):
        ready = state[w.MASTERS_AT + number + w.READY]
        if ready < at:
            first, at = number, ready
    if min(left, right) < until and min(left, right) <= at:
        return first_camera(state, left, right), min(left, right)
    return first, at


@native
def first_camera(state: State, left: int, right: int) -> int:
    """Return which of the PPIs has the bus first, each of which can have it from a tick on: if at once, the more urgent one."""
    if left == right:
        is_left_urgent = is_urgent(state, w.MASTERS_AT + w.PPI0, left)
        return w.PPI1 if is_urgent(state, w.MASTERS_AT + w.PPI1, right) and not is_left_urgent else w.PPI0
    return w.PPI0 if left < right else w.PPI1


@native
def serve_cores(state: State, memory: Memory, until: int) -> int:
    """Serve the cores for as long as no DMA comes between; return who is woken.

    At the port of L2 they go ahead of the DMAs that use the SDRAM bus: neither keeps the other waiting. Where buffers or code lie
    outside of L1 most requests are the cores'; this saves looking at everybody each time.
    """
    number, at = first_of_cores(state, until)
    if number == w.NONE:
        return w.NONE
    l2_until, sdram_until = l2_left_until(state, w.NONE, until), devices_quiet_until(state, until)
    while number != w.NONE and at < l2_until:
        in_sdram = state[w.MASTERS_AT + number + w.USES] == w.SDRAM
        if in_sdram and at < sdram_until and is_word(state, number):
            woken = play_sdram_words(state, memory, min(l2_until, sdram_until))
            if woken != w.NONE:
                return woken
            number, at = first_of_cores(state, l2_until)
            if number == w.NONE:
                return w.NONE
            in_sdram = state[w.MASTERS_AT + number + w.USES] == w.SDRAM
        if in_sdram and (at >= copies_quiet_until(state, sdram_until) or hold_up(state, at)):
            return w.NONE
        if in_sdram or number < w.CORE_A or not go_ahead(state, number - w.CORE_A, at, l2_until):
            woken = serve_core_or_stores(state, number, at, l2_until)
            if woken != w.NONE:
                return woken
        number, at = first_of_cores(state, l2_until)
    return w.NONE


@native
def go_ahead(state: State, core: int, at: int, until: int) -> bool:
    """Do at once what a core does from tick `at` on, if that is of a kind; return whether it is. No DMA wants L2 before tick `until`.

    The tries of one that spins on a lock are among what the other one does.
    """
    if state[w.JOBS_AT + core * w.JOB_WORDS + w.SPIN]:
        core = w.CORES - 1 - core
    return fetch_ahead(state, core, at, until) or play_l2_words(state, core, until)


@native
def serve_core_or_stores(state: State, number: int, at: int, until: int) -> int:
    """Serve what a core waits for, or its store buffer, no DMA wanting the port of L2 before tick `until`; return who is woken."""
    if number >= w.CORE_A:
        return serve_core(state, number - w.CORE_A, at, until)
    return serve_stores(state, number - w.STORES_A, at)


@native
def is_with_cameras(state: State, number: int) -> bool:
    """Whether a request is one of those that come in turn with those of the cameras."""
    if state[w.DEB_PERIOD] or state[w.MDMA_PERIOD] or state[w.MASTERS_AT + number + w.USES] != w.SDRAM:
        return False
    return number <= w.PPI1 or w.MDMA1_0 <= number <= w.MDMA2_1


@native
def serve(state: State, memory: Memory, number: int, at: int, until: int) -> int:
    """Serve the request of a master; return who is woken."""
    if is_with_cameras(state, number):
        return serve_with_cameras(state, memory, number, at, until)
    if number >= w.STORES_A:
        return serve_core_or_stores(state, number, at, l2_left_until(state, w.NONE, until))
    return serve_dma(state, memory, number, at, until, at)


@native
def grant(state: State, memory: Memory, until: int) -> int:
    """Grant all requests before tick `until`, in order; return early with who is woken, at tick DONE_AT, else NONE."""
    while True:
        woken = serve_cores(state, memory, until)
        if woken != w.NONE:
            return woken
        first, at = first_request(state, until)
        if first == w.NONE:
            return w.NONE
        if state[w.MASTERS_AT + first + w.USES] == w.SDRAM and hold_up(state, at):
            continue  # meanwhile others may ask who come first
        before, counts = (
            state[w.LAST_WRITE],
            first < w.STORES_A and state[w.DEB_PERIOD] and state[w.MASTERS_AT + first + w.USES] == w.SDRAM,
        )
        woken = serve(state, memory, first, at, until)
        if counts:
            count_direction(state, before)
        if woken != w.NONE:
            return woken


@native_entry("int64", "int64*", "uint32*", "int64")
def advance(state_at: State, memory_at: Memory, until: int) -> int:
    """Play everything before tick `until`: requests and, where the cores have stretches to play, these.

    Returns early with who is woken, at tick DONE_AT, else NONE: a transfer by its number, the job of core c by NONE - 1 - c, the end of
    its stretch by `end_of_stretch`, a moment of it by `moment_of`.
    """
    state, memory = words_at(state_at), words_at(memory_at)
    start_jobs(state)
    while True:
        accept(state)
        core = who_acts(state)
        acts_at = state[w.PLAYS_AT + core * w.PLAY_WORDS + w.ACTS_AT]
        woken = grant(state, memory, min(until, acts_at))
        if woken != w.NONE:
            if not resume(state, woken):
                return woken
        elif acts_at >= until:
            return w.NONE
        else:
            woken = act(state, core, acts_at)
            if woken != w.NONE:
                return woken


Weave = Callable[[NDArray[Any], NDArray[Any]], Callable[[int], int]]
"""Binds `advance` to a state and a memory: what is left to be told is the tick to advance to."""


def compiled_weave(state: NDArray[Any], memory: NDArray[Any]) -> Callable[[int], int]:
    """Bind the compiled `advance`. Both arrays must live as long as it is called."""
    return built_in(advance.address(), 1, state.ctypes.data, memory.ctypes.data, others_run=True)


def plain_weave(state: NDArray[Any], memory: NDArray[Any]) -> Callable[[int], int]:
    """Bind `advance` as plain Python, which does the same and takes much longer."""
    return partial(advance.python, state.data, memory.data)
