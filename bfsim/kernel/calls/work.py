"""`Work`: what one kernel call cost and touched. The one type where `kernel/` and `machine/` meet."""

from __future__ import annotations

import ctypes
import struct
from typing import NoReturn

import numpy as np

from bfsim.errors import FirmwareError
from bfsim.machine_code import left

FLOAT = struct.Struct("<f")
ISSUE_CCLK, STALL_CCLK, ACCESSES = left.ISSUE_CCLK, left.STALL_CCLK, left.ACCESSES
"""Places of the numbers in a `Work`."""


def is_single(value: object) -> bool:
    """Whether a value is a number that an IEEE single can hold, rounded; infinities and NaN count."""
    if isinstance(value, bool) or not isinstance(value, (float, int, np.floating)):
        return False
    try:
        FLOAT.pack(value)
    except OverflowError:
        return False
    return True


class Work:
    """One kernel call, done natively: pixels are written already, time has not passed yet.

    `value` is what the kernel returned. The other numbers lie where machine code finds them.
    """

    __slots__ = ("_numbers", "at", "value")

    def __init__(
        self, issue_cclk: int, stall_cclk: int, value: float | None = None, accesses: int = 0
    ) -> None:
        self._numbers = (ctypes.c_int64 * 4)(issue_cclk, stall_cclk, accesses)
        self.at = ctypes.addressof(self._numbers)
        """The address of these numbers."""
        self.value = value

    @property
    def issue_cclk(self) -> int:
        """Cycles in which operations are issued."""
        return self._numbers[ISSUE_CCLK]

    @property
    def stall_cclk(self) -> int:
        """Interlocks: cycles in which one operation waits for another."""
        return self._numbers[STALL_CCLK]

    @property
    def accesses(self) -> int:
        """How many accesses outside L1 the access trace logged."""
        return self._numbers[ACCESSES]


UNYIELDED = "core.run(...) gives its value when it is yielded: write `yield core.run(...)`, in parentheses within an expression"


def _refuse(*_operands: object) -> NoReturn:
    raise FirmwareError(UNYIELDED)


def _refuse_to_iterate(_work: Work) -> NoReturn:
    raise FirmwareError(
        "core.run(...) is one call and no wait: write `yield core.run(...)`, not `yield from core.run(...)`"
    )


for _operation in (
    "bool", "int", "index", "float", "neg", "invert", "abs", "len", "getitem", "eq", "ne", "lt", "le", "gt", "ge",
    *(side + each for each in ("add", "sub", "mul", "floordiv", "truediv", "mod", "and", "or", "xor", "lshift", "rshift")
      for side in ("", "r")),
):  # fmt: skip
    setattr(Work, f"__{_operation}__", _refuse)
Work.__iter__ = _refuse_to_iterate  # type: ignore[attr-defined]
