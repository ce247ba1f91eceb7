"""Preheaders: empty blocks before loops, for what must run once, and only if the loop is entered."""

from __future__ import annotations

import re
from dataclasses import replace

from bfsim.kernel.ir_text import BasicBlock, Instruction, Routine
from bfsim.kernel.loops import ControlFlow, Loop


def preheader_of(loop: Loop) -> str:
    """Return the label of the preheader that a loop gets here."""
    return f"{loop.header}.before"


def with_preheaders(routine: Routine) -> Routine:
    """Return `routine` with a preheader for each loop that begins right behind another one."""
    flow = ControlFlow(routine)
    for loop in sorted(flow.loops, key=lambda each: each.header):
        before = [each for each in flow.predecessors[loop.header] if each not in loop.blocks]
        if len(before) == 1 and flow.innermost(before[0]) is not flow.around(loop):
            routine = with_preheader(routine, loop, before[0])
    return routine


def with_preheader(routine: Routine, loop: Loop, before: str) -> Routine:
    """Return `routine` with a preheader between `loop` and block `before`, from which it is entered."""
    blocks = {each.label: each for each in routine.blocks}
    branch, header, label = blocks[before].terminator, loop.header, preheader_of(loop)
    text = re.sub(rf"label %{re.escape(header)}(?![\w.$-])", f"label %{label}", branch.text)
    blocks[before] = replace(
        blocks[before], instructions=(*blocks[before].instructions[:-1], replace(branch, text=text))
    )
    blocks[header] = replace(
        blocks[header],
        instructions=tuple(_from(each, before, label) for each in blocks[header].instructions),
    )
    jump = Instruction(None, "br", f"br label %{header}", (), branch.line, location=branch.location)
    blocks[label] = BasicBlock(label, (jump,))
    return replace(routine, blocks=tuple(blocks.values()))


def _from(each: Instruction, before: str, label: str) -> Instruction:
    """Let a phi expect block `label` where it expected `before`."""
    if each.opcode != "phi":
        return each
    return replace(each, text=each.text.replace(f", %{before} ]", f", %{label} ]"))
