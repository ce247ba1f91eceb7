"""A call of a kernel's compiled code on arrays of the host."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.access_trace import AccessTrace
from bfsim.kernel.entry import FIRST_ARGUMENT
from bfsim.kernel.function import Function
from bfsim.kernel.jit import CompiledKernel
from bfsim.kernel.python_calls import Check, left_by, log_of, words_of
from bfsim.kernel.work import Work
from bfsim.machine_code.calling import Called, Taken, bound_call


class PreparedCall:
    """A kernel bound to its arrays: only the numbers change from call to call."""

    def __init__(
        self,
        function: Function,
        compiled: CompiledKernel,
        arrays: Sequence[NDArray[Any]],
        check: Check,
        totals: NDArray[np.int64],
        access_trace: AccessTrace | None = None,
        first_site: int = 0,
    ) -> None:
        """`arrays`: in the order of the array parameters. `totals`: one word per counter. `first_site`: what the access trace calls the first site."""

        def refuse(_failure: int) -> NoReturn:
            raise compiled.failure()

        words = arguments_of(function, arrays, totals, access_trace, first_site)
        taken = [each for each in words if isinstance(each, Taken)]
        self.block = (ctypes.c_int64 * len(words))(
            *(0 if isinstance(each, Taken) else each for each in words)
        )
        """The arguments of the entry point (`entry`); the numbers are those of the last call."""
        kept = self.block, arrays, totals, access_trace  # there are only addresses of the others
        called = Called(compiled.entry, 0, ctypes.addressof(self.block), kept)
        left = left_by(function, access_trace, check, refuse)
        self.stays_in_l1 = access_trace is None
        """Whether no access of it can leave L1."""
        self.run: Callable[[Sequence[Any]], Work] = bound_call(
            called, len(function.parameters), taken, left, log_of(access_trace)
        )
        """Runs the kernel now and says what it cost, until the next run. Of its arguments, only the numbers are read."""


def arguments_of(
    function: Function,
    arrays: Sequence[NDArray[Any]],
    totals: NDArray[np.int64],
    access_trace: AccessTrace | None,
    first_site: int,
) -> list[int | Taken]:
    """Return the arguments of the entry point, a word each."""
    rows = iter(arrays)

    def row() -> tuple[int, int]:
        array = next(rows)
        return array.ctypes.data, len(array)

    words = [totals.ctypes.data, *words_of(function, FIRST_ARGUMENT, row)]
    return [*words, access_trace.address(), first_site] if access_trace else words
