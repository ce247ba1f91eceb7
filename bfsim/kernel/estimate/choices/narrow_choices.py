"""Choices that are stored as narrow: in `x if test else y`, C converts both sides before it chooses.

So the chosen values are not those that are tested, and a compiler may see no minimum or maximum.
"""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import WORD

CHOSEN = "chosen"
"""Begins the label of the block after the two sides of a conditional expression, and the name of its value (`emitting/values.py`)."""
SUNK = ".value"
"""Ends the name of a value that several paths store."""
NARROWED = ("add", "sub", "mul", "and", "or", "xor")


def stored_bits(flow: ControlFlow, phi: Instruction) -> int:
    """Return how many bits of a choice are wanted if it is only stored; else those of a word."""
    users = flow.users.get(phi.result or "", [])
    while len(users) == 1 and (users[0].opcode == "trunc" or _is_stored_behind(users[0])):
        users = flow.users.get(users[0].result or "", [])
    return users[0].bits if len(users) == 1 and users[0].opcode == "store" else WORD


def _is_stored_behind(user: Instruction) -> bool:
    """Whether a value is chosen where several paths that store to one place join (`memory/sunk_stores.py`)."""
    name = user.result or ""
    return user.opcode == "phi" and name.startswith(f"%{CHOSEN}.") and name.endswith(SUNK)


def is_narrowed(flow: ControlFlow, phi: Instruction) -> bool:
    """Whether a choice is such a one."""
    home, _ = flow.defined[phi.result or ""]
    return home.startswith(CHOSEN) and stored_bits(flow, phi) < WORD


def is_narrowed_behind(flow: ControlFlow, phi: Instruction, yes: str, no: str) -> bool:
    """Whether the conversion of both sides moves after the choice again [factor_out_conditional_conversion in tree-ssa-phiopt.cc].

    It does for a number and a value, unless that is computed as narrow from the start, and for two values of the same
    narrow type.
    """
    values = [flow.instruction(each) for each in (yes, no) if not is_number(each)]
    if len(phi.operands) != 2 or not values:
        return False
    if len(values) == 2:
        return is_of_one_type(flow, (yes, no), stored_bits(flow, phi))
    return values[0] is None or not is_computed_narrow(flow, values[0], stored_bits(flow, phi))


def is_of_one_type(flow: ControlFlow, values: Sequence[str], bits: int) -> bool:
    """Whether values are made from narrow ones of this many bits, all signed or all unsigned."""
    made = [flow.instruction(each) for each in values]
    kinds = {(each.opcode, each.bits) if each and is_extended(each) else ("", 0) for each in made}
    return kinds in ({("sext", bits)}, {("zext", bits)})


def is_extended(each: Instruction) -> bool:
    """Whether an instruction makes a word of a narrow value."""
    return each.opcode in ("sext", "zext")


def is_computed_narrow(flow: ControlFlow, value: Instruction, bits: int) -> bool:
    """Whether `value` may be computed in this many bits, which its operands have [match.pd]."""
    made_of = [flow.instruction(each) for each in value.operands if not is_number(each)]
    narrow = (each is not None and is_extended(each) and f" i{bits} " in each.text for each in made_of)
    return value.opcode in NARROWED and all(narrow)
