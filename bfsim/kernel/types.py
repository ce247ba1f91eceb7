"""The types of the kernel language: 32-bit integers to compute with, narrower ones to store in arrays.

A name such as `u8` has two uses: in an annotation `u8[:]` is an array of bytes, and in an expression
`u8(x)` keeps the low eight bits of `x`, in a kernel as in plain Python.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np


@dataclass(frozen=True, slots=True)
class IntType:
    """A two's complement integer of `bits` bits; arithmetic on it wraps."""

    name: str
    bits: int
    signed: bool

    @property
    def nbytes(self) -> int:
        """Size of one element in bytes."""
        return self.bits // 8

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """Element type of the numpy arrays that hold it."""
        return np.dtype(f"{'i' if self.signed else 'u'}{self.nbytes}")

    @property
    def bounds(self) -> tuple[int, int]:
        """Smallest and largest value."""
        if self.signed:
            return -(1 << (self.bits - 1)), (1 << (self.bits - 1)) - 1
        return 0, (1 << self.bits) - 1

    def __getitem__(self, item: object) -> ArrayType:
        return _array_of(self, item)

    def __call__(self, value: int) -> int:
        low, high = self.bounds
        return (int(value) - low & (high - low)) + low

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class FloatType:
    """An IEEE single. The Blackfin has no floating-point unit: every operation is a call of the run-time library."""

    name: str
    bits: int

    @property
    def nbytes(self) -> int:
        """Size of one element in bytes."""
        return self.bits // 8

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """Element type of the numpy arrays that hold it."""
        return np.dtype(f"f{self.nbytes}")

    def __getitem__(self, item: object) -> ArrayType:
        return _array_of(self, item)

    def __call__(self, value: float) -> float:
        return float(np.float32(value))

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class ArrayType:
    """A one-dimensional array in the chip's memory."""

    element: Number

    def __str__(self) -> str:
        return f"{self.element}[:]"


@dataclass(frozen=True, slots=True)
class BoolType:
    """The result of a comparison: good for `if`, `while`, `and`, `or`, `not`."""

    def __str__(self) -> str:
        return "bool"


@dataclass(frozen=True, slots=True)
class PairType:
    """The result of an intrinsic with two results: two words, each of which is assigned to a name."""

    def __str__(self) -> str:
        return "pair"


i8 = IntType("i8", 8, signed=True)
u8 = IntType("u8", 8, signed=False)
i16 = IntType("i16", 16, signed=True)
u16 = IntType("u16", 16, signed=False)
i32 = IntType("i32", 32, signed=True)
u32 = IntType("u32", 32, signed=False)
f32 = FloatType("f32", 32)
BOOL = BoolType()
PAIR = PairType()

Number = IntType | FloatType
Value = Number | BoolType | PairType


NUMBERS: dict[str, Number] = {each.name: each for each in (i8, u8, i16, u16, i32, u32, f32)}


def _array_of(element: Number, item: object) -> ArrayType:
    """Return the type that `element[item]` names. Raises TypeError unless it is written like u8[:]."""
    if item != slice(None):
        raise TypeError(
            f"an array type must be written {element.name}[:]: one dimension, no size: a[y * width + x]"
        )
    return ArrayType(element)


@cache
def type_named(name: str) -> Number | ArrayType:
    """Return the type of a parameter by its name, such as "i32" or "u8[:]"."""
    element = NUMBERS[name.removesuffix("[:]")]
    return ArrayType(element) if name.endswith("[:]") else element


def promoted(element: Number) -> Number:
    """Return the type of `element` once loaded into a register: 32 bits wide, unsigned only for u32 (C's promotion)."""
    return element if element is u32 or isinstance(element, FloatType) else i32


def quotient(dividend: int, divisor: int) -> int:
    """Return dividend / divisor as C has it, rounded towards zero; `//` rounds down. In a kernel both are i32 or both u32."""
    size = abs(int(dividend)) // abs(int(divisor))
    return size if (dividend < 0) == (divisor < 0) else -size


def remainder(dividend: int, divisor: int) -> int:
    """Return what `quotient` leaves: C's %, with the sign of the dividend; Python's % has that of the divisor."""
    return int(dividend) - quotient(dividend, divisor) * int(divisor)


def sqrt(value: float) -> float:
    """Return the square root of an f32, rounded to an f32; in a kernel a call of the run-time library."""
    return float(np.sqrt(np.float32(value)))
