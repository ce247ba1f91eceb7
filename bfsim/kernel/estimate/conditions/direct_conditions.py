"""`a or b` and `a and b` as conditions: two branches each, as GCC has them from the start, before LLVM threads any jumps."""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import going_to, with_arms
from bfsim.kernel.ir.text import TRUTHS, BasicBlock, Routine, arms_of, renamed


def with_direct_conditions(routine: Routine) -> Routine:
    """Return `routine` without blocks that only choose between the truths of conditions and branch by them."""
    while True:
        flow = ControlFlow(routine)
        found = ((block, _ways(flow, block)) for block in routine.blocks)
        block, ways = next(((block, ways) for block, ways in found if ways is not None), (None, None))
        if block is None or ways is None:
            return routine
        blocks = dict(flow.blocks)
        _lead(blocks, block, ways)
        routine = replace(routine, blocks=tuple(blocks.values()))


def _ways(flow: ControlFlow, block: BasicBlock) -> dict[str, str | int] | None:
    """Return what decides on the edge from each block before one that only decides: a condition, or its known truth."""
    if [each.opcode for each in block.instructions] != ["phi", "br"] or len(set(block.successors)) != 2:
        return None
    phi, branch = block.instructions
    if not phi.text.startswith("phi i1") or branch.operands[0] != phi.result:
        return None
    if flow.users[phi.result or ""] != [branch] or block.enters:
        return None
    yes, no = block.successors
    found: dict[str, str | int] = {}
    for label, value in arms_of(phi).items():
        end = flow.blocks[label].terminator
        if len(set(end_ways := flow.blocks[label].successors)) == 1:
            found[label] = value
        elif end.opcode == "br" and value == end.operands[0] and end_ways.count(block.label) == 1:
            found[label] = int(end_ways[0] == block.label)
        elif value in TRUTHS and end.opcode == "br":
            found[label] = TRUTHS[value]
        else:
            return None
        if found[label] in (0, 1) and (yes if found[label] else no) in end_ways:
            return None  # both sides of its test would lead there
    return found


def _lead(blocks: dict[str, BasicBlock], block: BasicBlock, ways: dict[str, str | int]) -> None:
    """Lead the blocks before one straight to where it leads, and leave it out."""
    yes, no = block.successors
    before = {yes: list[str](), no: list[str]()}
    for label, decides in ways.items():
        known = TRUTHS.get(str(decides), decides)
        if isinstance(known, int):
            goal = yes if known else no
            blocks[label] = going_to(blocks[label], block.label, goal)
            before[goal].append(label)
        else:
            branch = renamed(block.terminator, {block.terminator.operands[0]: known})
            blocks[label] = replace(blocks[label], instructions=(*blocks[label].instructions[:-1], branch))
            before[yes].append(label)
            before[no].append(label)
    for goal, labels in before.items():
        blocks[goal] = with_arms(blocks[goal], [block.label], labels)
    del blocks[block.label]
