"""A call of a kernel's object code on arrays of the host."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.calling import BoundCall, Counts
from bfsim.blackfin.subroutines import placed
from bfsim.kernel import tree
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.kernel.types import ArrayType, FloatType, Number
from bfsim.kernel.work import BITS, FLOAT, Work


class ObjectCall:
    """A kernel's object code bound to its arrays, which are copied to the Blackfin's memory for each call, and back."""

    stays_in_l1 = True

    def __init__(
        self,
        code: CompiledObject,
        arrays: Sequence[NDArray[Any]],
        check: Callable[[Sequence[object]], None],
        totals: NDArray[np.int64],
    ) -> None:
        """`arrays`: in the order of the array parameters. `check` raises the error when the arguments of a call are wrong."""
        function = code.function
        self._check, self._result = check, function.result
        self._kept = arrays  # their places have their addresses only
        parts, addresses = placed(arrays, code.subroutine.processor.space)
        measured = tree.measured_arrays(function)
        named = list(zip(function.array_names, arrays, strict=True))
        lengths = [len(array) for name, array in named if name in measured]
        count = len(function.parameters)
        self._call = BoundCall(
            code.subroutine, count + len(lengths), parts, Counts(totals[: len(code.order)], code.order)
        )
        self._words = self._call.arguments
        self._words[count : count + len(lengths)] = lengths
        places = iter(addresses)
        self._numbers = []
        for position, each in enumerate(function.parameters):
            if isinstance(each.type, ArrayType):
                self._words[position] = next(places)
            else:
                self._numbers.append((position, isinstance(each.type, FloatType)))

    def run(self, arguments: Sequence[Any]) -> Work:
        """Run the code now and say what it cost. Of `arguments`, only the numbers are read."""
        self._check(arguments)
        for position, is_float in self._numbers:
            value = arguments[position]
            self._words[position] = BITS.unpack(FLOAT.pack(value))[0] if is_float else int(value)
        cclk = self._call.run()
        return Work(cclk, 0, None if self._result is None else _value(self._call.result, self._result))


def _value(word: int, kind: Number) -> float:
    """What a function returns in R0, of which a narrow type has the lower bits."""
    if isinstance(kind, FloatType):
        value: float = FLOAT.unpack(BITS.pack(word))[0]
        return value
    return kind(word)
