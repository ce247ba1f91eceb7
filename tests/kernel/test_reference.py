"""Twins of kernels that ran as Blackfin code: the same inputs must give the same outputs, bit for bit.

The inputs come from a 32-bit linear congruential generator: every draw advances the state once, and its value
is the top byte (u8), the top half (u16) or the top half scaled to a range (below) of the new state. The
checksum is 32-bit FNV-1a over the output arrays, every element least significant byte first. The expected
checksums are those that the C kernels gave under the GNU Blackfin simulator.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.kernel import reference_kernels as kernels

M32 = 0xFFFFFFFF
Array = NDArray[Any]


class Lcg:
    """The generator of the inputs."""

    def __init__(self, seed: int) -> None:
        self.state = seed

    def next(self) -> int:
        """Return the next state."""
        self.state = (self.state * 1664525 + 1013904223) & M32
        return self.state

    def below(self, n: int) -> int:
        """Return a number in 0..n-1."""
        return ((self.next() >> 16) * n) >> 16

    def u8(self, n: int) -> Array:
        """Draw `n` bytes."""
        return np.array([self.next() >> 24 for _ in range(n)], np.uint8)

    def rows(self, count: int, n: int = 320) -> list[Array]:
        """Draw rows of bytes, one after the other."""
        return [self.u8(n) for _ in range(count)]

    def scaled(self, n: int, limit: int, offset: int = 0, kind: str = "i2") -> Array:
        """Draw `n` numbers in offset..offset+limit-1."""
        return np.array([self.below(limit) + offset for _ in range(n)], kind)

    def dense_words(self, n: int) -> Array:
        """Draw words whose bits are set seven times in eight."""
        return np.array([self.next() | self.next() | self.next() for _ in range(n)], np.uint32)

    def lines(self, n: int) -> tuple[Array, Array, Array]:
        """Draw lines: middle x, middle y, angle."""
        drawn = [(self.below(320), self.below(240), self.next() >> 24) for _ in range(n)]
        x, y, angle = zip(*drawn, strict=True)
        return np.array(x, np.int16), np.array(y, np.int16), np.array(angle, np.uint8)


def fnv(*arrays: Array) -> str:
    """Return the checksum of the outputs."""
    checksum = 2166136261
    for byte in b"".join(each.astype(each.dtype.newbyteorder("<")).tobytes() for each in arrays):
        checksum = ((checksum ^ byte) * 16777619) & M32
    return f"{checksum:08x}"


def gray(lcg: Lcg) -> str:
    """Luminance of a UYVY row."""
    y = np.zeros(320, np.uint8)
    kernels.gray_from_uyvy_row(lcg.u8(640), y, 320)
    return fnv(y)


def gauss3(lcg: Lcg) -> str:
    """Smooth a row."""
    out = np.zeros(320, np.uint8)
    kernels.gauss3_row(*lcg.rows(3), out, 320)
    return fnv(out)


def sobel(lcg: Lcg) -> str:
    """Gradients of a row."""
    gx, gy = np.zeros(320, np.int16), np.zeros(320, np.int16)
    kernels.sobel_row(*lcg.rows(3), gx, gy, 320)
    return fnv(gx, gy)


def isqrt(lcg: Lcg) -> str:
    """Gradient magnitudes by square roots."""
    magnitude = np.zeros(320, np.uint16)
    kernels.isqrt_row(lcg.scaled(320, 2041, -1020), lcg.scaled(320, 2041, -1020), magnitude, 320)
    return fnv(magnitude)


def nms(lcg: Lcg) -> str:
    """Non-maximum suppression of a row."""
    out = np.zeros(320, np.uint8)
    kernels.nms_row(*lcg.rows(4), out, 320)
    return fnv(out)


def erode32(lcg: Lcg) -> str:
    """Erosion of 32 binary planes."""
    out = np.zeros(320, np.uint32)
    kernels.erode32_row(*(lcg.dense_words(320) for _ in range(3)), out, 320)
    return fnv(out)


def remap(lcg: Lcg) -> str:
    """Rectification of a row by a table."""
    out = np.zeros(320, np.uint8)
    kernels.remap_row(lcg.u8(20480), lcg.scaled(320, 20480, kind="u4"), out, 320)
    return fnv(out)


def copy(lcg: Lcg) -> str:
    """Copy words."""
    out = np.zeros(4096, np.uint32)
    kernels.copy_words(np.array([lcg.next() for _ in range(4096)], np.uint32), out, 4096)
    return fnv(out)


def insertion_sort(lcg: Lcg) -> str:
    """Sort in place."""
    a = np.array([lcg.next() >> 16 for _ in range(200)], np.uint16)
    kernels.insertion_sort_u16(a, 200)
    return fnv(a)


def match(lcg: Lcg) -> str:
    """Match two sets of lines."""
    first, second = lcg.lines(60), lcg.lines(60)
    matches = np.zeros(60, np.int16)
    count = kernels.match_lines(*first, 60, *second, 60, 16, 2500, matches)
    return fnv(matches, np.array([count], np.int32))


@pytest.mark.parametrize(
    ("twin", "seed", "checksum"),
    [
        (gray, 1001, "9a3cb458"),
        (gauss3, 1002, "1a646ad4"),
        (sobel, 1003, "0b17cf9b"),
        (isqrt, 1004, "0dfd4da4"),
        (nms, 1007, "bf5b4256"),
        (erode32, 1009, "536b2e0a"),
        (remap, 1013, "572bf415"),
        (copy, 1018, "bd141387"),
        (insertion_sort, 1019, "1d1abc2f"),
        (match, 1020, "4ba65fcf"),
    ],
)
def test_a_twin_gives_the_checksum_of_the_blackfin_code(
    twin: Callable[[Lcg], str], seed: int, checksum: str
) -> None:
    """The Python kernel's output is the C kernel's output on the Blackfin, bit for bit."""
    assert twin(Lcg(seed)) == checksum
