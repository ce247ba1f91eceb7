"""Indices of addresses in the order of the source: in a row, its place is added before the address is; several take one that is scaled once.

C adds an index to a pointer as a whole, times the size of an element [pointer_int_sum in c-common.cc of GCC 12].
"""

from __future__ import annotations

from bfsim.kernel.ir_text import Instruction
from bfsim.kernel.loops import pointee_nbytes
from bfsim.kernel.lowering.context import Context


def continued(context: Context, row: Instruction) -> Instruction | None:
    """Return the address that is computed from this one, a row's, alone and in the same place."""
    users = context.flow.users.get(row.result or "", [])
    if len(users) != 1 or users[0].opcode != "getelementptr":
        return None
    (each,) = users
    is_element = (
        each.operands[0] == row.result
        and each.operands[-1].startswith("%")
        and pointee_nbytes(each) == pointee_nbytes(row)
    )
    walks = id(each) in context.induction_variables.of
    near = _place(context, row) == _place(context, each)
    return each if is_element and near and not walks and context.demanded.emits(each) else None


def row_of(context: Context, each: Instruction) -> Instruction | None:
    """Return the address of a row that this one alone is computed from."""
    row = context.flow.instruction(each.operands[0])
    if row is None or row.opcode != "getelementptr" or not row.operands[-1].startswith("%"):
        return None
    return row if continued(context, row) is each else None


def shared_by(context: Context, each: Instruction) -> list[str]:
    """Return the blocks, but for its own, of the addresses with the same index, in elements of the same size."""
    index, nbytes = each.operands[-1], pointee_nbytes(each)
    return [
        context.flow.defined[user.result or ""][0]
        for user in context.flow.users.get(index, [])
        if user.opcode == "getelementptr"
        and user is not each
        and user.operands[-1] == index
        and pointee_nbytes(user) == nbytes
        and context.demanded.emits(user)
    ]


def _place(context: Context, each: Instruction) -> str:
    label, _ = context.flow.defined[each.result or ""]
    return context.code_motion.of.get(each.result or "", label)
