"""A function that GCC compiled, as a kernel."""

from __future__ import annotations

from pathlib import Path

from bfsim.api import Kernel, i32, kernel_from, u8

DATA = Path(__file__).parent / "blackfin" / "data"

SUMS = f"""
from bfsim.api import i32, kernel_from

sums = kernel_from({str(DATA / "sums.o")!r}, "sums", row=u8[:], out=i32[:], n=i32, first=i32, result=i32)
"""
"""For the end of firmware of a test: a kernel that is object code."""


def sums(folder: Path = DATA, file: str = "sums.o") -> Kernel:
    """The function of `sums.c`: of each place, the weighted sum of four elements from there on."""
    return kernel_from(folder / file, "sums", row=u8[:], out=i32[:], n=i32, first=i32, result=i32)
