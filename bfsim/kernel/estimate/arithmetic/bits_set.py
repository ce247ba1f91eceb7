"""The bits of a word, counted in parallel: ONES on the Blackfin ["branchless implementations of popcount" in match.pd of GCC 12; popcountsi2 in bfin.md].

`x -= x >> 1 & 0x55555555; x = (x & 0x33333333) + (x >> 2 & 0x33333333); (x + (x >> 4) & 0x0F0F0F0F) * 0x01010101 >> 24`
"""

from __future__ import annotations

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction

PAIRS, FOURS, BYTES, ONES = 0x55555555, 0x33333333, 0x0F0F0F0F, 0x01010101
STATEMENTS = 12
"""So many operations are one."""


def counted_word(flow: ControlFlow, each: Instruction) -> str | None:
    """Return the word whose bits an instruction has counted, or None."""
    product = _with(flow, each.result or "", "lshr", 24)
    fours = _with(flow, _with(flow, product, "mul", ONES), "and", BYTES)
    whole, high = _operands(flow, fours, "add")
    for sums, shifted in ((whole, high), (high, whole)):
        if sums and _with(flow, shifted, "lshr", 4) == sums:
            return _of_fours(flow, sums)
    return None


def _of_fours(flow: ControlFlow, sums: str) -> str | None:
    """The word whose bits are added up by fours."""
    one, other = (_with(flow, half, "and", FOURS) for half in _operands(flow, sums, "add"))
    for pairs, shifted in ((one, other), (other, one)):
        if pairs and _with(flow, shifted, "lshr", 2) == pairs:
            word, half = _operands(flow, pairs, "sub")
            if word and _with(flow, _with(flow, half, "and", PAIRS), "lshr", 1) == word:
                return word
    return None


def _with(flow: ControlFlow, value: str, opcode: str, number: int) -> str:
    """The first operand of the instruction that computes `value`, if it is one with this constant; else nothing."""
    left, right = _operands(flow, value, opcode)
    return left if right == str(number) else ""


def _operands(flow: ControlFlow, value: str, opcode: str) -> tuple[str, str]:
    found = flow.instruction(value)
    if found is None or found.opcode != opcode:
        return "", ""
    return found.operands[0], found.operands[1]
