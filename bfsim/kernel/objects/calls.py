"""A call of a kernel's object code on arrays of the host."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.calling import BoundCall, Counts
from bfsim.blackfin.subroutines import STACK, STACK_BYTES, placed
from bfsim.blackfin.tracing import Followed, block_of
from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.kernel.types import ArrayType, FloatType, Number
from bfsim.kernel.work import BITS, FLOAT, Work


class ObjectCall:
    """A kernel's object code bound to its arrays, which are copied to the Blackfin's memory for each call, and back."""

    def __init__(
        self,
        code: CompiledObject,
        arrays: Sequence[NDArray[Any]],
        check: Callable[[Sequence[object]], None],
        totals: NDArray[np.int64],
        access_trace: AccessTrace | None = None,
        first_site: int = 0,
        stack: NDArray[np.uint8] | None = None,
    ) -> None:
        """`arrays`: in the order of the array parameters. `check` raises the error when the arguments of a call are wrong.

        `access_trace` is told of accesses to arrays, by traced code; it calls the code's first site `first_site`. `stack`: where the
        stack is, if its accesses are told, too.
        """
        function = code.function
        self._check, self._result, self._access_trace = check, function.result, access_trace
        self._kept = arrays  # their places have their addresses only
        parts, addresses = placed(arrays, code.subroutine.processor.space)
        named = list(zip(function.array_names, arrays, strict=True))
        lengths = [len(array) for name, array in named if name in function.measured]
        count = len(function.parameters)
        counts = Counts(totals[: len(code.order)], code.order)
        trace = None
        if access_trace:
            followed = [
                Followed(address, array.nbytes, array.ctypes.data, first_site + number)
                for number, (address, array) in enumerate(zip(addresses, arrays, strict=True))
            ]
            if stack is not None:
                followed.append(_followed_stack(stack, first_site + len(arrays)))
            trace = block_of(access_trace.address(), followed)
        self._call = BoundCall(code.subroutine, count + len(lengths), parts, counts, trace)
        self._words = self._call.arguments
        self._words[count : count + len(lengths)] = lengths
        places = iter(addresses)
        self._numbers = []
        for position, each in enumerate(function.parameters):
            if isinstance(each.type, ArrayType):
                self._words[position] = next(places)
            else:
                self._numbers.append((position, isinstance(each.type, FloatType)))

    @property
    def stays_in_l1(self) -> bool:
        """Whether no access of it can leave L1."""
        return self._access_trace is None

    def run(self, arguments: Sequence[Any]) -> Work:
        """Run the code now and say what it cost. Of `arguments`, only the numbers are read."""
        self._check(arguments)
        for position, is_float in self._numbers:
            value = arguments[position]
            self._words[position] = BITS.unpack(FLOAT.pack(value))[0] if is_float else int(value)
        issue_cclk, stall_cclk = self._call.run()
        value = None if self._result is None else _value(self._call.result, self._result)
        return Work(
            issue_cclk, stall_cclk, value, self._access_trace.take_count() if self._access_trace else 0
        )


def _followed_stack(stack: NDArray[np.uint8], site: int) -> Followed:
    """The stack from its top, where both begin, as far down as both reach."""
    nbytes = min(STACK_BYTES, len(stack))
    return Followed(STACK + STACK_BYTES - nbytes, nbytes, stack[len(stack) - nbytes :].ctypes.data, site)


def _value(word: int, kind: Number) -> float:
    """What a function returns in R0, of which a narrow type has the lower bits."""
    if isinstance(kind, FloatType):
        value: float = FLOAT.unpack(BITS.pack(word))[0]
        return value
    return kind(word)
