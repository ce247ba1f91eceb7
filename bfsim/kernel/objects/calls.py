"""A call of a kernel's object code on arrays of the host."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.calling import ISSUE_MASK, STALL_SHIFT, BoundCall, Counts
from bfsim.blackfin.guard import catch_always
from bfsim.blackfin.subroutines import STACK, STACK_BYTES, Placed, placed
from bfsim.blackfin.tracing import Followed, block_of
from bfsim.kernel import crashes
from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.function import Function
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.kernel.types import ArrayType, FloatType, IntType, u32
from bfsim.kernel.work import BITS, FLOAT, Work

IN_MEMORY = {
    "i8": ctypes.c_int8, "u8": ctypes.c_uint8, "i16": ctypes.c_int16, "u16": ctypes.c_uint16,
    "i32": ctypes.c_int32, "u32": ctypes.c_uint32, "f32": ctypes.c_float,
}  # fmt: skip
"""Numbers by their types: of what R0 holds, a narrow type has the lower bits."""


class ObjectCall:
    """A kernel's object code bound to its arrays.

    The Blackfin's memory has a window on that of a board; other arrays are copied there for each call, and back.
    """

    def __init__(
        self,
        code: CompiledObject,
        arrays: Sequence[NDArray[Any]],
        check: Callable[[Sequence[object]], None],
        totals: NDArray[np.int64],
        access_trace: AccessTrace | None = None,
        first_site: int = 0,
        stack: NDArray[np.uint8] | None = None,
        memory: NDArray[np.uint8] | None = None,
    ) -> None:
        """`arrays`: in the order of the array parameters. `check` raises the error when the arguments of a call are wrong.

        `access_trace` is told of accesses to arrays, by traced code; it calls the code's first site `first_site`. `stack`: where the
        stack is, if its accesses are told, too. `memory`: that of the board, if all arrays lie in it.
        """
        function = code.function
        self._check, self._access_trace = check, access_trace
        self._kept = arrays, memory  # their places have their addresses only
        space = code.subroutine.processor.space
        parts: Sequence[Placed] = ()
        if memory is None:
            named = zip(function.array_names, arrays, strict=True)
            written = [array.flags.writeable and code.may_write(name) for name, array in named]
            parts, addresses = placed(arrays, written, space)
        else:
            from_host = space.window(memory) - memory.ctypes.data
            addresses = [each.ctypes.data + from_host for each in arrays]
        kinds = [each.type for each in function.parameters]
        self._count = len(kinds)
        self._integers = [position for position, each in enumerate(kinds) if isinstance(each, IntType)]
        self._floats = [position for position, each in enumerate(kinds) if isinstance(each, FloatType)]
        trace = None
        if access_trace:
            followed = [
                Followed(address, array.nbytes, array.ctypes.data, first_site + number)
                for number, (address, array) in enumerate(zip(addresses, arrays, strict=True))
            ]
            if stack is not None:
                followed.append(_followed_stack(stack, first_site + len(arrays)))
            trace = block_of(access_trace.address(), followed)
        _catch_faults()
        counts = Counts(totals[: len(code.order)], code.order)
        self._call = BoundCall(code.subroutine, _bounds(function, arrays, addresses), parts, counts, trace)
        self._entry, self._cell, self._at = self._call.entry, self._call.cell, self._call.at
        self._words = self._call.arguments
        self._result: Any = (
            IN_MEMORY[str(function.result)].from_address(self._call.result) if function.result else None
        )
        self._work = Work(0, 0)

    @property
    def stays_in_l1(self) -> bool:
        """Whether no access of it can leave L1."""
        return self._access_trace is None

    def run(self, arguments: Sequence[Any]) -> Work:
        """Run the code now and say what it cost, until the next run. Of `arguments`, only the numbers are read."""
        words = self._words
        try:
            for position in self._integers:
                words[position] = arguments[position]
        except (TypeError, IndexError):
            self._put_as_integers(arguments)
        if self._floats:
            self._put_floats(arguments)
        self._cell.value = self._at
        outcome = self._entry()
        if outcome < 0 or len(arguments) != self._count:
            self._check(arguments)
            self._call.refuse(outcome)
        work = self._work  # one for all runs: to make it takes Python longer than to run a short kernel
        work.issue_cclk = outcome & ISSUE_MASK
        work.stall_cclk = outcome >> STALL_SHIFT
        work.accesses = self._access_trace.take_count() if self._access_trace else 0
        if self._result is not None:
            work.value = self._result.value
        return work

    def _put_as_integers(self, arguments: Sequence[Any]) -> None:
        """Put numbers that are none of Python's ints where the code finds them; what is no integer is refused."""
        self._check(arguments)
        for position in self._integers:
            self._words[position] = int(arguments[position])

    def _put_floats(self, arguments: Sequence[Any]) -> None:
        """Put the bits of the floats there; what is no number is refused."""
        try:
            for position in self._floats:
                self._words[position] = BITS.unpack(FLOAT.pack(arguments[position]))[0]
        except (struct.error, OverflowError, IndexError):
            self._check(arguments)


def _bounds(
    function: Function, arrays: Sequence[NDArray[Any]], addresses: Sequence[int]
) -> list[tuple[int, int]]:
    """Return the least and the largest value of each argument: those of an array, its address and its length, have one."""
    places = iter(addresses)
    found = []
    for each in function.parameters:
        if isinstance(each.type, ArrayType):
            place = next(places)
            found.append((place, place))
        else:
            found.append(u32.bounds if isinstance(each.type, FloatType) else each.type.bounds)
    named = zip(function.array_names, arrays, strict=True)
    return found + [(len(array), len(array)) for name, array in named if name in function.measured]


@cache
def _catch_faults() -> None:
    """Take the signal of a fault in object code, behind whoever tells of crashes: it does not hand a fault on as it was."""
    crashes.take_signals()
    catch_always()


def _followed_stack(stack: NDArray[np.uint8], site: int) -> Followed:
    """The stack from its top, where both begin, as far down as both reach."""
    nbytes = min(STACK_BYTES, len(stack))
    return Followed(STACK + STACK_BYTES - nbytes, nbytes, stack[len(stack) - nbytes :].ctypes.data, site)
