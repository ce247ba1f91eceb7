"""Constants that are no immediates of the operation that uses them."""

from __future__ import annotations

from bfsim.kernel import operations
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.ir.text import SourceLine
from bfsim.kernel.operations import Op

BOUND = ".bound"
"""Ends the name of a number that is loaded for a comparison."""


def load_constant(
    constant: str, line: SourceLine, result: str | None = None, bank: RegisterBank = RegisterBank.ANY
) -> MachineInstruction:
    """Return the operation that loads a constant, written #5."""
    digits = constant[1:].lstrip("-")
    number = int(constant[1:]) if digits.isdigit() else 0
    if number in operations.SHORT_IMMEDIATE:
        return MachineInstruction(Op.IMM, line, result, bank)
    if number in operations.LONG_IMMEDIATE:
        return MachineInstruction(Op.IMM, line, result, bank, nbytes=operations.LONG_FORM_BYTES)
    return MachineInstruction(Op.IMM32, line, result, bank)
