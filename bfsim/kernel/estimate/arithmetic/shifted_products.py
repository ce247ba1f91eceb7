"""Products that are shifted left: LLVM multiplies by a larger number instead, besides the product itself.

`k = x * C; (k << 15) | (k >> 17)` is one product in C, and two in LLVM.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.estimate.arithmetic.multiples import multiple
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, is_number, written
from bfsim.kernel.ir.widths import WORD


def with_shifted_products(routine: Routine) -> Routine:
    """Return `routine` with such products as shifts again."""
    flow = ControlFlow(routine)
    blocks = [
        replace(
            block,
            instructions=tuple(_shift(flow, block.label, each) or each for each in block.instructions),
        )
        for block in routine.blocks
    ]
    return replace(routine, blocks=tuple(blocks))


def _shift(flow: ControlFlow, label: str, each: Instruction) -> Instruction | None:
    """Return a product as a shift of an earlier one."""
    if not _is_product(each):
        return None
    value, factor = each.operands[:2]
    for other in flow.users[value]:
        if other is each or not _is_product(other) or other.operands[0] != value:
            continue
        if not flow.runs_before(other, label, each):
            continue
        for bits in range(1, WORD):
            if (int(other.operands[1]) << bits) % (1 << WORD) == int(factor) % (1 << WORD):
                text = f"shl i{WORD} {other.result}, {bits}"
                return written(each.result or "", text, (other.result or "", str(bits)), each)
    return None


def _is_product(each: Instruction) -> bool:
    """Whether it multiplies by a number, with an instruction that multiplies."""
    is_word = each.opcode == "mul" and each.bits == WORD and is_number(each.operands[1])
    return is_word and multiple(int(each.operands[1])) is None
