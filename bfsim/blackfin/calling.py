"""Calls of subroutines by one native function (`caller`), bound to all that it needs.

For Python it is a built-in function, `f(arguments)`, with the C interface of CPython: to go through ctypes takes longer than many a
subroutine.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from struct import pack
from sys import intern
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bfsim import machine_code
from bfsim.blackfin import caller as w
from bfsim.blackfin.guard import runner
from bfsim.blackfin.left import WORD_BITS, Left
from bfsim.blackfin.subroutines import REGISTERS, STACK, STACK_BYTES, WORD_BYTES, Placed, Subroutine

VALUE = intern("value")


class Argument(NamedTuple):
    """What a subroutine takes in 32 bits."""

    kind: w.Kind
    least: int
    largest: int


@dataclass(frozen=True, slots=True)
class Counts:
    """Where the counts of a call are added: to each of `totals` the count of the translated code whose number is in `order`."""

    totals: NDArray[np.int64]
    order: NDArray[np.int64]


class Log(NamedTuple):
    """Where accesses are logged: the block that they are reported through, and addresses, all in what is `kept`.

    `logged`: of how many there are, `before` of how many of them are of earlier calls, `room` of how many there can be.
    """

    trace: int
    logged: int
    before: int
    room: int
    kept: object


class _Block(bytes):
    """Words, and what they have the addresses of."""

    kept: object


def bound_call(
    subroutine: Subroutine,
    arguments: Sequence[Argument],
    given: int,
    parts: Sequence[Placed],
    counts: Counts,
    left: Left,
    log: Log | None = None,
    kept: object = None,
) -> Callable[[Sequence[Any]], Any]:
    """Return a subroutine bound to its memory, to be called with its arguments.

    `given`: how many of the arguments come from Python, all of them first, even if some are fixed. `log`: where accesses are logged, if
    they are. `kept`: what else must live as long as it does, such as the memory of its arrays.
    """
    translated, state = subroutine.translated, subroutine.processor.state
    absent = len(REGISTERS) - len(arguments)
    words = [*arguments, *(absent * [Argument(w.Kind.FIXED, 0, 0)])]
    head = {
        w.RUN: runner().guarded,
        w.CODE: translated.entry,
        w.MEMORY: subroutine.processor.space.origin,
        w.STATE: state.slots.ctypes.data,
        w.COUNTS: translated.counts.ctypes.data,
        w.COUNTED: len(translated.counts),
        w.TOTALS: counts.totals.ctypes.data,
        w.ORDER: counts.order.ctypes.data,
        w.TOTALLED: len(counts.order),
        w.ADDRESS: subroutine.address,
        w.TOP: STACK + STACK_BYTES - WORD_BYTES * len(words),
        w.GIVEN: given,
        w.WORDS: len(words),
        w.PARTS: len(parts),
        w.TRACE: log.trace if log else 0,
        w.LOGGED: log.logged if log else 0,
        w.BEFORE: log.before if log else 0,
        w.ROOM: log.room if log else 0,
        w.LEFT: id(left.work),
        w.COST: left.cost,
        w.NAME: id(VALUE),
        w.RESULT: left.result,
        w.SHIFT: WORD_BITS - left.bits,
        w.REFUSE: id(left.refuse),
    }
    values = [
        *(head[each] for each in range(w.HEAD)),
        *(word for column in zip(*words, strict=True) for word in column),
    ]
    for each in parts:
        values += each.address, each.copy, each.nbytes, each.nbytes * each.is_written
    block = _Block(pack(f"{len(values)}q", *values))
    block.kept = subroutine, counts, left, log, kept
    return machine_code.python_function(w.caller(), block, machine_code.METH_O)
