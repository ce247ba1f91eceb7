"""Choices of narrow sums: `v - 20 if v > 20 else 0` of unsigned narrow numbers is a maximum, less 20 [match.pd of GCC 12].

Those of words were found before (`extremes`); of these, LLVM would make functions other than minima and maxima. If such
a number has another use, GCC tests it as a word and adds to it as narrow: then there are two values, and no maximum.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import without_way
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
from bfsim.kernel.ir.widths import WORD

CHOSEN = {"ugt": ("umax", 1), "uge": ("umax", -1), "ult": ("umin", -1), "ule": ("umin", 1)}
"""What is chosen if a test holds for the sum, and which neighbour of its number would do as well."""


class _Sum(NamedTuple):
    """A block that tests, the `arm` that adds, the phi after it, and the number chosen instead of the sum, less what is added."""

    block: BasicBlock
    arm: BasicBlock
    phi: Instruction
    name: str
    bound: int


def with_narrow_sums(routine: Routine) -> Routine:
    """Return `routine` with such choices in place of branches."""
    while True:
        flow = ControlFlow(routine)
        found = next(filter(None, (_sum(flow, each) for each in routine.blocks)), None)
        if found is None:
            return routine
        routine = replace(routine, blocks=tuple(_chosen(flow, found).values()))


def _sum(flow: ControlFlow, block: BasicBlock) -> _Sum | None:
    if block.terminator.opcode != "br" or len(set(block.successors)) != 2:
        return None
    way, home = block.successors
    test, arm = flow.instruction(block.terminator.operands[0]), flow.blocks[way]
    if test is None or test.opcode != "icmp" or test.bits == WORD or predicate(test) not in CHOSEN:
        return None
    if arm.successors != (home,) or flow.predecessors[way] != [block.label] or arm.enters:
        return None
    rows = arm.instructions[:-1]
    phis = [each for each in flow.blocks[home].instructions if each.opcode == "phi"]
    if (
        len(rows) != 1
        or rows[0].opcode != "add"
        or len(phis) != 1
        or flow.users[rows[0].result or ""] != phis
    ):
        return None
    (value, added), arms = rows[0].operands, arms_of(phis[0])
    number, tested = arms[block.label], test.operands
    if (
        value != tested[0]
        or len(flow.users[value]) > 2
        or not all(map(is_number, (added, number, tested[1])))
    ):
        return None
    name, beside = CHOSEN[predicate(test)]
    size = 1 << test.bits
    bound, limit = (int(number) - int(added)) % size, int(tested[1]) % size
    is_one = arms[way] == rows[0].result and bound in (limit, limit + beside)
    return _Sum(block, arm, phis[0], name, bound) if is_one else None


def _chosen(flow: ControlFlow, found: _Sum) -> dict[str, BasicBlock]:
    """Return the blocks of the routine, in which the sum is computed in any case."""
    blocks, (row, end) = dict(flow.blocks), found.arm.instructions
    value, kind = row.operands[0], f"i{row.bits}"
    name, label = f"%{found.block.label}.{found.name}", found.block.label
    text = f"call {kind} @llvm.{found.name}.{kind}({kind} {value}, {kind} {found.bound})"
    call = written(name, text, (value, str(found.bound)), row)
    total = replace(row, text=row.text.replace(f"{value},", f"{name},"), operands=(name, row.operands[1]))
    test = flow.instruction(found.block.terminator.operands[0])
    unused = [test] if test and len(flow.users[test.result or ""]) == 1 else []
    kept = [each for each in found.block.instructions[:-1] if each not in unused]
    blocks[label] = replace(found.block, instructions=(*kept, call, total, end))
    home = blocks[found.block.successors[1]]
    phi = without_way(found.phi, found.arm.label)
    phi = with_values(phi, arms_of(phi) | {label: row.result or ""})
    rows = tuple(phi if each is found.phi else each for each in home.instructions)
    blocks[home.label] = replace(home, instructions=rows)
    del blocks[found.arm.label]
    return blocks
