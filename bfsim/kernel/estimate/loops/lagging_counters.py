"""Lagging counters: a value that a loop carries to have its counter one iteration later is the counter less its step.

LLVM makes `x - 1` of such a loop a separate variable [phi of ops, NewGVN]; GCC does not, and so knows how far `x - 1`
is from `x + 2`.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, arms_of, is_number


def without_lagging(routine: Routine) -> Routine:
    """Return `routine` with each such variable computed from the counter."""
    flow = ControlFlow(routine)
    found = {
        each.result: made
        for loop in flow.loops
        for each in flow.blocks[loop.header].instructions
        if (made := _computed(flow, loop, each)) is not None
    }
    return (
        replace(routine, blocks=tuple(_with(block, found) for block in routine.blocks)) if found else routine
    )


def _computed(flow: ControlFlow, loop: Loop, phi: Instruction) -> Instruction | None:
    """The sum that replaces a phi, or None."""
    arms = arms_of(phi) if phi.opcode == "phi" else {}
    counter = flow.instruction(arms.get(loop.latch, ""))
    if counter is None or counter.opcode != "phi" or flow.defined[counter.result or ""][0] != loop.header:
        return None
    following = arms_of(counter)
    stepped = flow.instruction(following.get(loop.latch, ""))
    entering = flow.entering(loop)
    if stepped is None or stepped.opcode != "add" or stepped.operands[0] != counter.result:
        return None
    if len(arms) != 2 or not is_number(stepped.operands[-1]):
        return None
    step = int(stepped.operands[-1])
    (base, first), (other, start) = (_sum(flow, each[entering]) for each in (arms, following))
    if base != other or first != start - step:
        return None
    text = f"add nsw i32 {counter.result}, {-step}"
    return Instruction(phi.result, "add", text, (counter.result or "", str(-step)), stepped.line)


def _sum(flow: ControlFlow, value: str) -> tuple[str, int]:
    """Return a value as the sum of another one, or of nothing, and a number."""
    each = flow.instruction(value)
    if is_number(value):
        return "", int(value)
    if each is not None and each.opcode == "add" and is_number(each.operands[-1]):
        return each.operands[0], int(each.operands[-1])
    return value, 0


def _with(block: BasicBlock, found: dict[str | None, Instruction]) -> BasicBlock:
    phis = [each for each in block.instructions if each.opcode == "phi" and each.result not in found]
    made = [
        found[each.result] for each in block.instructions if each.opcode == "phi" and each.result in found
    ]
    others = [each for each in block.instructions if each.opcode != "phi"]
    return replace(block, instructions=(*phis, *made, *others)) if made else block
