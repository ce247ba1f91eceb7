"""Values that a loop computes and that are the same in all iterations, because all their operands are."""

from __future__ import annotations

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction

COMPUTED = ("add", "sub", "mul", "and", "or", "xor", "shl", "lshr", "ashr", "select", "call", "getelementptr")


def is_same(flow: ControlFlow, loop: Loop, each: Instruction) -> bool:
    """Whether an instruction computes the same in all iterations of a loop, without a load, division or call."""
    made_of = (flow.instruction(operand) for operand in each.operands if not flow.is_invariant(operand, loop))
    computes = each.opcode in COMPUTED and not each.is_call
    return computes and all(made is not None and is_same(flow, loop, made) for made in made_of)
