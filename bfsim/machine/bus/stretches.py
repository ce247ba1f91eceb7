"""Stretches, compiled: a core does one operation after the other by its own clock, and meets the bus where it has to.

The operations say how many cycles the core's work takes; its waits come from the bus. A stretch ends at the tick at which the
core last met the bus, though its clock may be later.
"""

from __future__ import annotations

from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_jobs import start_job
from bfsim.machine.bus.state import State


@native
def end_of_stretch(core: int) -> int:
    """Return the number with which `advance` returns at the end of a core's stretch: beyond those of transfers and jobs."""
    return w.NONE - 1 - w.CORES - core


@native
def moment_of(core: int) -> int:
    """Return the number with which `advance` returns at a moment of a core's stretch."""
    return w.NONE - 1 - 2 * w.CORES - core


@native
def who_acts(state: State) -> int:
    """Return the core that acts first."""
    first = 0
    for core in range(1, w.CORES):
        at = w.PLAYS_AT + w.ACTS_AT
        if state[at + core * w.PLAY_WORDS] < state[at + first * w.PLAY_WORDS]:
            first = core
    return first


@native
def resume(state: State, woken: int) -> bool:
    """Let the core whose stretch waits for `woken`, which has just ended, go on then. Return whether there is one."""
    for core in range(w.CORES):
        play = w.PLAYS_AT + core * w.PLAY_WORDS
        if state[play + w.AWAITED] == woken:
            state[play + w.ACTS_AT] = state[w.DONE_AT]
            return True
    return False


@native
def act(state: State, core: int, now: int) -> int:
    """Do a core's operations until it must wait. The bus has been played up to tick `now`. Return the end or a moment of the stretch, or NONE."""
    play = w.PLAYS_AT + core * w.PLAY_WORDS
    if state[play + w.AWAITED] != w.NONE:
        end_wait(state, core, now)
    while state[play + w.OPERATION] < state[play + w.OPERATIONS_END]:
        at = operation_of(state, core)
        if state[at] == w.MOMENT:
            state[play + w.OPERATION] += 1
            state[play + w.ACTS_AT] = state[w.DONE_AT] = now
            return moment_of(core)
        if needs_bus(state, core, at):
            clock = state[play + w.CLOCK] * state[w.CCLK]
            if clock > now:
                state[play + w.ACTS_AT] = clock
                return w.NONE
            if must_wait(state, at):
                begin_wait(state, core, clock)
                return w.NONE
        if not do(state, core, at, now):
            break
        go_on(state, core, at)
    state[play + w.ACTS_AT] = w.NEVER
    state[w.DONE_AT] = now
    return end_of_stretch(core)


@native
def needs_bus(state: State, core: int, at: int) -> bool:
    """Whether the bus must catch up with a core before its operation. A wait needs that only if the copy's end is unknown."""
    kind = state[at]
    if kind == w.AWAIT:
        return end_of_copy(state, core, state[at + 1]) == w.NONE
    return kind in (w.ACCESS, w.CATCH_UP)


@native
def must_wait(state: State, at: int) -> bool:
    """Whether an operation that needs the bus must wait for it. A call may turn out to access nothing."""
    return state[at] == w.AWAIT or (state[at] == w.ACCESS and state[at + 3] != state[at + 4])


@native
def do(state: State, core: int, at: int, now: int) -> bool:
    """Do an operation that waits for nothing unknown. Return whether it could be done."""
    play, kind = w.PLAYS_AT + core * w.PLAY_WORDS, state[at]
    if kind in (w.RUN, w.ACCESS):
        work(state, play, state[at + 1], state[at + 2])
    elif kind == w.SET_UP:
        spend(state, play, state[at + 2], w.SETTING_UP, state[at + 1])
    elif kind == w.AWAIT:
        wait_until(state, core, end_of_copy(state, core, state[at + 1]))
    elif kind == w.COPY:
        return post(state, core, at, now)
    return True


@native
def operation_of(state: State, core: int) -> int:
    """Return where a core's current operation is."""
    number = core * w.MAX_OPERATIONS + state[w.PLAYS_AT + core * w.PLAY_WORDS + w.OPERATION]
    return w.OPERATIONS_AT + number * w.OPERATION_WORDS


@native
def begin_wait(state: State, core: int, clock: int) -> None:
    """Let the bus play a call's accesses, or a copy whose end is unknown, before the core goes on."""
    play, at = w.PLAYS_AT + core * w.PLAY_WORDS, operation_of(state, core)
    state[play + w.ACTS_AT] = w.NEVER
    if state[at] == w.ACCESS:
        start_job(state, core, clock, state[at + 1] + state[at + 2], state[at + 3], state[at + 4])
        state[play + w.AWAITED] = w.NONE - 1 - core
    else:
        copy = copy_before(state, core, state[at + 1])
        state[w.TRANSFERS_AT + state[copy + 1] * w.TRANSFER_WORDS + w.WAKE] = w.AT_END
        state[play + w.AWAITED] = state[copy]


@native
def end_wait(state: State, core: int, now: int) -> None:
    """Charge the wait that ends at tick `now`, and go on to the core's next operation."""
    play, at = w.PLAYS_AT + core * w.PLAY_WORDS, operation_of(state, core)
    if state[at] == w.ACCESS:
        work(state, play, state[at + 1], state[at + 2])
        for reason in range(w.STALLS):
            cclk = state[w.JOBS_AT + core * w.JOB_WORDS + w.STALL + reason]
            state[play + w.ON_BUS + reason] += cclk
            state[play + w.CLOCK] += cclk
    else:
        wait_until(state, core, now)
    state[play + w.AWAITED] = w.NONE
    go_on(state, core, at)


@native
def go_on(state: State, core: int, at: int) -> None:
    """Go on to a core's next operation. If there is a timeline, keep what the operation `at` took."""
    play = w.PLAYS_AT + core * w.PLAY_WORDS
    number, kind = state[play + w.OPERATION], state[at]
    state[play + w.OPERATION] = number + 1
    if state[w.TAPES_AT + core * w.TAPE_WORDS + w.IS_TOLD] == 0:
        return
    took = w.TOOK_AT + (core * w.MAX_OPERATIONS + number) * w.TOOK_WORDS
    state[took + w.UNTIL] = state[play + w.CLOCK]
    if kind == w.COPY:
        copy = copy_before(state, core, 1)
        state[took + w.COPIED] = state[copy]
        state[took + w.POSTED_AT] = state[w.TRANSFERS_AT + state[copy + 1] * w.TRANSFER_WORDS + w.AT]
    elif kind == w.AWAIT:
        state[took + w.COPIED] = state[copy_before(state, core, state[at + 1])]
    elif kind == w.ACCESS:
        has_met_bus = state[at + 3] != state[at + 4]
        for reason in range(w.STALLS):
            stall = state[w.JOBS_AT + core * w.JOB_WORDS + w.STALL + reason]
            state[took + w.CALL_STALLS + reason] = stall if has_met_bus else 0


@native
def work(state: State, play: int, issue: int, interlocks: int) -> None:
    """Let the cycles of a call pass."""
    state[play + w.ISSUED] += issue
    state[play + w.INTERLOCKED] += interlocks
    state[play + w.CLOCK] += issue + interlocks


@native
def spend(state: State, play: int, number: int, reason: int, cclk: int) -> None:
    """Let cycles pass on an account."""
    account = play + w.ACCOUNTS + number * w.ACCOUNT_WORDS
    if state[account + w.TOUCH] == 0:
        state[play + w.TOUCHED] += 1
        state[account + w.TOUCH] = state[play + w.TOUCHED]
    state[account + reason] += cclk
    state[play + w.CLOCK] += cclk


@native
def wait_until(state: State, core: int, end: int) -> None:
    """Stall a core until tick `end`, when the copy that its operation awaits was over."""
    play, at = w.PLAYS_AT + core * w.PLAY_WORDS, operation_of(state, core)
    cclk = (end + state[w.CCLK] - 1) // state[w.CCLK] - state[play + w.CLOCK]
    if cclk > 0:
        spend(state, play, state[at + 3], state[at + 2], cclk)


@native
def copy_before(state: State, core: int, back: int) -> int:
    """Return where number and place of a core's copy are: the latest for `back` 1, the one before for 2, and so on."""
    number = state[w.PLAYS_AT + core * w.PLAY_WORDS + w.COPIES] - back
    return w.COPIES_AT + 2 * (core * w.ENDS + number % w.ENDS)


@native
def end_of_copy(state: State, core: int, back: int) -> int:
    """Return the tick at which such a copy was over, NONE if unknown yet."""
    return state[w.ENDS_AT + state[copy_before(state, core, back)] % w.ENDS]


@native
def post(state: State, core: int, at: int, now: int) -> bool:
    """Post the copy of the operation `at` at tick `now`, not before the core's clock. Return whether there was room for it."""
    play, plan = w.PLAYS_AT + core * w.PLAY_WORDS, w.PLANS_AT + state[at + 1] * w.PLAN_WORDS
    if state[w.FREE_TRANSFERS] == 0:
        return False
    state[w.FREE_TRANSFERS] -= 1
    place = state[w.FREE_PLACES_AT + state[w.FREE_TRANSFERS]]
    transfer, identity = w.TRANSFERS_AT + place * w.TRANSFER_WORDS, state[w.ALL_POSTED]
    state[w.ALL_POSTED] += 1
    state[w.ENDS_AT + identity % w.ENDS] = w.NONE
    for word in range(w.SETUP, w.TRANSFER_WORDS):
        state[transfer + word] = state[plan + word]
    state[transfer + w.FROM], state[transfer + w.TO] = state[at + 2], state[at + 3]
    state[transfer + w.IDENTITY], state[transfer + w.NEXT] = identity, w.NONE
    state[transfer + w.AT] = max(now, state[play + w.CLOCK] * state[w.CCLK])
    posted = w.POSTS_AT + 2 * state[w.POSTED]
    state[posted], state[posted + 1] = state[plan + w.OF_MASTER], place
    state[w.POSTED] += 1
    state[play + w.COPIES] += 1
    copy = copy_before(state, core, 1)
    state[copy], state[copy + 1] = identity, place
    return True
