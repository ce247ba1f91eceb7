"""Choices between neighbouring numbers by a bit, computed from the bit: `4 if c & 1 else 5` is 5 - (c & 1) [two_value_replacement in tree-ssa-phiopt.cc of GCC 12].

Then no test of the chosen value is threaded to it. Other rules do this for 0 and 1. GCC also extends the bit of a byte
once more, which is not modelled.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    is_number,
    predicate,
    with_values,
    written,
)


def with_adjacent_numbers(routine: Routine) -> Routine:
    """Return `routine` with such choices computed, if nothing else is done or chosen on either side."""
    while True:
        flow = ControlFlow(routine)
        found = next(filter(None, (_found(flow, each) for each in routine.blocks)), None)
        if found is None:
            return routine
        routine = _computed(routine, found)


@dataclass(frozen=True)
class _Choice:
    """`phi` in block `home`: it is `low` and low + 1 on the two paths there from the test of `bit` in block `tested`.

    `sides`: the blocks that these come from; one may be `tested`. `rises`: whether a bit of 1 gives the larger number.
    """

    phi: Instruction
    home: str
    tested: str
    sides: tuple[str, str]
    bit: str
    low: int
    rises: bool


def _found(flow: ControlFlow, block: BasicBlock) -> _Choice | None:
    phis = [each for each in block.instructions if each.opcode == "phi"]
    for phi in phis:
        arms = arms_of(phi) if phi.text.startswith("phi i32 ") else {}
        numbers = [label for label, value in arms.items() if is_number(value)]
        for one, other in combinations(numbers, 2):
            others = (arms_of(each) for each in phis if each is not phi)
            if all(each[one] == each[other] for each in others):
                found = _chosen(flow, phi, block.label, (one, other))
                if found is not None:
                    return found
    return None


def _chosen(flow: ControlFlow, phi: Instruction, home: str, sides: tuple[str, str]) -> _Choice | None:
    arms = arms_of(phi)
    low, high = sorted(int(arms[each]) for each in sides)
    tested = {flow.tested(each) for each in sides}
    if high != low + 1 or low in (-1, 0) or len(tested) != 1:
        return None
    (label,) = tested
    branch = flow.blocks[label].terminator
    test = flow.instruction(branch.operands[0]) if branch.opcode == "br" and branch.operands else None
    if test is None or not _is_of_bit(flow, test):
        return None
    is_set = (predicate(test) == "eq") is (test.operands[1] == "1")
    way = flow.blocks[label].successors[0]
    if_so = int(arms[way if way in sides else label])
    return _Choice(phi, home, label, sides, test.operands[0], low, (if_so == high) is is_set)


def _is_of_bit(flow: ControlFlow, test: Instruction) -> bool:
    """Whether a test compares the lowest bit of a word with 0 or 1."""
    bit = flow.instruction(test.operands[0]) if test.opcode == "icmp" else None
    return (
        bit is not None
        and bit.text.startswith("and i32 ")
        and bit.operands[1] == "1"
        and predicate(test) in ("eq", "ne")
        and test.operands[1] in ("0", "1")
    )


def _computed(routine: Routine, choice: _Choice) -> Routine:
    """Return `routine` with the choice computed in place of its test."""
    value = f"{choice.phi.result}.of{choice.bit[1:]}"
    text = (
        f"add i32 {choice.bit}, {choice.low}" if choice.rises else f"sub i32 {choice.low + 1}, {choice.bit}"
    )
    row = written(value, text, (choice.bit, str(choice.low)), choice.phi)
    gone = {*choice.sides} - {choice.tested}
    blocks = []
    for block in routine.blocks:
        if block.label == choice.tested:
            *rows, branch = block.instructions
            jump = replace(branch, text=f"br label %{choice.home}", operands=(), weights=(), hint="")
            blocks.append(replace(block, instructions=(*rows, row, jump)))
        elif block.label == choice.home:
            together = (_with_one_way(each, choice, value) for each in block.instructions)
            blocks.append(replace(block, instructions=tuple(together)))
        elif block.label not in gone:
            blocks.append(block)
    return replace(routine, blocks=tuple(blocks))


def _with_one_way(each: Instruction, choice: _Choice, value: str) -> Instruction:
    """Return a phi with the block of the test in place of its sides, and `value` from there if it is the choice."""
    if each.opcode != "phi":
        return each
    arms = arms_of(each)
    comes = value if each is choice.phi else arms[choice.sides[0]]
    others = {label: arm for label, arm in arms.items() if label not in choice.sides}
    return with_values(each, others | {choice.tested: comes})
