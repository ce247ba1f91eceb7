"""Loops that end with a test of what a variable is next: LLVM tests what it was, so that both are wanted at once.

Of `while z > 127: z >>= 7` it tests z > 16383 where z is shifted [foldICmpShrConstant in InstCombineCompares.cpp], of `while z > 0: z -= 3` z > 3;
GCC leaves the test as it is.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, Routine, arms_of, is_number, predicate, written

SHIFTS = {"lshr": "u", "ashr": "s"}
"""Shifts to the right, and of which comparisons they keep the order."""


def with_tests_of_next_values(routine: Routine) -> Routine:
    """Return `routine` with such tests as they were written."""
    flow = ControlFlow(routine)
    tests = {}
    for loop in flow.loops:
        ending = flow.blocks[loop.latch].terminator
        test = flow.instruction(ending.operands[0]) if ending.opcode == "br" and ending.operands else None
        if test is not None and flow.users[test.result or ""] == [ending]:
            restored = _restored(flow, loop, test)
            if restored is not None:
                tests[test.result] = restored
    blocks = (
        replace(block, instructions=tuple(tests.get(each.result, each) for each in block.instructions))
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks)) if tests else routine


def _restored(flow: ControlFlow, loop: Loop, test: Instruction) -> Instruction | None:
    """Return a test of what a variable of a loop was as one of what it is next; None if it is no such test."""
    home, variable = flow.defined.get(test.operands[0], ("", None))
    if test.opcode != "icmp" or variable is None or variable.opcode != "phi" or home != loop.header:
        return None
    following = flow.instruction(arms_of(variable).get(loop.latch, ""))
    if following is None or len(following.operands) != 2 or following.operands[0] != variable.result:
        return None
    is_made = _is_before(flow, following, test) and (following.opcode != "add" or " nsw " in following.text)
    if not is_made or not all(map(is_number, (test.operands[1], following.operands[1]))):
        return None
    number = _number(predicate(test), int(test.operands[1]), following.opcode, int(following.operands[1]))
    if number is None:
        return None
    name, relation = following.result or "", predicate(test)
    text = f"icmp {relation} i32 {name}, {number}"
    return written(test.result or "", text, (name, str(number)), test)


def _is_before(flow: ControlFlow, one: Instruction, other: Instruction) -> bool:
    """Whether one of two instructions of a loop, which every iteration computes, comes first."""
    home, _ = flow.defined[one.result or ""]
    rows = flow.blocks[home].instructions
    return other not in rows or rows.index(one) < rows.index(other)


def _number(relation: str, number: int, opcode: str, operand: int) -> int | None:
    """Return the number that what is next is compared with in place of `number`; None if there is none."""
    if opcode == "add" and relation in ("sgt", "slt", "sge", "sle"):
        return number + operand
    if SHIFTS.get(opcode) != relation[0] or relation[1:] not in ("gt", "lt"):
        return None
    first = number + 1 if relation[1:] == "gt" else number
    shifted, rest = divmod(first, 1 << operand)
    return None if rest else shifted - (relation[1:] == "gt")
