"""Expressions of which only the low bits are stored: their operands are narrow [convert_to_integer_1 in convert.cc of GCC 12]."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from bfsim.kernel.estimate.arithmetic.narrow_factors import NARROW
from bfsim.kernel.ir.text import OF_VARIABLE, Instruction

CUT = {"add", "sub", "mul", "and", "or", "xor", "shl"}
"""Operations of whose operands only the low bits are needed for those of the result."""
Users = Callable[[str], Sequence[Instruction]]
"""Returns what uses a value."""


def is_cut_tree(users_of: Users, each: Instruction) -> bool:
    """Whether an operation is part of such an expression, which is written on one line."""
    users = users_of(each.result or "") if each.opcode in CUT and not _is_of_variable(each) else ()
    return bool(users) and all(_is_cut(users_of, each, user) for user in users)


def _is_cut(users_of: Users, operand: Instruction, each: Instruction) -> bool:
    """Whether a use of a result takes its low bits, and stores what comes of them."""
    if each.opcode == "trunc":
        return not _is_of_variable(each) and all(
            _is_cut(users_of, operand, user) for user in users_of(each.result or "")
        )
    if each.opcode == "store":
        return each.bits in NARROW
    if each.opcode == "phi" and each.bits in NARROW:
        return all(user.opcode == "store" for user in users_of(each.result or ""))
    return each.line == operand.line and is_cut_tree(users_of, each)


def _is_of_variable(each: Instruction) -> bool:
    return OF_VARIABLE in (each.result or "")
