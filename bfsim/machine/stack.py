"""The stack of a core if it lies outside L1: compiled code spills to it, and its accesses take their time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bfsim.chip.memory_map import Region, region_of
from bfsim.linker import LinkMap
from bfsim.machine.memories import Memories

NAMED = "stack"
"""[assumed] A reserve with this in its name is the stack, as in the shipped LDFs and in VisualDSP++'s own."""


def stack_outside_l1(
    link_map: LinkMap, processor: str | None, regions: Sequence[Region], memories: Memories
) -> NDArray[np.uint8] | None:
    """Return the memory of a processor's stack if it lies in L2 or SDRAM, otherwise None. Of several reserves, the last counts.

    Raises LinkError if it is in memory that cannot be loaded and stored.
    """
    found = [
        each
        for each in link_map.reserves
        if NAMED in each.name and each.processor in {processor, None} and each.nbytes
    ]
    if not found:
        return None
    stack = found[-1]
    region = region_of(stack.start, stack.nbytes, regions)
    if region.owner != "shared":
        return None
    return memories.bytes_from(memories.offset_of(stack.start, stack.nbytes), stack.nbytes)
