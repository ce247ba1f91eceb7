"""Loops that end with a test of a variable's next value: LLVM tests the old value, so that both are live at once.

For `while z > 127: z >>= 7` it tests z > 16383 before z is shifted [foldICmpShrConstant in InstCombineCompares.cpp],
and z > 3 for `while z > 0: z -= 3`; GCC leaves the test as it is.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, is_number, predicate, written

SHIFTS = {"lshr": "u", "ashr": "s"}
"""Shifts to the right, and the comparisons whose order they keep."""


def with_tests_of_next_values(routine: Routine) -> Routine:
    """Return `routine` with such tests as they were written."""
    flow = ControlFlow(routine)
    blocks = (
        replace(block, instructions=tuple(_restored(flow, block, each) for each in block.instructions))
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))


def _restored(flow: ControlFlow, block: BasicBlock, test: Instruction) -> Instruction:
    """Return a test of a variable's old value as one of the next value if that is known by then; anything else unchanged."""
    variable = flow.instruction(test.operands[0]) if test.opcode == "icmp" else None
    if variable is None or variable.opcode != "phi" or not is_number(test.operands[1]):
        return test
    for each in map(flow.instruction, _next_values(flow, variable)):
        if (
            each is None
            or each.operands[:1] != (variable.result,)
            or not flow.runs_before(each, block.label, test)
        ):
            continue
        number = _number(predicate(test), int(test.operands[1]), each)
        if number is not None:
            name = each.result or ""
            text = f"icmp {predicate(test)} i32 {name}, {number}"
            return written(test.result or "", text, (name, str(number)), test)
    return test


def _next_values(flow: ControlFlow, variable: Instruction) -> list[str]:
    """Return the next values of a variable, also by way of another one, as for a counter after a skipped iteration."""
    merged = (flow.instruction(each) for each in variable.operands)
    others = (each for each in merged if each is not None and each.opcode == "phi" and each is not variable)
    return [*variable.operands, *(value for each in others for value in each.operands)]


def _number(relation: str, number: int, step: Instruction) -> int | None:
    """Return the number that the next value is compared with in place of `number`; None if there is none."""
    if len(step.operands) != 2 or not is_number(step.operands[1]) or " i32 " not in step.text:
        return None
    operand = int(step.operands[1])
    if step.opcode == "add":
        is_equal = relation in ("eq", "ne")
        return number + operand if is_equal or (relation[0] == "s" and " nsw " in step.text) else None
    if SHIFTS.get(step.opcode) != relation[0] or relation[1:] not in ("gt", "lt"):
        return None
    first = number + 1 if relation[1:] == "gt" else number
    shifted, rest = divmod(first, 1 << operand)
    return None if rest else shifted - (relation[1:] == "gt")
