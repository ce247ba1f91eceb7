"""A test of which one way leads to a choice, and the other one there, too, by an empty block that other tests share.

Of `if a and b: v = x`, `else: v = 0` either way may be the one without a block, as LLVM likes; only a side that is of one test alone becomes a
conditional move [`if_conversion`].
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import bypass, put_between
from bfsim.kernel.ir.text import Routine


def with_sides_apart(routine: Routine) -> Routine:
    """Return `routine` with an empty block on the way of such a test straight to the choice, in place of the one that is shared."""
    flow = ControlFlow(routine)
    blocks = {each.label: each for each in routine.blocks}
    for label, block in blocks.items():
        before = flow.predecessors[label]
        if len(block.instructions) > 1 or len(before) < 2 or len(set(block.successors)) != 1:
            continue
        (end,) = set(block.successors)
        tests = [each for each in before if end in flow.blocks[each].successors]
        if tests and end != label:
            for test in tests:
                put_between(blocks, test, end, f"{test}.side")
            bypass(blocks, before, label, end)
            return with_sides_apart(replace(routine, blocks=tuple(blocks.values())))
    return routine
