"""Machine code as a function of Python's, `f(arguments)`, bound to all that it needs (`caller`).

It has the C interface of CPython: to go through ctypes takes longer than many a call.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from struct import pack
from typing import Any, NamedTuple

from bfsim import machine_code
from bfsim.machine_code import caller as w
from bfsim.machine_code.left import VALUE_NAME, WORD_BITS, Left


class Called(NamedTuple):
    """What is called: the address of a function that gets those of `data`, of the numbers that are `handed` to it, and of what it leaves.

    It returns a negative number if it fails. All of these live as long as what is `kept`.
    """

    function: int
    data: int
    handed: int
    kept: object


class Taken(NamedTuple):
    """A number that is taken from the argument at a position, and put into a word of those that are handed over."""

    position: int
    word: int
    kind: w.Kind
    least: int
    largest: int


class Log(NamedTuple):
    """Where accesses are logged: the addresses of how many there are, of how many of them are of earlier calls, and of how many there can be."""

    logged: int
    before: int
    room: int


class _Block(bytes):
    """Words, and what they have the addresses of."""

    kept: object


def bound_call(
    called: Called, given: int, taken: Sequence[Taken], left: Left, log: Log | None
) -> Callable[[Sequence[Any]], Any]:
    """Return a function to be called with `given` arguments; of these only the numbers that are `taken` are read."""
    head = {
        w.CALLED: called.function,
        w.DATA: called.data,
        w.HANDED: called.handed,
        w.GIVEN: given,
        w.TAKEN: len(taken),
        w.LOGGED: log.logged if log else 0,
        w.BEFORE: log.before if log else 0,
        w.ROOM: log.room if log else 0,
        w.LEFT: id(left.work),
        w.COST: left.cost,
        w.NAME: id(VALUE_NAME),
        w.RESULT: left.result,
        w.SHIFT: WORD_BITS - left.bits,
        w.REFUSE: id(left.refuse),
    }
    values = [
        *(head[each] for each in range(w.HEAD)),
        *(word for column in zip(*taken, strict=True) for word in column),
    ]
    block = _Block(pack(f"{len(values)}q", *values))
    block.kept = called, left
    return machine_code.python_function(w.caller(), block, machine_code.METH_O)
