"""Intrinsics at -O0: functions that are always inlined, whose parameters and results go through memory all the same.

[GCC] seen in what GCC 12.2 makes of `intrinsics.h`; all functions there have one form.
"""

from __future__ import annotations

from bfsim.kernel.estimate.unoptimised.computing import Computing
from bfsim.kernel.estimate.unoptimised.expressions import Expr
from bfsim.kernel.intrinsics import BY_NAME
from bfsim.kernel.operations import Op
from bfsim.kernel.types import PAIR

THROUGH_MEMORY = (Op.STORE32, Op.LOAD32)
TO_LONG_LONG = (
    *(2 * THROUGH_MEMORY),
    *(Op.STORE32, Op.IMM, Op.STORE32, Op.LOAD32, Op.SHIFT),  # the upper word, shifted to its place
    *(Op.IMM, Op.LOAD32, Op.MOVE, Op.IMM, Op.ALU, Op.ALU),  # the lower word, widened, and both joined
)
UPPER_WORD = (Op.LOAD32, Op.SHIFT, Op.STORE32, Op.IMM, *THROUGH_MEMORY)


def intrinsic(code: Computing, each: Expr) -> None:
    """Compute the operands, then pass them and the result through memory."""
    found = BY_NAME[each.name]
    for value in each.args:
        code.value(value)
    for _ in each.args:
        code.op(*THROUGH_MEMORY)
    code.op(*found.ops)
    code.op(*(TO_LONG_LONG if found.gives is PAIR else THROUGH_MEMORY))


def word(code: Computing, each: Expr) -> None:
    """Take one of two words."""
    code.op(*(UPPER_WORD if each.name == "upper" else (Op.LOAD32,)))
