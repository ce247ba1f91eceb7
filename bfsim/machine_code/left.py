"""The results of a call of machine code: numbers, and a value."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from typing import NamedTuple, NoReturn

WORD_BITS = 64
ISSUE_CCLK, STALL_CCLK, ACCESSES, VALUE = range(4)
"""The numbers that a call leaves: cycles without waits, waits, the number of logged accesses, and its return value."""
UNFIT, NO_ROOM = -1, -2
"""Left instead of cycles: an argument does not fit, and nothing was run; there are more accesses than the log can hold."""
FAILED = -3
"""Left, minus the number of the event, if an event ended the code before it returned."""
INTERRUPTED = -1000
"""Returned by a call that a signal has ended (`endless`)."""


class Result(IntEnum):
    """The value of a call: none, its return value as an integer without the upper SHIFT of 64 bits, or as a float."""

    NONE = 0
    SIGNED = 1
    UNSIGNED = 2
    FLOAT = 3


class Left(NamedTuple):
    """What a call leaves: `work`, which it returns, numbers at the address `cost`, and in `work.value` a `result` of so many `bits`.

    `refuse` is called with the arguments if the call fails.
    """

    work: object
    cost: int
    result: Result
    bits: int
    refuse: Callable[..., NoReturn]
