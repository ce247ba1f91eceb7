"""What the kernels counted up to a mark, compiled: read from a frame's work and added to the core's counters."""

from __future__ import annotations

from typing import Any

from bfsim.kernel.native.entries import native_entry, words_at
from bfsim.machine.retiming.frame_words import (
    COUNTER,
    EVENT,
    EVENT_ROWS,
    NOT_THERE,
    ODD,
    PASSED,
    at_column,
)
from bfsim.machine.retiming.packed_work import EVENTS, number_at
from bfsim.machine.retiming.work_check import is_number


@native_entry("int64", "int64*", "int8*", "int16*", "int32*", "int64*", "int64*", "int64")
def pass_mark(
    frame_at: Any,
    octets_at: Any,
    halves_at: Any,
    words_in_at: Any,
    longs_at: Any,
    counters_at: Any,
    count: int,
) -> int:
    """Count the events up to the next mark. Return 0, or NOT_THERE for a counter beyond `count`.

    The arrays are those of `write_stretch`.
    """
    frame, counters = words_at(frame_at), words_at(counters_at)
    views = words_at(octets_at), words_at(halves_at), words_at(words_in_at), words_at(longs_at)
    (calls, call_width), (steps, step_width) = at_column(frame, EVENTS), at_column(frame, EVENTS + 1)
    amounts, amount_width = at_column(frame, EVENTS + 2)
    event, counter = frame[EVENT], frame[COUNTER]
    while event < frame[EVENT_ROWS] and number_at(views, calls, call_width, event) == frame[PASSED]:
        counter += number_at(views, steps, step_width, event)
        amount = number_at(views, amounts, amount_width, event)
        if not 0 <= counter < count:
            return NOT_THERE
        if not is_number(amount):
            return ODD
        counters[counter] += amount
        event += 1
    frame[EVENT], frame[COUNTER] = event, counter
    frame[PASSED] += 1
    return 0
