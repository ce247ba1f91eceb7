"""`vdsp-O2` beside what VisualDSP++ made: functions of stb_image in a program that it linked, and their estimates as kernels.

    python -m benchmarks.visualdsp_kernels PROGRAM.dxe

PROGRAM is one that has stb_image.h in it (public: georgenardes/image_processing_on_DSP on GitHub, for an ADSP-BF533).
The kernels here are these functions in Python, written before anybody had compared them. Both must leave the same;
cycles are means over the calls, timed as `gcc-adi` times instructions.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from bfsim.api import i32, kernel, kernel_from, u8, u32
from bfsim.kernel import Kernel
from bfsim.kernel.types import ArrayType, Number

SEED = 1
CALLS = 60
PIXELS, STEP = 320, 4
WRITTEN = 0xFFFF
"""Bits of a result that are compared: those above them are anything where C says `unsigned char`, and nothing here is larger."""


@kernel
def clamped(value: i32) -> i32:
    """Return a number of 0 to 255, the nearest one."""
    if u32(value) > 255:
        return 0 if value < 0 else 255
    return value


@kernel
def ycc_row(out: u8[:], luma: u8[:], blue: u8[:], red: u8[:], count: i32, step: i32) -> None:
    """Turn a row of YCbCr into RGBA, `step` bytes a pixel."""
    place = 0
    for x in range(count):
        base = (luma[x] << 20) + (1 << 19)
        cr = red[x] - 128
        cb = blue[x] - 128
        r = base + cr * 1470208
        g = base + cr * -748800 + (cb * -360960 & -65536)
        b = base + cb * 1858048
        out[place] = clamped(r >> 20)
        out[place + 1] = clamped(g >> 20)
        out[place + 2] = clamped(b >> 20)
        out[place + 3] = 255
        place += step


@kernel
def reversed16(n: i32) -> i32:
    """Return 16 bits in the reverse order."""
    n = ((n & 0xAAAA) >> 1) | ((n & 0x5555) << 1)
    n = ((n & 0xCCCC) >> 2) | ((n & 0x3333) << 2)
    n = ((n & 0xF0F0) >> 4) | ((n & 0x0F0F) << 4)
    return ((n & 0xFF00) >> 8) | ((n & 0x00FF) << 8)


@kernel
def bit_count(a: u32) -> i32:
    """Return how many bits are set."""
    a = (a & 0x55555555) + ((a >> 1) & 0x55555555)
    a = (a & 0x33333333) + ((a >> 2) & 0x33333333)
    a = (a + (a >> 4)) & 0x0F0F0F0F
    a = a + (a >> 8)
    a = a + (a >> 16)
    return i32(a & 0xFF)


@kernel
def high_bit(z: u32) -> i32:
    """Return the number of the highest bit that is set, -1 for none."""
    n = 0
    if z == 0:
        return -1
    if z >= 0x10000:
        n += 16
        z >>= 16
    if z >= 0x100:
        n += 8
        z >>= 8
    if z >= 0x10:
        n += 4
        z >>= 4
    if z >= 4:
        n += 2
        z >>= 2
    if z >= 2:
        n += 1
    return n


@kernel
def paeth(a: i32, b: i32, c: i32) -> i32:
    """Return which of three neighbours a pixel is guessed from."""
    p = a + b - c
    pa = abs(p - a)
    pb = abs(p - b)
    pc = abs(p - c)
    if pa <= pb and pa <= pc:
        return a
    if pb <= pc:
        return b
    return c


@kernel
def product8(x: i32, y: i32) -> i32:
    """Return the product of two fractions of 8 bits, rounded."""
    t = u32(x * y + 128)
    return i32((t + (t >> 8)) >> 8 & 255)


@kernel
def luma8(r: i32, g: i32, b: i32) -> i32:
    """Return the luma of a colour."""
    return (r * 77 + g * 150 + 29 * b) >> 8 & 255


@dataclass(frozen=True, slots=True)
class Pair:
    """A kernel, the function of stb_image that it is, and the parameters that this is declared with."""

    kernel: Kernel
    function: str
    parameters: Mapping[str, Number | ArrayType]


PAIRS = (
    Pair(
        ycc_row,
        "stbi__YCbCr_to_RGB_row",
        {"out": u8[:], "y": u8[:], "pcb": u8[:], "pcr": u8[:], "count": i32, "step": i32},
    ),
    Pair(reversed16, "stbi__bitreverse16", {"n": i32}),
    Pair(bit_count, "stbi__bitcount", {"a": u32}),
    Pair(high_bit, "stbi__high_bit", {"z": u32}),
    Pair(paeth, "stbi__paeth", {"a": i32, "b": i32, "c": i32}),
    Pair(product8, "stbi__blinn_8x8", {"x": i32, "y": i32}),
    Pair(luma8, "stbi__compute_y", {"r": i32, "g": i32, "b": i32}),
)


def calls(pair: Pair) -> Iterator[tuple[Any, ...]]:
    """Yield arguments: a row of pixels, or numbers as the function has them."""
    rng = np.random.default_rng(SEED)
    if pair.kernel is ycc_row:
        rows = (rng.integers(60, 200, PIXELS).astype(np.uint8) for _ in range(3))
        yield np.zeros(STEP * PIXELS, np.uint8), *rows, PIXELS, STEP
        return
    top = {reversed16: 16, bit_count: 31, high_bit: 31}.get(pair.kernel, 8)
    for _ in range(CALLS):
        sizes = rng.uniform(0, top, len(pair.parameters)) if pair.kernel is high_bit else None
        numbers = rng.integers(0, 1 << top, len(pair.parameters)) if sizes is None else 2**sizes
        yield tuple(int(each) for each in numbers)


def compared(pair: Pair, program: Path) -> tuple[float, float]:
    """Return the mean cycles of the function and of the kernel's estimate; raise ValueError where they leave something else."""
    result = None if pair.kernel is ycc_row else i32
    function = kernel_from(program, pair.function, result=result, **pair.parameters)
    real, estimated = [], []
    for arguments in calls(pair):
        left = []
        for each in (pair.kernel, function):
            given = [one.copy() if isinstance(one, np.ndarray) else one for one in arguments]
            value = each(*given)
            left.append(given[0].tolist() if value is None else value & WRITTEN)
        if left[0] != left[1]:
            raise ValueError(f"{pair.function} must leave what its kernel does")
        real.append(function.cost(*arguments))
        estimated.append(pair.kernel.cost(*arguments, profile="vdsp-O2"))
    return mean(real), mean(estimated)


def main() -> None:
    """Print a row for each function."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", type=Path)
    program = parser.parse_args().program.resolve()
    table = Table(title=f"{program.name}: cycles of a call", title_justify="left", box=None)
    for name in ("function", "VisualDSP++", "vdsp-O2", "error %"):
        table.add_column(name, justify="left" if name == "function" else "right")
    errors = []
    for pair in PAIRS:
        real, estimated = compared(pair, program)
        errors.append(100 * (estimated / real - 1))
        table.add_row(pair.function, f"{real:,.1f}", f"{estimated:,.1f}", f"{errors[-1]:+.0f}")
    table.add_row(
        "mean, with and without signs", "", "", f"{mean(errors):+.0f}, {mean(map(abs, errors)):.0f}"
    )
    Console().print(table)


if __name__ == "__main__":
    main()
