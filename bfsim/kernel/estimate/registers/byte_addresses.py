"""Addresses of bytes that are added in data registers, if the array comes in one and has no other use [find_costs_and_classes in ira-costs.cc of GCC 12].

Moving the array to a pointer register would cost one move more: for each element, either the sum or the index is moved.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel import operations
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction, RegisterBank
from bfsim.kernel.operations import Op

DATA, POINTER = RegisterBank.DATA, RegisterBank.POINTER


def add_in_data_registers(context: Context, code: MachineCode) -> None:
    """Add such addresses in data registers, outside loops."""
    chosen = context.operands_of("phi")
    for array in context.parameters()[: operations.REGISTER_ARGUMENTS]:
        users = [
            (label, each)
            for label, block in code.of.items()
            for each in block
            if array in (name for name, _ in each.uses)
        ]
        alone = all(_is_sum(each) and context.flow.innermost(label) is None for label, each in users)
        if users and alone and array not in chosen:
            for label in dict(users):
                code.of[label] = [row for each in code.of[label] for row in _added(each, array)]


def _is_sum(each: MachineInstruction) -> bool:
    return each.op is Op.ALU and each.bank is POINTER and len(each.uses) == 2 and each.result is not None


def _added(each: MachineInstruction, array: str) -> list[MachineInstruction]:
    """An operation, or the sum that replaces it and its move to a pointer register."""
    if array not in (name for name, _ in each.uses):
        return [each]
    total = f"{each.result}.sum"
    move = MachineInstruction(Op.MOVE, each.line, each.result, POINTER, ((total, DATA),))
    return [replace(each, result=total, bank=DATA, uses=tuple((name, DATA) for name, _ in each.uses)), move]
