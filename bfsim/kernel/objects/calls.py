"""A call of a kernel's object code on arrays of the host."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.calling import ISSUE_MASK, STALL_SHIFT, Argument, BoundCall, Counts, Kind
from bfsim.blackfin.guard import catch_always
from bfsim.blackfin.subroutines import STACK, STACK_BYTES, Placed, placed
from bfsim.blackfin.tracing import Followed, block_of
from bfsim.kernel import crashes
from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.function import Function
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.kernel.types import ArrayType, FloatType, u32
from bfsim.kernel.work import Work

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
        trace = None
        if access_trace:
            followed = [
                Followed(address, array.nbytes, array.ctypes.data, first_site + number)
                for number, (address, array) in enumerate(zip(addresses, arrays, strict=True))
                if access_trace.logs(array.ctypes.data)
            ]
            if stack is not None:
                followed.append(_followed_stack(stack, first_site + len(arrays)))
            trace = block_of(access_trace.address(), followed)
        _catch_faults()
        counts = Counts(totals[: len(code.order)], code.order)
        given, taken = len(function.parameters), _arguments(function, arrays, addresses)
        self._call = BoundCall(code.subroutine, taken, given, parts, counts, trace)
        self._entry = self._call.entry
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
        outcome = self._entry(*arguments)
        if outcome < 0:
            self._check(arguments)
            self._call.refuse(outcome)
        work = self._work  # one for all runs: to make it takes Python longer than to run a short kernel
        work.issue_cclk = outcome & ISSUE_MASK
        work.stall_cclk = outcome >> STALL_SHIFT
        work.accesses = self._access_trace.take_count() if self._access_trace else 0
        if self._result is not None:
            work.value = self._result.value
        return work


def _arguments(
    function: Function, arrays: Sequence[NDArray[Any]], addresses: Sequence[int]
) -> list[Argument]:
    """Return what the code takes: of an array its address, and behind the parameters the lengths that it asks for."""
    places = iter(addresses)
    found = []
    for each in function.parameters:
        if isinstance(each.type, ArrayType):
            found.append(_fixed(next(places)))
        elif isinstance(each.type, FloatType):
            found.append(Argument(Kind.FLOAT, *u32.bounds))
        else:
            found.append(Argument(Kind.INTEGER, *each.type.bounds))
    named = zip(function.array_names, arrays, strict=True)
    return found + [_fixed(len(array)) for name, array in named if name in function.measured]


def _fixed(value: int) -> Argument:
    return Argument(Kind.FIXED, value, value)


@cache
def _catch_faults() -> None:
    """Take the signal of a fault in object code, behind whoever tells of crashes: it does not hand a fault on as it was."""
    crashes.take_signals()
    catch_always()


def _followed_stack(stack: NDArray[np.uint8], site: int) -> Followed:
    """The stack from its top, where both begin, as far down as both reach."""
    nbytes = min(STACK_BYTES, len(stack))
    return Followed(STACK + STACK_BYTES - nbytes, nbytes, stack[len(stack) - nbytes :].ctypes.data, site)
