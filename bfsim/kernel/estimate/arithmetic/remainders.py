"""x - x / y * y is the remainder [match.pd of GCC 12].

Of unsigned numbers it is made one before anything else is done: LLVM would write products with other constants, of which no remainder can be
seen any more.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, written


def with_remainders(routine: Routine) -> Routine:
    """Return `routine` with those of unsigned numbers, while its variables are registers and nothing else was done."""
    flow = ControlFlow(routine)
    blocks = [
        replace(block, instructions=tuple(_remainder(flow, each) or each for each in block.instructions))
        for block in routine.blocks
    ]
    return replace(routine, blocks=tuple(blocks))


def _remainder(flow: ControlFlow, each: Instruction) -> Instruction | None:
    division = quotient_of_rest(flow, each)
    if division is None or division.opcode != "udiv":
        return None
    value, divisor = division.operands[:2]
    return written(each.result or "", f"urem i{each.bits} {value}, {divisor}", (value, divisor), each)


def quotient_of_rest(flow: ControlFlow, each: Instruction) -> Instruction | None:
    """Return the division x / y of a difference x - x / y * y; None if an instruction is no such difference."""
    product = flow.instruction(each.operands[1]) if each.opcode == "sub" else None
    if product is None or product.opcode != "mul":
        return None
    for quotient, divisor in (product.operands[:2], product.operands[1::-1]):
        division = flow.instruction(quotient)
        is_one = division is not None and division.opcode in ("sdiv", "udiv")
        if is_one and division is not None and division.operands[:2] == (each.operands[0], divisor):
            return division
    return None
