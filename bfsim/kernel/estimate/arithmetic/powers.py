"""Division of a signed number by a power of two, rounded towards zero: GCC 12 makes no call for it [expand_divmod in expmed.cc].

`//` and `%` round down, which takes only a shift or a mask.
"""

from __future__ import annotations

from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.operations import Op

HALF = (Op.SHIFT, Op.ALU, Op.SHIFT)  # R1 = R0 >> 31; R0 = R0 + R1; R0 >>>= 1
MASKED = (Op.IMM, Op.ALU, Op.ALU, Op.COMPARE)  # R1 = 2**n - 1; BITSET(R1, 31); R0 = R0 & R1; CC = R0 < 0


def by_power(opcode: str, divisor: int, branch: Op) -> tuple[Op, ...] | None:
    """Return the operations of `opcode`, sdiv or srem, by a constant; None if it is no power of two beyond 1.

    They are for a dividend of 0 or more: `branch` skips the correction of a negative one, or it stands after the
    routine. A negative dividend takes up to 12 cycles more.
    """
    size = abs(divisor)
    if size < 2 or size.bit_count() != 1:
        return None
    if opcode == "srem":
        return (*MASKED, branch)
    negated = (Op.ALU,) if divisor < 0 else ()
    return (*HALF, *negated) if size == 2 else (Op.COMPARE, branch, Op.SHIFT, *negated)


def divided_by_power(each: Instruction) -> bool:
    """Whether an instruction divides a signed number by a constant power of two."""
    divisor = each.operands[1] if each.opcode in ("sdiv", "srem") else ""
    return is_number(divisor) and by_power(each.opcode, int(divisor), Op.BRANCH_TAKEN) is not None
