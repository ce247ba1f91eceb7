"""How a twin is run: which inputs it gets, and which outputs its checksum covers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.twins.lcg import Array, Lcg, fnv
from bfsim.kernel import Kernel

Run = Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Case:
    """One twin. `play` draws the inputs, calls what it is given as the kernel would be called, and returns the outputs.

    The C of one that is `exported` is what `bfsim export` writes; the others' stands in `c/`, with helpers that are called.
    """

    kernel: Kernel
    seed: int
    play: Callable[[Lcg, Run], Iterable[Array]]
    exported: bool = False

    @property
    def name(self) -> str:
        """Name of the kernel, in Python and in C."""
        return self.kernel.name

    def checksum(self, run: Run | None = None) -> str:
        """Play the case and return the checksum of its outputs; `run` may stand in for the kernel."""
        return fnv(*self.play(Lcg(self.seed), run or self.kernel))


def word(value: int) -> Array:
    """Return a result as an array of one 32-bit word."""
    return np.array([value], np.int32)
