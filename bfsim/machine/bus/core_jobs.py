"""The accesses of a core outside L1 in a kernel call, compiled: one after the other, with the stalls of each."""

from __future__ import annotations

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import kind_of, site_at
from bfsim.machine.bus.pacing import aligned
from bfsim.machine.bus.state import State


@native
def bytes_of(state: State, kind: int) -> int:
    """Return the bytes that an access of this kind moves: a 32-bit word whatever its width, a cache line, or 64 bits of code."""
    if kind == log.FETCH:
        return w.FETCH_BYTES
    is_line = (
        kind in (log.FILL, log.WRITE_BACK) or kind == log.FETCH_LINE
    )  # a tuple of three becomes a loop in compiled code
    return state[w.LINE_BYTES] if is_line else w.CORE_WORD_BYTES


@native
def site_of(state: State, core: int) -> int:
    """Return the site of the core's current access."""
    return state[w.JOBS_AT + core * w.JOB_WORDS + w.SITE]


@native
def charge(state: State, core: int, reason: int, cycles: int) -> None:
    """Charge a stall of the core's current access."""
    charge_site(state, core, site_of(state, core), reason, cycles)


@native
def charge_site(state: State, core: int, site: int, reason: int, cycles: int) -> None:
    """Charge a stall of an access of one of a core's sites."""
    state[w.JOBS_AT + core * w.JOB_WORDS + w.STALL + reason] += cycles
    state[site_at(core, site) + reason] += cycles


@native
def cycles_until(state: State, issued: int, done: int) -> int:
    """Return the stall cycles of an access that was `issued` at one tick and `done` at another: all but its own cycle."""
    ticks = done - issued
    return whole_cycles(state, ticks - 1) if ticks > state[w.CCLK] else 0


@native
def whole_cycles(state: State, ticks: int) -> int:
    """Return the number of whole cycles in so many ticks."""
    return (
        ticks if state[w.CCLK] == 1 else ticks // state[w.CCLK]
    )  # a division takes the host longer than everything else here


@native
def wait(state: State, core: int, done: int) -> int:
    """Stall the core from its current access until `done`. Return the cycles, for the caller to charge."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    cycles = cycles_until(state, state[job + w.ISSUED_AT], done)
    state[job + w.STALLED] += cycles * state[w.CCLK]
    return cycles


@native
def stall(state: State, core: int, done: int, reason: int) -> None:
    """Stall the core for `reason` from its current access until `done`."""
    cycles = wait(state, core, done)
    if cycles:
        charge(state, core, reason, cycles)


@native
def count_fetched(state: State, job: int, fetched: int) -> None:
    """Note how often a core has fetched code in its call. The fetches are spread evenly over the call."""
    state[job + w.FETCHED], fetches = fetched, state[job + w.FETCHES]
    state[job + w.NEXT_FETCH] = fetched * state[job + w.TOTAL] // fetches if fetched < fetches else w.NEVER


@native
def find_present(state: State, core: int) -> bool:
    """Find the core's next access, in its log or in the code that it fetches. Return whether there is one.

    In one cycle, logged accesses come before a fetch.
    """
    job = w.JOBS_AT + core * w.JOB_WORDS
    at = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + state[job + w.ENTRY]
    is_logged = state[job + w.ENTRY] < state[job + w.END]
    stamp = state[job + w.NEXT_FETCH]
    if stamp != w.NEVER and (not is_logged or stamp < state[at] >> log.STAMP_BIT):
        site = state[job + w.SITE] = state[job + w.ROUTINE]
        code = state[site_at(core, site) + w.CODE]
        place = code + state[job + w.WORD] * w.FETCH_BYTES
        state[job + w.PRESENT] = stamp << log.STAMP_BIT | log.FETCH << log.KIND_BIT | place
        state[job + w.IN_TURN] = 1
        return True
    state[job + w.IN_TURN] = 0
    if is_logged:
        state[job + w.PRESENT], state[job + w.SITE] = state[at], state[at + w.LOG_ENTRIES]
    return is_logged


@native
def go_past(state: State, core: int) -> None:
    """Move past the current access, in the code or in the log."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    if not state[job + w.IN_TURN]:
        state[job + w.ENTRY] += 1
        return
    go_past_code(state, job, site_at(core, state[job + w.SITE]), 1)


@native
def go_past_code(state: State, job: int, row: int, words: int) -> None:
    """Leave so many words of the code of the routine at `row` behind, none beyond its end."""
    count_fetched(state, job, state[job + w.FETCHED] + words)
    state[job + w.WORD] += words
    if state[job + w.WORD] == state[row + w.CODE_WORDS]:
        state[job + w.WORD], state[job + w.ROUTINE] = 0, state[row + w.NEXT_ROUTINE]


@native
def next_entry(state: State, core: int, not_before: int) -> int:
    """Set up the core's next access. After the last one, end the job and return its number, NONE - 1 - core."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    master = w.MASTERS_AT + w.CORE_A + core
    cclk = state[w.CCLK]
    if not find_present(state, core):
        state[job + w.STATE] = w.IDLE
        state[master + w.READY] = w.NEVER
        state[w.DONE_AT] = state[job + w.BEGIN] + state[job + w.TOTAL] * cclk + state[job + w.STALLED]
        return w.NONE - 1 - core
    entry = state[job + w.PRESENT]
    issued = max(not_before, state[job + w.BEGIN] + (entry >> log.STAMP_BIT) * cclk + state[job + w.STALLED])
    kind = kind_of(entry)
    waits = kind not in (log.STORE, log.WRITE_BACK)
    if waits and state[job + w.LINE_DONE] > issued:  # a core reads one line at a time
        cycles = (state[job + w.LINE_DONE] - issued + cclk - 1) // cclk
        charge(state, core, w.CODE_FETCH if kind == log.FETCH_LINE else w.CACHE_FILL, cycles)
        state[job + w.STALLED] += cycles * cclk
        issued += cycles * cclk
    state[job + w.ISSUED_AT] = issued
    if waits:
        ask(state, master, entry & log.OFFSET_MASK, issued)
    else:  # the store buffer requests it, once it has it
        state[master + w.USES], state[master + w.READY] = w.NOTHING, issued
    return w.NONE


@native
def ask(state: State, master: int, offset: int, at: int) -> None:
    """Let a core request the SDRAM bus or the port of L2, whichever `offset` needs, from tick `at` on."""
    in_sdram = offset < state[w.SDRAM_END]
    state[master + w.USES] = w.SDRAM if in_sdram else w.L2
    state[master + w.READY] = aligned(at, state[w.SCLK]) if in_sdram else at


@native
def start_jobs(state: State) -> None:
    """Let the cores begin the jobs that they were given."""
    for core in range(w.CORES):
        job = w.JOBS_AT + core * w.JOB_WORDS
        if state[job + w.STATE] == w.STARTING:
            start_job(state, core, state[job + w.BEGIN], state[job + w.TOTAL], 0, state[job + w.END])


@native
def start_job(state: State, core: int, begin: int, cclk: int, first: int, end: int) -> None:
    """Let a core begin with the accesses from `first` to before `end` of its log, for a call of `cclk` cycles from tick `begin`."""
    job = w.JOBS_AT + core * w.JOB_WORDS
    state[job + w.STATE] = w.RUNNING
    state[job + w.BEGIN], state[job + w.TOTAL], state[job + w.STALLED] = begin, cclk, 0
    state[job + w.ENTRY], state[job + w.END] = first, end
    state[job + w.FETCHES] = 0
    last = w.LOGS_AT + core * w.ACCESS_TRACE_WORDS + log.LOG + end - 1
    if first < end and kind_of(state[last]) == log.FETCHES:
        state[job + w.END] -= 1
        state[job + w.FETCHES] = state[last] >> log.STAMP_BIT
        state[job + w.ROUTINE], state[job + w.WORD] = state[last + w.LOG_ENTRIES], 0
    count_fetched(state, job, 0)
    for reason in range(w.STALLS):
        state[job + w.STALL + reason] = 0
    next_entry(state, core, begin)
