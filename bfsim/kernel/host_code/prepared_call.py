"""A call of a kernel's compiled code on arrays of the host."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.calls.python_calls import Check, left_by, log_of, words_of
from bfsim.kernel.calls.work import Work
from bfsim.kernel.host_code.jit import CompiledKernel
from bfsim.kernel.language.function import Function
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
        """`arrays`: in the order of the array parameters. `totals`: one word per counter.

        `first_site`: the number of the first site in the access trace.
        """

        def refuse(_failure: int) -> NoReturn:
            raise compiled.failure()

        words = words_of_entry(function, arrays, totals, access_trace, first_site)
        called = Called(
            compiled.entry, 0, (arrays, totals, access_trace)
        )  # kept alive, since the words have only their addresses
        left = left_by(function, access_trace, check, refuse)
        self.stays_in_l1 = access_trace is None
        """Whether all its accesses stay in L1."""
        self.run: Callable[..., Work] = bound_call(
            called,
            words,
            len(function.parameters),
            left,
            log_of(access_trace) if access_trace else None,
        )
        """Runs the kernel now and returns its cost, which is valid until the next run. It reads only the numbers."""


def words_of_entry(
    function: Function,
    arrays: Sequence[NDArray[Any]],
    totals: NDArray[np.int64],
    access_trace: AccessTrace | None = None,
    first_site: int = 0,
) -> list[int | Taken]:
    """Return the arguments of the entry point (`entry`), a word each."""
    words = [totals.ctypes.data, *words_of(function, ((each.ctypes.data, len(each)) for each in arrays))]
    return [*words, access_trace.address(), first_site] if access_trace else words
