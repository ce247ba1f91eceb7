"""What a call of machine code leaves: numbers, and a value."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from typing import NamedTuple, NoReturn

WORD_BITS = 64
ISSUE_CCLK, STALL_CCLK, ACCESSES, VALUE = range(4)
"""What a call leaves in numbers: cycles without waits, waits, how many accesses were logged, and what it returned."""
UNFIT, NO_ROOM = -1, -2
"""Left in place of cycles: an argument does not fit, and nothing was run; there are more accesses than can be logged."""
FAILED = -3
"""Less the number of an event, left where that ended the code before it returned."""
INTERRUPTED = -1000
"""Returned by a call that a signal has ended (`endless`)."""


class Result(IntEnum):
    """What the value of a call is: none, or what it returned as a number whose upper SHIFT of 64 bits are left out, or as a float."""

    NONE = 0
    SIGNED = 1
    UNSIGNED = 2
    FLOAT = 3


class Left(NamedTuple):
    """What a call leaves: `work`, which is returned, with numbers at the address `cost` and its `value`, `bits` of what it returned as a `result`.

    `refuse` is called with the arguments where it fails.
    """

    work: object
    cost: int
    result: Result
    bits: int
    refuse: Callable[..., NoReturn]
