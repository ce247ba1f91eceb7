"""x - x / y * y is the remainder [match.pd of GCC 12].

For unsigned numbers, and if the divisor is written twice, this is done first: LLVM would write products with other
factors, in which no remainder can be seen any more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, written
from bfsim.kernel.ir.value_numbers import ValueNumbers


def with_remainders(routine: Routine) -> Routine:
    """Return `routine` with the remainders that LLVM would hide, while its variables are registers and nothing else was done."""
    flow, numbers = ControlFlow(routine), ValueNumbers()
    for label in flow.order:
        for each in flow.blocks[label].instructions:
            numbers.add(each)
    blocks = [
        replace(
            block, instructions=tuple(_remainder(flow, each, numbers) or each for each in block.instructions)
        )
        for block in routine.blocks
    ]
    return replace(routine, blocks=tuple(blocks))


def _remainder(flow: ControlFlow, each: Instruction, numbers: ValueNumbers) -> Instruction | None:
    division = quotient_of_rest(flow, each, numbers.of)
    if division is None or (division.opcode == "sdiv" and quotient_of_rest(flow, each) is not None):
        return None
    value, divisor = division.operands[:2]
    text = f"{division.opcode[0]}rem i{each.bits} {value}, {divisor}"
    return written(each.result or "", text, (value, divisor), each)


def quotient_of_rest(
    flow: ControlFlow, each: Instruction, number_of: Callable[[str], str] = str
) -> Instruction | None:
    """Return the division x / y of a difference x - x / y * y; None for other instructions.

    `number_of`: returns the same for values that are the same.
    """
    product = flow.instruction(each.operands[1]) if each.opcode == "sub" else None
    if product is None or product.opcode != "mul":
        return None
    for quotient, divisor in (product.operands[:2], product.operands[1::-1]):
        division = flow.instruction(quotient)
        if division is not None and division.opcode in ("sdiv", "udiv"):
            parts = map(number_of, division.operands[:2])
            if [*parts] == [number_of(each.operands[0]), number_of(divisor)]:
                return division
    return None
