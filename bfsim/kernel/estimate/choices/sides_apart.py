"""Tests with one side that leads straight to a choice, and another that leads there by an empty block that other tests share.

In `if a and b: v = x`, `else: v = 0` either side may be the one without a block, as LLVM chooses; only a side that
belongs to a single test becomes a conditional move [`if_conversion`].
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import bypass, put_between
from bfsim.kernel.ir.text import Routine


def with_sides_apart(routine: Routine) -> Routine:
    """Return `routine` with an empty block between such a test and the choice, in place of the shared one."""
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
