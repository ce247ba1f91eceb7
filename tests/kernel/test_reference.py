"""Twins of kernels that ran as Blackfin code: the same inputs must give the same outputs, bit for bit.

The inputs come from a 32-bit linear congruential generator: every draw advances the state once, and its value
is the top byte (u8), the top half (u16) or the top half scaled to a range (below) of the new state. The
checksum is 32-bit FNV-1a over the output arrays, every element least significant byte first. The expected
checksums are those that the C kernels gave under the GNU Blackfin simulator.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from bfsim.kernel import VDSP_O2, Kernel
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


class Twin(NamedTuple):
    """A twin, and what the C kernel gave on the Blackfin: checksum, and cycles of GCC 12.2 at -O2.

    The cycles are those of the GNU simulator with one cycle per register of a push or pop multiple.
    """

    run: Callable[[Lcg], str]
    kernel: str
    seed: int
    checksum: str
    measured_cclk: int


TWINS = (
    Twin(gray, "gray_from_uyvy_row", 1001, "9a3cb458", 978),
    Twin(gauss3, "gauss3_row", 1002, "1a646ad4", 9_901),
    Twin(sobel, "sobel_row", 1003, "0b17cf9b", 11_182),
    Twin(isqrt, "isqrt_row", 1004, "0dfd4da4", 65_448),
    Twin(nms, "nms_row", 1007, "bf5b4256", 13_077),
    Twin(erode32, "erode32_row", 1009, "536b2e0a", 5_756),
    Twin(remap, "remap_row", 1013, "572bf415", 1_300),
    Twin(copy, "copy_words", 1018, "bd141387", 8_209),
    Twin(insertion_sort, "insertion_sort_u16", 1019, "1d1abc2f", 152_916),
    Twin(match, "match_lines", 1020, "4ba65fcf", 107_725),
)
each_twin = pytest.mark.parametrize("twin", TWINS, ids=[each.kernel for each in TWINS])


@each_twin
def test_a_twin_gives_the_checksum_of_the_blackfin_code(twin: Twin) -> None:
    """The Python kernel's output is the C kernel's output on the Blackfin, bit for bit."""
    assert twin.run(Lcg(twin.seed)) == twin.checksum


class Counted:
    """Stands in for a kernel, and keeps what its calls cost."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.issue_cclk = 0

    def __call__(self, *arguments: Any) -> int | None:
        """Run the kernel as `Kernel.__call__` does."""
        code = self.kernel.compiled(VDSP_O2)
        arrays = [arguments[each] for each in self.kernel.array_positions]
        work = self.kernel.prepare(code, arrays, code.new_totals()).run(arguments)
        self.issue_cclk += work.issue_cclk
        return work.value


@each_twin
def test_the_cycles_are_as_near_as_the_readme_says(twin: Twin, monkeypatch: pytest.MonkeyPatch) -> None:
    """Between 42 % too few and 9 % too many: the stated error of the first set of rules."""
    counted = Counted(getattr(kernels, twin.kernel))
    monkeypatch.setattr(kernels, twin.kernel, counted)
    twin.run(Lcg(twin.seed))
    error = counted.issue_cclk / twin.measured_cclk - 1
    assert -0.42 < error < 0.09
