"""Comparisons with a sum with 1, without the 1: x > w - 1 is x >= w [maybe_canonicalize_comparison in fold-const.cc of GCC 12].

So GCC sees no minimum in `if x > w - 1: x = w - 1`, but does if the bound has a name.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import SWAPPED, Instruction, Routine, is_number, predicate
from bfsim.kernel.ir.widths import WORD

WITHOUT_ONE = {(-1, "lt"): "le", (-1, "ge"): "gt", (1, "gt"): "ge", (1, "le"): "lt"}
"""What a relation becomes, by the number added on its left side."""


def with_nearer_bounds(routine: Routine) -> Routine:
    """Return `routine` with such tests, for sums without other uses, and not for tests that end a loop."""
    flow = ControlFlow(routine)
    ends = {label for loop in flow.loops for label in flow.exits(loop)}
    blocks = (
        block
        if block.label in ends
        else replace(block, instructions=tuple(_nearer(flow, each) for each in block.instructions))
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))


def _nearer(flow: ControlFlow, test: Instruction) -> Instruction:
    if test.opcode != "icmp" or test.bits != WORD or predicate(test)[0] != "s":
        return test
    left, right = test.operands
    for sum_, other, relation in (
        (left, right, predicate(test)[1:]),
        (right, left, SWAPPED[predicate(test)][1:]),
    ):
        made = flow.instruction(sum_)
        if made is None or made.opcode not in ("add", "sub") or not is_number(made.operands[1]):
            continue
        added = int(made.operands[1]) * (1 if made.opcode == "add" else -1)
        nearer = WITHOUT_ONE.get((added, relation))
        if nearer is not None and len(flow.users[sum_]) == 1 and not is_number(other):
            operands = made.operands[0], other
            text = f"icmp s{nearer} i{WORD} {', '.join(operands)}"
            return replace(test, text=text, operands=operands)
    return test
