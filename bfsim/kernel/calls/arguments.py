"""The arguments of a kernel's call: they must have the types of its parameters, and arrays must be ones it can work on."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import KernelError
from bfsim.kernel.calls.work import is_single
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import ArrayType, FloatType, IntType


class Arguments:
    """The arguments that the parameters of a kernel take."""

    def __init__(self, function: Function) -> None:
        self._function = function

    @cached_property
    def array_positions(self) -> tuple[int, ...]:
        """Which parameters are arrays."""
        return tuple(
            i for i, each in enumerate(self._function.parameters) if isinstance(each.type, ArrayType)
        )

    @cached_property
    def float_positions(self) -> tuple[int, ...]:
        """Which parameters are single floats."""
        return tuple(
            i for i, each in enumerate(self._function.parameters) if isinstance(each.type, FloatType)
        )

    @cached_property
    def _ranges(self) -> tuple[tuple[int, int, int], ...]:
        """(position, smallest, largest) of each integer parameter."""
        kinds = [each.type for each in self._function.parameters]
        return tuple((i, *kind.bounds) for i, kind in enumerate(kinds) if isinstance(kind, IntType))

    def check(self, arguments: Sequence[object]) -> None:
        """Raise KernelError unless there is one argument per parameter and every integer fits its type."""
        if len(arguments) != len(self._function.parameters):
            names = ", ".join(each.name for each in self._function.parameters)
            counted = "1 argument" if len(arguments) == 1 else f"{len(arguments)} arguments"
            raise KernelError(
                f"{self._function.name} must get {names}, not {counted} ({self._function.place})"
            )
        for position, low, high in self._ranges:
            value = arguments[position]
            if not isinstance(value, (int, np.integer)) or not low <= value <= high:
                name = self._function.parameters[position].name
                raise KernelError(
                    f"{name} must be an int in {low}..{high}, not {value!r} ({self._function.name}, {self._function.place})"
                )
        for position in self.float_positions:
            if not is_single(arguments[position]):
                name = self._function.parameters[position].name
                raise KernelError(
                    f"{name} must be a float of 32 bits, not {arguments[position]!r} ({self._function.name}, {self._function.place})"
                )

    def check_array(self, position: int, array: object) -> None:
        """Raise KernelError unless `array` is what parameter number `position` takes."""
        wanted, is_written = self._elements[position]
        if not (isinstance(array, np.ndarray) and array.dtype == wanted and array.ndim == 1):
            raise self._misfit(position, array)
        flags = array.flags
        if not (flags.c_contiguous and flags.aligned and (flags.writeable or not is_written)):
            raise self._misfit(position, array)

    @cached_property
    def _elements(self) -> dict[int, tuple[np.dtype[Any], bool]]:
        """For each array parameter, the type of its elements and whether the kernel stores into it."""
        parameters = [(each, self._function.parameters[each]) for each in self.array_positions]
        return {
            position: (each.type.element.dtype, each.name in self._function.written)
            for position, each in parameters
            if isinstance(each.type, ArrayType)
        }

    def _misfit(self, position: int, array: object) -> KernelError:
        """Return the error that says why a parameter does not take an array."""
        parameter, (wanted, _) = self._function.parameters[position], self._elements[position]
        where = f"({parameter.name} of {self._function.name}, {self._function.place})"
        if not isinstance(array, np.ndarray):
            what = f"be an array {parameter.type}, not {type(array).__name__}"
        elif array.dtype == wanted and array.ndim == 1 and not array.flags.c_contiguous:
            step = array.strides[0] // wanted.itemsize
            what = f"be one contiguous row of {wanted}, not a view in steps of {step} elements; pass a copy, array.copy()"
        elif array.dtype != wanted or array.ndim != 1:
            shape = "x".join(map(str, array.shape))
            what = f"be one contiguous row of {wanted}, not {array.dtype} of shape {shape}"
        elif not array.flags.aligned:
            what = f"lie at a multiple of {wanted.itemsize} bytes"
        else:
            what = "be writeable, because the kernel stores into it"
        return KernelError(f"{parameter.name} must {what} {where}")

    def check_overlaps(self, arrays: Sequence[NDArray[Any]]) -> None:
        """Raise KernelError if a written array overlaps one of wider or narrower elements, unless either is of bytes.

        The compiled code may have loaded such an element before the store, as C compilers may.
        """
        if len({each.itemsize for each in arrays} - {1}) < 2:  # all of one width, except bytes
            return
        named = list(zip(self.array_positions, arrays, strict=True))
        for (position, one), (behind, other) in combinations(named, 2):
            names = [self._function.parameters[each].name for each in (position, behind)]
            if one.itemsize == other.itemsize or 1 in (one.itemsize, other.itemsize):
                continue
            if not self._function.written.isdisjoint(names) and np.may_share_memory(one, other):
                raise KernelError(
                    f"{names[0]} ({one.dtype}) and {names[1]} ({other.dtype}) must not share memory, for the kernel stores "
                    f"into it: C compilers take it that elements of different widths do not ({self._function.name}, {self._function.place})"
                )
