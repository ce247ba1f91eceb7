"""Loads that LLVM has moved after a test because only one side needs them, put back before it, as in the source.

`sinking` decides whether they move to one side: GCC asks how often that side runs, and whether the other one stores
anything.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine


def with_early_loads(routine: Routine) -> Routine:
    """Return `routine` with each such load, and its address, at the end of the block before."""
    flow = ControlFlow(routine)
    blocks = {each.label: each for each in routine.blocks}
    for label in flow.order:
        before = flow.predecessors[label]
        if len(before) != 1 or len(set(blocks[before[0]].successors)) != 2:
            continue
        (source,) = before
        *rows, test = blocks[source].instructions
        early = _early(blocks[label].instructions, test)
        if early:
            blocks[source] = replace(blocks[source], instructions=(*rows, *early, test))
            rest = tuple(each for each in blocks[label].instructions if each not in early)
            blocks[label] = replace(blocks[label], instructions=rest)
    return replace(routine, blocks=tuple(blocks.values()))


def _early(rows: tuple[Instruction, ...], test: Instruction) -> list[Instruction]:
    """The first rows of a block that are addresses and loads of lines before the test that leads there."""
    found: list[Instruction] = []
    for each in rows:
        known = each.line._replace(line=0) == test.line._replace(line=0)
        if each.opcode not in ("getelementptr", "load") or not known or each.line.line >= test.line.line:
            break
        found.append(each)
    while found and found[-1].opcode != "load":
        found.pop()
    return found
