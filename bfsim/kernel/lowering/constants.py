"""Constants that are no immediates of the operation that uses them."""

from __future__ import annotations

from bfsim.kernel import isa
from bfsim.kernel.isa import Op
from bfsim.kernel.lowering.steps import Bank, Step


def load_constant(constant: str, line: int, result: str | None = None, bank: Bank = Bank.ANY) -> Step:
    """Return the operation that loads a constant, written #5."""
    digits = constant[1:].lstrip("-")
    number = int(constant[1:]) if digits.isdigit() else 0
    if number in isa.SHORT_IMMEDIATE:
        return Step(Op.IMM, line, result, bank)
    if number in isa.LONG_IMMEDIATE:
        return Step(Op.IMM, line, result, bank, nbytes=isa.LONG_FORM_BYTES)
    return Step(Op.IMM32, line, result, bank)
