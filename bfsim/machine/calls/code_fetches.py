"""What a call with code outside L1 adds to the access trace, compiled: machine code calls it after the kernel (`machine_code.followed`).

Each function gets the state of the access trace, and two arrays of its own.
"""

from __future__ import annotations

from typing import Any

from bfsim.kernel.calls import access_log as log
from bfsim.kernel.native.entries import native, native_entry, words_at
from bfsim.machine.bus.state import FETCH_BYTES, State

SUBBANK_BYTES = 4096

LINE_BYTES, WAYS, SETS, TAGS = range(4)
"""Words of a code cache: its dimensions, and from TAGS on the lines of each set, the latest used first; NO_LINE if empty."""
NO_LINE = -1

COUNT, LINES_AT = range(2)
"""Words of a group's lines: their number, each line with its site, and room for the missed ones."""

COUNTERS, EXECUTED, SITE, NBYTES_AT = range(4)
"""Words of a group's single fetches: the number of counters, the bytes executed so far, the site of the first routine, and the bytes
of each counter's code."""


@native
def set_of(cache: State, line: int) -> int:
    """Return the set of a line: addr[9:5] in the sub-bank of 4 KB named by addr[13:12] (Programming Reference p.243)."""
    at = line * cache[LINE_BYTES]
    per_bank = SUBBANK_BYTES // (cache[LINE_BYTES] * cache[WAYS])
    return at // SUBBANK_BYTES * per_bank % cache[SETS] + line % per_bank


@native
def use_line(cache: State, line: int) -> bool:
    """Make a line the latest used of its set. Return whether it was in the cache."""
    first, way = TAGS + set_of(cache, line) * cache[WAYS], 0
    while way < cache[WAYS] - 1 and cache[first + way] != line:
        way += 1
    was_there = cache[first + way] == line
    while way > 0:
        cache[first + way] = cache[first + way - 1]
        way -= 1
    cache[first] = line
    return was_there


@native_entry("void", "int64*", "int64*", "int64*")
def fetch_lines(trace_at: Any, cache_at: Any, lines_at: Any) -> None:
    """Use the lines of a call. Log a fill for each missing line, after the accesses in the call's first cycle."""
    trace, cache, lines = words_at(trace_at), words_at(cache_at), words_at(lines_at)
    missed_at = LINES_AT + 2 * lines[COUNT]
    missed = 0
    for number in range(lines[COUNT]):
        if not use_line(cache, lines[LINES_AT + 2 * number]):
            lines[missed_at + missed] = LINES_AT + 2 * number
            missed += 1
    first, end = log.LOG + trace[log.KEPT], log.LOG + trace[log.ENTRIES]
    trace[log.ENTRIES] += missed
    if not missed or trace[log.ENTRIES] > trace[log.ROOM]:
        return
    while first < end and trace[first] >> log.STAMP_BIT == 0:
        first += 1
    for at in range(end - 1, first - 1, -1):
        trace[at + missed] = trace[at]
        trace[at + missed + trace[log.ROOM]] = trace[at + trace[log.ROOM]]
    for number in range(missed):
        line = lines[missed_at + number]
        trace[first + number] = log.FETCH_LINE << log.KIND_BIT | lines[line] * cache[LINE_BYTES]
        trace[first + number + trace[log.ROOM]] = lines[line + 1]


@native_entry("void", "int64*", "int64*", "int64*")
def fetch_singly(trace_at: Any, totals_at: Any, code_at: Any) -> None:
    """Log the number of fetches of the code executed since the last time, as one entry."""
    trace, totals, code = words_at(trace_at), words_at(totals_at), words_at(code_at)
    executed = 0
    for number in range(code[COUNTERS]):
        executed += totals[number] * code[NBYTES_AT + number]
    fetches = (executed - code[EXECUTED] + FETCH_BYTES - 1) // FETCH_BYTES
    code[EXECUTED] = executed
    if fetches:
        at = log.LOG + trace[log.ENTRIES]
        trace[log.ENTRIES] += 1
        if trace[log.ENTRIES] <= trace[log.ROOM]:
            trace[at] = fetches << log.STAMP_BIT | log.FETCHES << log.KIND_BIT
            trace[at + trace[log.ROOM]] = code[SITE]
