"""Bytes and half-words that are masked, or combined bitwise, before they are extended.

C computes with words, but GCC does such an operation before the extension ["(bitop (convert @0) (convert? @1))" in
match.pd of GCC 12; for masks, with numbers that fit]. If nothing uses a word, but a test uses some of the bits, only
the test extends: GCC does not know what a mask in a register leaves of a byte. So the mask is done even if a single bit
is tested later, and the result is extended if several are.
"""

from __future__ import annotations

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import BYTE, WORD

BITWISE = ("and", "or", "xor")
SHIFTS = ("lshr", "ashr", "shl")
EXTENDING = (0xFF, 0xFFFF)
"""Masks that are themselves an extension, whatever is loaded."""
SIGN = 1 << (BYTE - 1)
"""The highest bit of a byte: its test is a comparison with 0."""


def is_joined_before(flow: ControlFlow, extension: Instruction) -> bool:
    """Whether the extended value is a mask of a load, which is itself no extension, or combined bitwise from loaded values."""
    each = flow.instruction(extension.operands[0])
    if each is not None and each.opcode in ("add", "sub", "mul") and is_number(each.operands[1]):
        each = flow.instruction(each.operands[0])  # LLVM computes with bytes what fits
    users = flow.users.get(extension.result or "", [])
    if each is None or (users and all(_is_mask(user) for user in users)):
        return False  # what is masked again is extended before both
    if each.opcode == "and" and is_number(each.operands[1]):
        return int(each.operands[1]) not in EXTENDING and _is_loaded(flow, each.operands[0])
    return each.opcode in BITWISE and all(_is_loaded(flow, operand) for operand in each.operands)


def is_masked_for_test(flow: ControlFlow, each: Instruction) -> bool:
    """Whether an instruction is a mask of a loaded value, and only tests use some of its bits."""
    if each.opcode != "and" or each.bits >= WORD or not is_number(each.operands[1]):
        return False
    mask, source = int(each.operands[1]), flow.instruction(each.operands[0])
    while source is not None and source.opcode in (*SHIFTS, *BITWISE):
        source = flow.instruction(source.operands[0])
    if source is None or source.opcode != "load" or mask in EXTENDING:
        return False
    is_sign = each.bits == BYTE and mask % (2 * SIGN) == SIGN
    wanted = [*flow.users[each.result or ""], *flow.users[source.result or ""]]
    return not is_sign and not any(user.opcode in ("zext", "sext") for user in wanted)


def _is_mask(user: Instruction) -> bool:
    return user.opcode in BITWISE and is_number(user.operands[1])


def _is_loaded(flow: ControlFlow, value: str) -> bool:
    """Whether a narrow value is loaded, or combined bitwise from loaded ones."""
    each = flow.instruction(value)
    if each is None or each.opcode == "load":
        return each is not None
    return each.opcode in BITWISE and all(_is_loaded(flow, operand) for operand in each.operands)
