"""Tests of what was shifted down: `v = a[i] >> 4`, `if v < 6` tests `v`, where LLVM tests `a[i] < 96` and shifts as well.

So the bound is a small number again, which a comparison takes as an immediate.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.estimate.conditions.next_values import SHIFTS
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, is_number, predicate


def with_shifted_tests(routine: Routine) -> Routine:
    """Return `routine` with tests of the shifted values, if these are computed before the test."""
    flow = ControlFlow(routine)
    blocks = []
    for block in routine.blocks:
        rows = [_shifted(flow, block.label, each) for each in block.instructions]
        blocks.append(replace(block, instructions=tuple(rows)))
    return replace(routine, blocks=tuple(blocks))


def _shifted(flow: ControlFlow, label: str, test: Instruction) -> Instruction:
    """Return a comparison of the shifted value in place of one that says the same of the value before."""
    if test.opcode != "icmp" or not is_number(test.operands[1]) or predicate(test)[1:] not in ("lt", "gt"):
        return test
    value, above = test.operands[0], predicate(test)[1:] == "gt"
    for shift in flow.users.get(value, []):
        amount = shift.operands[-1]
        is_down = SHIFTS.get(shift.opcode) == predicate(test)[0] and shift.operands[0] == value
        if not is_down or not is_number(amount) or not flow.runs_before(shift, label, test):
            continue
        bound, rest = divmod(int(test.operands[1]) + above, 1 << int(amount))
        if not rest:
            left, number = shift.result or "", str(bound - above)
            text = f"{test.text[: test.text.index(value)]}{left}, {number}"
            return replace(test, text=text, operands=(left, number))
    return test
