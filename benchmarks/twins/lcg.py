"""Inputs and checksums of the twins, as the C harness makes them (`c/ref.h`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
M32 = 0xFFFFFFFF


class Lcg:
    """The generator of the inputs: every draw advances the state once and takes its value from the new one."""

    def __init__(self, seed: int) -> None:
        self.state = seed

    def next(self) -> int:
        """Return the next state, 32 bits."""
        self.state = (self.state * 1664525 + 1013904223) & M32
        return self.state

    def u8(self) -> int:
        """Return the top byte of the next state."""
        return self.next() >> 24

    def u16(self) -> int:
        """Return the top half of the next state."""
        return self.next() >> 16

    def below(self, n: int) -> int:
        """Return a number in 0..n-1."""
        return ((self.next() >> 16) * n) >> 16

    def bytes(self, n: int) -> Array:
        """Draw `n` bytes."""
        return np.array([self.u8() for _ in range(n)], np.uint8)

    def scaled(self, n: int, limit: int, offset: int = 0, kind: str = "i2") -> Array:
        """Draw `n` numbers in offset..offset+limit-1."""
        return np.array([self.below(limit) + offset for _ in range(n)], kind)


def fnv(*arrays: Array) -> str:
    """Return the 32-bit FNV-1a checksum of the outputs, every element least significant byte first."""
    checksum = 2166136261
    for byte in b"".join(each.astype(each.dtype.newbyteorder("<")).tobytes() for each in arrays):
        checksum = ((checksum ^ byte) * 16777619) & M32
    return f"{checksum:08x}"
