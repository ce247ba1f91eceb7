"""Machine code as a Python function, bound to everything that it needs (`caller`).

It has the C interface of CPython: going through ctypes takes longer than many a call.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from struct import iter_unpack, pack
from sys import intern
from typing import Any, NamedTuple

from bfsim import machine_code
from bfsim.machine_code import caller as w
from bfsim.machine_code.followed import call_both
from bfsim.machine_code.left import WORD_BITS, Left

VALUE = intern("value")


class Called(NamedTuple):
    """A function to call: its address. It gets the addresses of `data`, of the words handed to it, and of the numbers that it leaves.

    It returns a negative number if it fails. It needs what is `kept`.
    """

    function: int
    data: int
    kept: object


class Taken(NamedTuple):
    """A number that is taken from the argument at a position."""

    position: int
    kind: w.NumberKind
    least: int
    largest: int


class Log(NamedTuple):
    """A log of accesses: the addresses of their number, of the number from earlier calls, and of the most possible."""

    logged: int
    before: int
    room: int


class Block(bytes):
    """Words that contain addresses, and the objects at these."""

    kept: object


def words_at(call: Callable[..., Any]) -> int:
    """Return the address of the words of a function made by `bound_call`, 0 for anything else."""
    block = getattr(call, "__self__", None)
    return _as_string(block) if isinstance(block, Block) else 0


_as_string = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object)(("PyBytes_AsString", ctypes.pythonapi))


def bound_call(
    called: Called, words: Sequence[int | Taken], given: int, left: Left, log: Log | None
) -> Callable[..., Any]:
    """Return a function to be called with `given` arguments, of which it reads only the numbers to be taken.

    `words` of 64 bits are handed over, each a constant or taken from an argument of each call.
    """
    handed = (ctypes.c_int64 * len(words))(*(0 if isinstance(each, Taken) else each for each in words))
    taken = [
        (each.position, word, each.kind, each.least, each.largest)
        for word, each in enumerate(words)
        if isinstance(each, Taken)
    ]
    head = {
        w.CALLED: called.function,
        w.DATA: called.data,
        w.HANDED: ctypes.addressof(handed),
        w.GIVEN: given,
        w.TAKEN: len(taken),
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
        *(each for column in zip(*taken, strict=True) for each in column),
    ]
    return _bound(values, (called, handed, left))


def followed_call(
    call: Callable[..., Any], then: int, given: tuple[int, int, int], log: Log, kept: object
) -> Callable[..., Any]:
    """Return a function made by `bound_call`, followed by a call of the function at the address `then` with the three words `given`.

    The latter logs accesses, and needs what is `kept`.
    """
    block: Block = call.__self__  # type: ignore[attr-defined]
    values = [each for (each,) in iter_unpack("q", block)]
    both = (ctypes.c_int64 * 6)(values[w.CALLED], values[w.DATA], then, *given)
    values[w.CALLED], values[w.DATA] = call_both(), ctypes.addressof(both)
    values[w.LOGGED], values[w.BEFORE], values[w.ROOM] = log
    return _bound(values, (block, both, kept))


def _bound(values: Sequence[int], kept: object) -> Callable[..., Any]:
    """Return the function that Python calls, bound to words."""
    block = Block(pack(f"{len(values)}q", *values))
    block.kept = kept
    return machine_code.python_function(w.caller(), block)
