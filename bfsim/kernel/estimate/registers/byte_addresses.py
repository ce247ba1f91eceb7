"""Addresses of bytes that are added in data registers, if the array comes in one and has no other use [find_costs_and_classes in ira-costs.cc of GCC 12].

Moving the array to a pointer register would cost one move more: for each element, either the sum or the index is moved.
But a sum that several accesses use would be moved for each of them, as GCC counts. And an index that is as good in a
pointer register draws the array there if another operation uses it, too, or if other elements of the array are wanted.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel import operations
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction, RegisterBank
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

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
        by_classes = context.profile.applies(Rule.ADDRESS_CLASSES)
        if by_classes and not _is_cheaper(code, array, [each for _, each in users]):
            continue
        if users and alone and array not in chosen:
            for label in dict(users):
                code.of[label] = [row for each in code.of[label] for row in _added(each, array)]


def _is_sum(each: MachineInstruction) -> bool:
    return each.op is Op.ALU and each.bank is POINTER and len(each.uses) == 2 and each.result is not None


def _is_cheaper(code: MachineCode, array: str, sums: list[MachineInstruction]) -> bool:
    """Whether each sum with an array serves one access, and its index is in a data register or is there for the sum alone."""
    rows = [each for block in code.of.values() for each in block]
    for total in sums:
        index = next((name for name, _ in total.uses if name != array), array)
        others = [each for each in rows if each is not total and _takes(each, index)]
        if len([each for each in rows if _takes(each, total.result or "")]) > 1:
            return False
        if (others or len(sums) > 1) and not any(_wants_data(each, index) for each in rows):
            return False
    return True


def _takes(each: MachineInstruction, name: str) -> bool:
    return name in (used for used, _ in each.uses)


def _wants_data(each: MachineInstruction, name: str) -> bool:
    """Whether an operation computes a value, or computes with it, in data registers only."""
    made = each.result == name and each.bank is DATA
    return each.access is None and (made or (name, DATA) in each.uses)


def _added(each: MachineInstruction, array: str) -> list[MachineInstruction]:
    """An operation, or the sum that replaces it and its move to a pointer register."""
    if not _takes(each, array):
        return [each]
    total = f"{each.result}.sum"
    move = MachineInstruction(Op.MOVE, each.line, each.result, POINTER, ((total, DATA),))
    return [replace(each, result=total, bank=DATA, uses=tuple((name, DATA) for name, _ in each.uses)), move]
