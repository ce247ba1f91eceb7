"""A call of a kernel's object code on arrays of the host."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.subroutines import placed
from bfsim.kernel import tree
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.kernel.types import FloatType, Number
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
        self._code, self._check, self._totals = code, check, totals
        self._kept = arrays  # their places have their addresses only
        self._places, addresses = placed(arrays, code.subroutine.processor.space)
        function = code.function
        self._addresses = dict(zip(function.array_names, addresses, strict=True))
        lengths = {name: len(array) for name, array in zip(function.array_names, arrays, strict=True)}
        measured = tree.measured_arrays(function)
        self._lengths = [lengths[each] for each in function.array_names if each in measured]

    def run(self, arguments: Sequence[Any]) -> Work:
        """Run the code now and say what it cost. Of `arguments`, only the numbers are read."""
        self._check(arguments)
        words = [
            self._addresses[each.name] if each.name in self._addresses else _word(value, each.type)
            for each, value in zip(self._code.function.parameters, arguments, strict=True)
        ]
        for each in self._places:
            each.bring()
        returned = self._code.subroutine.call([*words, *self._lengths])
        for each in self._places:
            each.fetch()
        self._totals += self._code.subroutine.take_counts()[self._code.order]
        return Work(returned.cclk, 0, _value(returned.value, self._code.function.result))


def _word(value: Any, kind: object) -> int:
    if isinstance(kind, FloatType):
        bits: int = BITS.unpack(FLOAT.pack(value))[0]
        return bits
    return int(value)


def _value(word: int, kind: Number | None) -> float | None:
    """What a function returns in R0, of which a narrow type has the lower bits."""
    if kind is None:
        return None
    if isinstance(kind, FloatType):
        value: float = FLOAT.unpack(BITS.pack(word))[0]
        return value
    return kind(word)
