"""`Work`: what one kernel call cost and touched. The one type in which `kernel/` and `machine/` meet."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin import left
from bfsim.errors import FirmwareError
from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.entry import FIRST_ARGUMENT, STALL_SHIFT
from bfsim.kernel.jit import CompiledKernel
from bfsim.kernel.types import FloatType, Number

FLOAT, BITS = struct.Struct("<f"), struct.Struct("<I")
ISSUE_MASK = (1 << STALL_SHIFT) - 1
ISSUE_CCLK, STALL_CCLK, ACCESSES = left.ISSUE_CCLK, left.STALL_CCLK, left.ACCESSES
"""Places of the numbers of a `Work`."""


def is_single(value: object) -> bool:
    """Whether a value is a number that an IEEE single can hold, rounded; infinities and NaN are."""
    if isinstance(value, bool) or not isinstance(value, (float, int, np.floating)):
        return False
    try:
        FLOAT.pack(value)
    except OverflowError:
        return False
    return True


class Work:
    """One kernel call, done natively: pixels are written already, time has not passed yet.

    `value` is what the kernel returned. Its numbers are where machine code finds them.
    """

    __slots__ = ("_numbers", "at", "value")

    def __init__(
        self, issue_cclk: int, stall_cclk: int, value: float | None = None, accesses: int = 0
    ) -> None:
        self._numbers = (ctypes.c_int64 * 3)(issue_cclk, stall_cclk, accesses)
        self.at = ctypes.addressof(self._numbers)
        """Their address."""
        self.value = value

    def be(self, issue_cclk: int, stall_cclk: int, accesses: int) -> None:
        """Have it be of another call."""
        self._numbers[:] = [issue_cclk, stall_cclk, accesses]

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
        """How many accesses outside L1 the access_trace logged."""
        return self._numbers[ACCESSES]

    @accesses.setter
    def accesses(self, count: int) -> None:
        self._numbers[ACCESSES] = count


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


class PreparedCall:
    """A kernel bound to its arrays: only the integers change from call to call.

    Binding once and calling often keeps the cost of a call from Python below a microsecond.
    """

    __slots__ = (
        "_access_trace",
        "_at",
        "_block",
        "_cell",
        "_check",
        "_count",
        "_entry",
        "_failure",
        "_floats",
        "_integers",
        "_is_float",
        "_kept",
        "_value_word",
        "_work",
    )  # fmt: skip

    def __init__(
        self,
        compiled: CompiledKernel,
        arrays: Sequence[tuple[int, NDArray[Any]]],
        integers: Sequence[tuple[int, int]],
        floats: Sequence[tuple[int, int]],
        check: Callable[[Sequence[object]], None],
        *,
        result: Number | None,
        access_trace: AccessTrace | None,
        first_site: int,
        totals: NDArray[np.int64],
    ) -> None:
        """`arrays`: (word, array); `integers`, `floats`: (word, position); `totals`: one word per counter.

        `check` raises the error when the arguments of a call are wrong.
        """
        scalars = len(integers) + len(floats)
        self._count = len(arrays) + scalars
        words = FIRST_ARGUMENT + 2 * len(arrays) + scalars
        self._value_word = words + (2 if access_trace else 0) if result else 0
        self._is_float = isinstance(result, FloatType)
        self._block = (ctypes.c_int64 * (words + 3))()
        self._block[0] = totals.ctypes.data
        for word, array in arrays:
            self._block[word], self._block[word + 1] = array.ctypes.data, len(array)
        self._kept = (arrays, totals)  # the block has their addresses only
        if access_trace:
            self._block[words], self._block[words + 1] = access_trace.address(), first_site
        self._at = ctypes.addressof(self._block)
        self._cell = compiled.cell
        self._entry = compiled.entry
        self._failure = compiled.failure
        self._integers = tuple(integers)
        self._floats = tuple(floats)
        self._check = check
        self._access_trace = access_trace
        self._work = Work(0, 0)

    @property
    def stays_in_l1(self) -> bool:
        """Whether no access of it can leave L1."""
        return self._access_trace is None

    def run(self, arguments: Sequence[Any]) -> Work:
        """Run the kernel now and say what it cost, until the next run. Of `arguments`, only the numbers are read."""
        block = self._block
        try:
            for word, position in self._integers:
                block[word] = arguments[position]
        except (TypeError, IndexError):
            self._put_as_integers(arguments)
        if self._floats:
            self._put_floats(arguments)
        self._cell.value = self._at
        cycles: int = self._entry()
        if cycles < 0 or len(arguments) != self._count:
            self._check(arguments)
            raise self._failure()
        work = self._work  # one for all runs: to make it takes Python longer than to run a short kernel
        accesses = self._access_trace.take_count() if self._access_trace else 0
        work.be(cycles & ISSUE_MASK, cycles >> STALL_SHIFT, accesses)
        if self._value_word:
            work.value = block[self._value_word]
            if self._is_float:
                work.value = FLOAT.unpack(BITS.pack(work.value))[0]
        return work

    def _put_floats(self, arguments: Sequence[Any]) -> None:
        """Put the bits of the floats where the kernel finds them; what is no number is refused."""
        try:
            for word, position in self._floats:
                self._block[word] = BITS.unpack(FLOAT.pack(arguments[position]))[0]
        except (struct.error, OverflowError, IndexError):
            self._check(arguments)

    def _put_as_integers(self, arguments: Sequence[Any]) -> None:
        """Put numbers that are none of Python's ints where the kernel finds them; what is no integer is refused."""
        self._check(arguments)
        for word, position in self._integers:
            self._block[word] = int(arguments[position])
