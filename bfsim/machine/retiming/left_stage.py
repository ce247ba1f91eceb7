"""A stage that ends within a stretch, compiled: its cost is kept apart from the next stage's."""

from __future__ import annotations

from collections.abc import MutableSequence
from typing import Any

from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import State
from bfsim.machine.calls.conflicts import charged, count_since

CONFLICTS = 0
"""The cost of a stage since the last charge: cycles of conflicts in L1, then the words of a stretch (`bus.state`) from TOUCHED on."""
OF_STRETCH = 1
COST_WORDS = OF_STRETCH + w.PLAY_WORDS - w.TOUCHED

Costs = MutableSequence[int]


@native
def move_costs(state: State, core: int, costs: Costs, accounts: int) -> int:
    """Add what a core's stretch took so far, on so many accounts, to the costs of a stage, and reset it in the stretch. Return 0."""
    play = w.PLAYS_AT + core * w.PLAY_WORDS
    touched = costs[OF_STRETCH]
    for number in range(accounts):
        touch = w.ACCOUNTS + number * w.ACCOUNT_WORDS + w.TOUCH
        kept = OF_STRETCH + touch - w.TOUCHED
        if state[play + touch] and costs[kept] == 0:
            costs[kept] = touched + state[play + touch]  # after the accounts that were used before
        state[play + touch] = 0
    for word in range(w.TOUCHED, w.ACCOUNTS + accounts * w.ACCOUNT_WORDS):
        costs[OF_STRETCH + word - w.TOUCHED] += state[play + word]
        state[play + word] = 0
    return 0


@native_entry("int64", "int64*", "int64", "int64*", "int64")
def end_stretch(state_at: Any, core: int, costs_at: Any, accounts: int) -> int:
    """Add to the costs of the current stage as above."""
    return move_costs(words_at(state_at), core, words_at(costs_at), accounts)


@native_entry(
    "int64", "int64*", "int64*", "int64*", "float64*", "int64", "int64*", "int64*", "int64*", "int64*", "int64", "int64*",
    "int64*", "int64", "int64*", "int64",
)  # fmt: skip
def leave_stage(
    state_at: Any, banks_before_at: Any, words_moved_at: Any, accesses_at: Any, core: int, entered_at: Any, counters_at: Any,
    at_sites_at: Any, costs_at: Any, conflict: int, spread_at: Any, before_at: Any, count: int, events_at: Any, accounts: int,
) -> int:  # fmt: skip
    """Leave a stage at a moment of a core's stretch, and charge it for conflicts in L1. Return the number of the next stage.

    The arrays, besides those of `calls.conflicts`: when the stage was entered, by the core's clock; the core's counters; the costs of
    conflicts at its sites; and the costs of the stage.
    """
    state, entered, events = words_at(state_at), words_at(entered_at), words_at(events_at)
    play, spread = w.PLAYS_AT + core * w.PLAY_WORDS, words_at(spread_at)
    banks = words_at(banks_before_at), words_at(words_moved_at), words_at(accesses_at)
    count_since(spread, count, words_at(counters_at), words_at(before_at), events)
    elapsed, costs = state[play + w.CLOCK] - entered[0], words_at(costs_at)
    cclk = charged(state, banks, spread, events, count, elapsed, conflict, words_at(at_sites_at))
    costs[CONFLICTS] += cclk
    state[play + w.CLOCK] += cclk
    entered[0] = state[play + w.CLOCK]
    move_costs(state, core, costs, accounts)
    moment = core * w.MAX_OPERATIONS + state[play + w.OPERATION] - 1
    stage: int = state[w.OPERATIONS_AT + moment * w.OPERATION_WORDS + 1]
    return stage
