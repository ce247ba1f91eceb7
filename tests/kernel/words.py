"""Plain Python with the integers of the chip: what a kernel must compute, without any compiler.

A function of the kernel language runs unchanged when its casts, `range`, `min` and `max` are these, and its
arrays are `Row`s. Literals stay Python's ints and take the type of the other side.
"""

from __future__ import annotations

import builtins
import operator
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel import quotient, remainder


def _wrapped(value: int, bits: int, *, signed: bool) -> int:
    low = value & ((1 << bits) - 1)
    return low - (1 << bits) if signed and low >> (bits - 1) else low


class Word:
    """A 32-bit integer, signed or not, whose arithmetic wraps."""

    def __init__(self, value: int, *, signed: bool) -> None:
        self.signed = signed
        self.value = _wrapped(value, 32, signed=signed)

    def __index__(self) -> int:
        return self.value

    def __bool__(self) -> bool:
        return self.value != 0

    def __neg__(self) -> Word:
        return Word(-self.value, signed=self.signed)

    def __invert__(self) -> Word:
        return Word(~self.value, signed=self.signed)

    def __abs__(self) -> Word:
        return Word(abs(self.value), signed=self.signed)

    def __hash__(self) -> int:
        return hash(self.value)


class Undefined(ArithmeticError):
    """Raised where the result of a division is not defined."""


def _defined(plain: Callable[[int, int], int]) -> Callable[[int, int], int]:
    def divide(dividend: int, divisor: int) -> int:
        if divisor == 0 or (dividend == -(2**31) and divisor == -1):
            raise Undefined(f"by {divisor}")
        return plain(dividend, divisor)

    return divide


def _install(name: str) -> None:
    plain: Callable[[int, int], int] = getattr(operator, name)
    if name in ("floordiv", "mod"):
        plain = _defined(plain)
    method = f"__{name.rstrip('_')}__"

    def forward(self: Word, other: Any) -> Word:
        return Word(plain(self.value, int(other)), signed=self.signed)

    def backward(self: Word, other: Any) -> Word:
        return Word(plain(int(other), self.value), signed=self.signed)

    setattr(Word, method, forward)
    setattr(Word, method.replace("__", "__r", 1), backward)


def _install_comparison(name: str) -> None:
    plain: Callable[[int, int], bool] = getattr(operator, name)
    setattr(Word, f"__{name}__", lambda self, other: plain(self.value, int(other)))


for _name in ("add", "sub", "mul", "floordiv", "mod", "lshift", "rshift", "and_", "or_", "xor"):
    _install(_name)
for _name in ("lt", "le", "gt", "ge", "eq", "ne"):
    _install_comparison(_name)


class Row:
    """A numpy row that is read as words and keeps what its own width holds."""

    def __init__(self, array: NDArray[Any], name: str = "") -> None:
        self.array = array
        self.name = name

    def _place(self, index: Word) -> int:
        if not 0 <= int(index) < len(self.array):
            raise IndexError(f"index {int(index)} is outside of {self.name}")
        return int(index)

    def __len__(self) -> int:
        return len(self.array)

    def __getitem__(self, index: Word) -> Word:
        return Word(int(self.array[self._place(index)]), signed=self.array.dtype != np.uint32)

    def __setitem__(self, index: Word, value: Any) -> None:
        kind = self.array.dtype
        self.array[self._place(index)] = _wrapped(int(value), 8 * kind.itemsize, signed=kind.kind == "i")


def _cast(bits: int, *, signed: bool) -> Callable[[Any], Word]:
    register_signed = signed or bits < 32
    return lambda value: Word(_wrapped(int(value), bits, signed=signed), signed=register_signed)


def _enumerate(row: Row) -> Iterator[tuple[Word, Word]]:
    return ((each, row[each]) for each in _range(len(row)))


def _range(*bounds: Any) -> Iterator[Word]:
    return (Word(each, signed=True) for each in builtins.range(*map(int, bounds)))


def _chosen(function: Callable[..., int]) -> Callable[..., Word]:
    def choose(*numbers: Any) -> Word:
        signed = next(each.signed for each in numbers if isinstance(each, Word))
        return Word(function(*map(int, numbers)), signed=signed)

    return choose


NAMES: dict[str, Any] = {
    "i8": _cast(8, signed=True), "u8": _cast(8, signed=False), "i16": _cast(16, signed=True),
    "u16": _cast(16, signed=False), "i32": _cast(32, signed=True), "u32": _cast(32, signed=False),
    "min": _chosen(min), "max": _chosen(max), "range": _range, "enumerate": _enumerate,
    "quotient": _chosen(_defined(quotient)), "remainder": _chosen(_defined(remainder)),
    "len": lambda row: Word(len(row), signed=True),
    "kernel": lambda function: function,
}  # fmt: skip
"""What the names of the kernel language mean in plain Python."""
