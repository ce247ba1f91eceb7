"""SDRAM and its controller: what an access of one word meets, and when its data are there.

One command at a time, in order: a precharge or activation keeps the next access waiting, whatever bank that is for.
Reads follow each other a cycle apart, since their data come later ([assumed] also for reads of different masters).
A refresh begins when it is due, or when the data before it are through; it closes every bank.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.spec import BoardSpec
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.state import State


def new_sdram(board: BoardSpec) -> NDArray[np.int64]:
    """Return the state of a board's SDRAM with every bank closed."""
    sdram, sclk_ticks = board.sdram, board.clocks.sclk_ticks
    state = np.zeros(w.SDRAM_WORDS, np.int64)
    cycles = {
        w.SCLK: 1, w.CL: sdram.nCL, w.RCD: sdram.nRCD, w.RP: sdram.nRP, w.RAS: sdram.nRAS, w.WR: sdram.nWR,
        w.TURN: sdram.turn_round_sclk, w.REFRESH: sdram.refresh_sclk,
        w.REFRESH_INTERVAL: sdram.refresh_interval_sclk(board.clocks.sclk_hz),
    }  # fmt: skip
    for word, sclk in cycles.items():
        state[word] = sclk * sclk_ticks
    for word, size in (
        (w.PAGE_BITS, sdram.page_bytes),
        (w.BANK_BITS, sdram.bank_bytes),
        (w.WORD_BITS, sdram.word_bytes),
    ):
        state[word] = size.bit_length() - 1
    state[w.NEXT_REFRESH] = state[w.REFRESH_INTERVAL]
    state[w.LAST_WRITE] = True  # there is no read behind which the bus must turn round
    state[w.OPEN_PAGE : w.OPEN_PAGE + w.MAX_BANKS] = -1
    return state


@native
def refresh(state: State, now: int) -> int:
    """Do the refreshes that are due by `now`; return when a command can be given. Only the last one can still last."""
    missed = (now - state[w.NEXT_REFRESH]) // state[w.REFRESH_INTERVAL]
    due = state[w.NEXT_REFRESH] + missed * state[w.REFRESH_INTERVAL]
    begin = max(due, state[w.COMMAND_FREE], state[w.DATA_FREE])
    for bank in range(w.MAX_BANKS):
        if state[w.OPEN_PAGE + bank] >= 0:
            begin = max(
                begin, state[w.ACTIVATED + bank] + state[w.RAS], state[w.WRITTEN + bank] + state[w.WR]
            )
    state[w.REFRESHES] += missed + 1
    state[w.NEXT_REFRESH] = due + state[w.REFRESH_INTERVAL]
    for bank in range(w.MAX_BANKS):
        state[w.OPEN_PAGE + bank] = -1
    return max(now, begin + state[w.REFRESH])


@native
def hold_up(state: State, now: int) -> bool:
    """Refresh if that is due by `now`, when somebody asks for the bus; return whether that keeps the bus longer than `now`."""
    if now < state[w.NEXT_REFRESH]:
        return False
    state[w.REFRESH_BEGAN] = now
    state[w.REFRESH_ENDS] = state[w.COMMAND_FREE] = refresh(state, now)
    return bool(state[w.REFRESH_ENDS] > now)


@native
def access(state: State, now: int, offset: int, write: bool) -> int:
    """Read or write the word at `offset`, not before `now` (on an SCLK edge); return when its data are through."""
    hold_up(state, max(now, state[w.COMMAND_FREE]))
    return access_at(state, max(now, state[w.COMMAND_FREE]), offset, write)


@native
def access_at(state: State, command: int, offset: int, write: bool) -> int:
    """Do that from the tick of a `command` on: no refresh is due, and the bus is free."""
    state[w.REFRESH_WAIT] = (
        state[w.REFRESH_ENDS] - state[w.REFRESH_BEGAN] if command == state[w.REFRESH_ENDS] else 0
    )
    state[w.BEGAN] = command - state[w.REFRESH_WAIT]
    bank, page = offset >> state[w.BANK_BITS], offset >> state[w.PAGE_BITS]
    before = state[w.OPEN_PAGE + bank]
    state[w.PAGE_CLASS] = 0
    if before != page:
        state[w.PAGE_CLASS] = 1
        if before >= 0:
            state[w.PAGE_CLASS] = 2
            precharge = max(
                command, state[w.ACTIVATED + bank] + state[w.RAS], state[w.WRITTEN + bank] + state[w.WR]
            )
            command = precharge + state[w.RP]
        state[w.ACTIVATED + bank] = command
        state[w.OPEN_PAGE + bank] = page
        command += state[w.RCD]
    if write:
        command = max(command, state[w.DATA_FREE] + (0 if state[w.LAST_WRITE] else state[w.TURN]))
        through = command + state[w.SCLK]
        state[w.WRITTEN + bank] = through
    else:
        command = max(command, state[w.DATA_FREE] - state[w.CL])
        through = command + state[w.CL] + state[w.SCLK]
    state[w.LAST_WRITE] = write
    state[w.COMMAND_FREE] = command + state[w.SCLK]
    state[w.DATA_FREE] = through
    return through


@native
def hits_ahead(state: State, offset: int, step: int, most: int) -> int:
    """How many of `most` accesses from `offset`, `step` bytes apart, lie on its page and are sure to hit: 0 if it is not open."""
    page = offset >> state[w.PAGE_BITS]
    if state[w.OPEN_PAGE + (offset >> state[w.BANK_BITS])] != page or step <= 0:
        return 0
    on_page = ((page + 1) << state[w.PAGE_BITS]) - offset
    if (most - 1) * step < on_page:
        return most  # most often; a division takes the host longer
    return (on_page + step - 1) // step


@native
def stream(state: State, count: int, write: bool, offset: int) -> int:
    """Do `count` more accesses that hit, a cycle apart, behind one of the same direction; return when they are through.

    The caller has made sure that no refresh is due.
    """
    return stream_until(state, state[w.COMMAND_FREE] + count * state[w.SCLK], write, offset)


@native
def stream_until(state: State, free: int, write: bool, offset: int) -> int:
    """Do as many as come before the bus is `free` again."""
    state[w.COMMAND_FREE] = free
    if write:
        state[w.DATA_FREE] = state[w.WRITTEN + (offset >> state[w.BANK_BITS])] = free
        return free
    state[w.DATA_FREE] = free + state[w.CL]
    return free + state[w.CL]
