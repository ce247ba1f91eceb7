"""Choices that are stored as narrow: of `x if test else y` C converts both sides before it chooses.

So other values are chosen than are tested, and the choice may be no minimum or maximum for a compiler.
"""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import WORD

CHOSEN = "chosen"
"""Beginning of the label of a block behind the two sides of a conditional expression, and of the name of its value (`emitting/values.py`)."""
SUNK = ".value"
"""End of the name of what several ways store."""
NARROWED = ("add", "sub", "mul", "and", "or", "xor")


def stored_bits(flow: ControlFlow, phi: Instruction) -> int:
    """Return how many bits of a choice are wanted, if all that is done with it is to store them; else those of a word."""
    users = flow.users.get(phi.result or "", [])
    while len(users) == 1 and (users[0].opcode == "trunc" or _is_stored_behind(users[0])):
        users = flow.users.get(users[0].result or "", [])
    return users[0].bits if len(users) == 1 and users[0].opcode == "store" else WORD


def _is_stored_behind(user: Instruction) -> bool:
    """Whether a value is chosen to be stored where several ways that store to one place meet (`memory/sunk_stores.py`)."""
    name = user.result or ""
    return user.opcode == "phi" and name.startswith(f"%{CHOSEN}.") and name.endswith(SUNK)


def is_narrowed(flow: ControlFlow, phi: Instruction) -> bool:
    """Whether a choice is such a one."""
    home, _ = flow.defined[phi.result or ""]
    return home.startswith(CHOSEN) and stored_bits(flow, phi) < WORD


def is_narrowed_behind(flow: ControlFlow, phi: Instruction, yes: str, no: str) -> bool:
    """Whether the conversion of both sides is done behind the choice again [factor_out_conditional_conversion in tree-ssa-phiopt.cc].

    So it is of a number and a value, unless that is computed as narrow from the start, and of two values of the one narrow type.
    """
    values = [flow.instruction(each) for each in (yes, no) if not is_number(each)]
    if len(phi.operands) != 2 or not values:
        return False
    if len(values) == 2:
        return is_of_one_type(flow, (yes, no), stored_bits(flow, phi))
    return values[0] is None or not is_computed_narrow(flow, values[0], stored_bits(flow, phi))


def is_of_one_type(flow: ControlFlow, values: Sequence[str], bits: int) -> bool:
    """Whether values are made of narrow ones that have so many bits, all with a sign or all without."""
    made = [flow.instruction(each) for each in values]
    kinds = {(each.opcode, each.bits) if each and is_extended(each) else ("", 0) for each in made}
    return kinds in ({("sext", bits)}, {("zext", bits)})


def is_extended(each: Instruction) -> bool:
    """Whether an instruction makes a word of a narrow value."""
    return each.opcode in ("sext", "zext")


def is_computed_narrow(flow: ControlFlow, value: Instruction, bits: int) -> bool:
    """Whether `value` may be computed in so many bits, which what it is made of has [match.pd]."""
    made_of = [flow.instruction(each) for each in value.operands if not is_number(each)]
    narrow = (each is not None and is_extended(each) and f" i{bits} " in each.text for each in made_of)
    return value.opcode in NARROWED and all(narrow)
