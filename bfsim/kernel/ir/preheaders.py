"""Preheaders: empty blocks before loops, for what must run once, and only if the loop is entered."""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.edges import put_between
from bfsim.kernel.ir.text import Routine


def preheader_of(loop: Loop) -> str:
    """Return the label of the preheader that a loop gets here."""
    return f"{loop.header}.before"


def with_preheaders(routine: Routine) -> Routine:
    """Return `routine` with a preheader for each loop that begins right after another one, or on one side of a test."""
    flow = ControlFlow(routine)
    for loop in sorted(flow.loops, key=lambda each: each.header):
        before = [each for each in flow.predecessors[loop.header] if each not in loop.blocks]
        if len(before) == 1 and _needs_one(flow, loop, before[0]):
            routine = with_preheader(routine, loop, before[0])
    return routine


def _needs_one(flow: ControlFlow, loop: Loop, before: str) -> bool:
    """Whether the only block `before` a loop belongs to another loop, or does not always lead to this one."""
    return flow.innermost(before) is not flow.around(loop) or len(set(flow.blocks[before].successors)) > 1


def with_preheader(routine: Routine, loop: Loop, before: str) -> Routine:
    """Return `routine` with a preheader between `loop` and block `before`, from which it is entered."""
    blocks = {each.label: each for each in routine.blocks}
    put_between(blocks, before, loop.header, preheader_of(loop))
    return replace(routine, blocks=tuple(blocks.values()))
