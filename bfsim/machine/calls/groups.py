"""Kernel calls that are counted together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel import Kernel
from bfsim.kernel.jit import CompiledKernel


@dataclass(slots=True)
class CallGroup:
    """Calls of one kernel in one stage with its arrays in the same memories. `totals`: events of each counter.

    `subbanks`: the sub-banks of L1 that the rows of each array have lain in.
    """

    stage: str
    kernel: Kernel
    memories: tuple[str, ...]
    code: CompiledKernel
    totals: NDArray[np.int64]
    subbanks: list[set[int]]
