"""x - x / y * y of unsigned numbers is the remainder [match.pd of GCC 12].

Nothing else is left to do of it: LLVM would write products with other constants, of which no remainder can be seen any more.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir_text import Instruction, Routine, written
from bfsim.kernel.loops import ControlFlow


def with_remainders(routine: Routine) -> Routine:
    """Return `routine` with them, while its variables are registers and nothing else was done."""
    flow = ControlFlow(routine)
    blocks = [
        replace(block, instructions=tuple(_remainder(flow, each) or each for each in block.instructions))
        for block in routine.blocks
    ]
    return replace(routine, blocks=tuple(blocks))


def _remainder(flow: ControlFlow, each: Instruction) -> Instruction | None:
    product = flow.instruction(each.operands[1]) if each.opcode == "sub" else None
    if product is None or product.opcode != "mul":
        return None
    for quotient, divisor in (product.operands[:2], product.operands[1::-1]):
        division = flow.instruction(quotient)
        if (
            division is not None
            and division.opcode == "udiv"
            and division.operands[:2] == (each.operands[0], divisor)
        ):
            text = f"urem i{each.bits} {each.operands[0]}, {divisor}"
            return written(each.result or "", text, division.operands[:2], each)
    return None
