"""What a kernel's text is lowered to: its operations, and what the lowering knows about it."""

from __future__ import annotations

from collections import Counter as Tally
from pathlib import Path

from bfsim.kernel import GCC_O2, CompilerProfile
from bfsim.kernel.estimate.costing import optimised
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.operations import Op
from tests.kernel.modules import kernel_of


def lowered(text: str, folder: Path, profile: CompilerProfile = GCC_O2) -> Tally[Op]:
    """Compile the only kernel of `text`, and count the operations of its blocks, each block once."""
    counts: Tally[Op] = Tally()
    for counter in kernel_of(text, folder).compile(profile).counters:
        for each in counter.charges if counter.value is None else ():
            counts[each.op] += each.times
    return counts


def context(text: str, folder: Path) -> Context:
    """What the lowering knows about the only kernel of `text`."""
    (routine,) = read_module(optimised(kernel_of(text, folder).function, GCC_O2))
    return Context(routine, GCC_O2)
