"""A function that GCC compiled, as a kernel."""

from __future__ import annotations

from pathlib import Path

import numpy as np

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


ROW = np.arange(0, 96, 3, dtype=np.uint8)


def expected_sums(row: np.ndarray) -> np.ndarray:
    """What it leaves in `out` from the element 2 on."""
    weights = (1, -2, 3, -4)
    return np.array(
        [
            sum(weights[(x + k) % 4] * int(row[x + k]) for k in range(4)) if 2 <= x <= len(row) - 4 else 0
            for x in range(len(row))
        ]
    )
