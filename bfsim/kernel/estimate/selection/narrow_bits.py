"""Bytes and half-words of which a test wants some bits, and nothing wants a word.

C computes with words, but GCC does the mask before the extension ["(bitop (convert @0) (convert? @1))" in match.pd of GCC 12]. What a mask in
a register leaves of a byte it does not know: so the mask is done also where a single bit is tested then, and the result is extended where
several are.
"""

from __future__ import annotations

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import BYTE, WORD

EXTENDING = (0xFF, 0xFFFF)  # masks that are one instruction, whatever is loaded
SIGN = 1 << (BYTE - 1)
"""A byte whose highest bit is wanted is compared with 0."""


def is_masked(flow: ControlFlow, each: Instruction) -> bool:
    """Whether an instruction is such a mask of what is loaded."""
    if each.opcode != "and" or each.bits >= WORD or not is_number(each.operands[1]):
        return False
    mask, source = int(each.operands[1]), flow.instruction(each.operands[0])
    while source is not None and source.opcode in ("lshr", "ashr", "shl", "and", "or", "xor"):
        source = flow.instruction(source.operands[0])
    if source is None or source.opcode != "load" or mask in EXTENDING:
        return False
    is_sign = each.bits == BYTE and mask % (2 * SIGN) == SIGN
    wanted = [*flow.users[each.result or ""], *flow.users[source.result or ""]]
    return not is_sign and not any(user.opcode in ("zext", "sext") for user in wanted)
