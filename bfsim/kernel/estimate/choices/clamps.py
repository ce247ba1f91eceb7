"""Values limited on both sides, when LLVM has made one of the two tests narrow [minmax_replacement in tree-ssa-phiopt.cc of GCC 12].

In `if v < 0: v = 0 elif v > 255: v = 255`, the second test is then a minimum, and the first one a branch around it:
both are one value.
"""

from __future__ import annotations

import re
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, arms_of, is_number, predicate, written
from bfsim.kernel.ir.widths import WORD

INNER = re.compile(r"call i(8|16) @llvm\.s(min|max)\.i\d+\(i\d+ (\S+), i\d+ (-?\d+)\)$")
OUTER = {"min": ("slt", "max"), "max": ("sgt", "min")}
"""By the inner limit: what the first test is, and the limit that it makes."""


def with_clamps(routine: Routine) -> Routine:
    """Return `routine` with two limits in place of a test before a limit."""
    while (found := _first(ControlFlow(routine))) is not None:
        blocks, gone = found
        routine = replace(
            routine,
            blocks=tuple(blocks.get(each.label, each) for each in routine.blocks if each.label != gone),
        )
    return routine


def _first(flow: ControlFlow) -> tuple[dict[str, BasicBlock], str] | None:
    """The blocks that replace others for the first such test, and the block that is gone."""
    for block in flow.routine.blocks:
        for inside in dict.fromkeys(block.successors):
            if flow.predecessors[inside] == [block.label] and (made := _joined(flow, block, inside)):
                return made, inside
    return None


def _joined(flow: ControlFlow, block: BasicBlock, inside: str) -> dict[str, BasicBlock] | None:
    """The blocks around a test of `block` without it, if all that block `inside` does is the other limit."""
    (inner, *more), ways = flow.blocks[inside].instructions, flow.blocks[inside].successors
    limits = INNER.match(inner.text)
    if limits is None or len(more) != 1 or len(ways) != 1 or ways[0] not in block.successors:
        return None
    bits, kind, value, bound = limits.groups()
    relation, other = OUTER[kind]
    behind = flow.blocks[ways[0]]
    phis = [each for each in behind.instructions if each.opcode == "phi"]
    test = flow.instruction(block.terminator.operands[0])
    phi = next((each for each in phis if inner.result in each.operands), None)
    if test is None or test.opcode != "icmp" or phi is None or len(arms_of(phi)) != 2:
        return None
    limit = arms_of(phi)[block.label]
    is_first = block.successors[0] == behind.label
    if not is_number(limit) or not is_first or (predicate(test), *test.operands) != (relation, value, limit):
        return None
    if (int(limit) > int(bound)) == (kind == "min") or len(phis) != 1 or int(bits) >= WORD:
        return None
    kept = [each for each in behind.instructions if each is not phi]
    text = f"call i{bits} @llvm.s{other}.i{bits}(i{bits} {inner.result}, i{bits} {limit})"
    outer = written(phi.result or "", text, (inner.result or "", limit), inner)
    return {
        block.label: replace(
            block,
            instructions=(*block.instructions[:-1], inner, outer, _jump(block.terminator, behind.label)),
        ),
        behind.label: replace(behind, instructions=tuple(kept)),
    }


def _jump(branch: Instruction, label: str) -> Instruction:
    return replace(branch, text=f"br label %{label}", operands=(), weights=(), hint="")
