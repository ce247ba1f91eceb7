"""Which values must be in their bank of registers, and which may be in either [find_costs_and_classes in ira-costs.cc of GCC 12]."""

from __future__ import annotations

from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.operations import Op

IN_EITHER = {Op.ALU, Op.COMPARE, Op.COND_MOVE, Op.MOVE, Op.IMM, Op.IMM32, Op.LOAD32, Op.STORE32}
"""Operations that exist for both banks, and with a number or for a copy even between them."""


def tied_webs(webs: Webs) -> frozenset[str]:
    """Return the webs that must be in their bank, or would need a move in the other one; arguments among them."""
    tied = set(webs.context.parameters())
    for block in webs.code.of.values():
        for each in block:
            if each.op is Op.MOVE and each.bank is not RegisterBank.ANY:
                tied.add(each.result or "")  # a copied value may come from either
            elif not _is_free(each):
                tied |= {*(name for name, _ in each.uses), each.result or ""}
    return frozenset(map(webs.find, tied))


def _is_free(instruction: MachineInstruction) -> bool:
    """Whether no operand must be in a certain bank, or in the bank of another one."""
    banks = [bank for _, bank in instruction.uses] + [instruction.bank] * bool(instruction.result)
    if instruction.op not in IN_EITHER or any(bank is not RegisterBank.ANY for bank in banks):
        return False
    names = [name for name, _ in instruction.uses if not name.startswith("#")]
    return instruction.op not in (Op.ALU, Op.COMPARE) or len(names) < 2
