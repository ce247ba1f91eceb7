"""How many low bits of a value may be set: converting one that keeps them all is free [tree-ssa-ccp.cc, tree-vrp.cc of GCC 12]."""

from __future__ import annotations

from bfsim.kernel.ir.control_flow import ControlFlow

BYTE, WORD, PAIR = 8, 32, 64
"""Bits. A pair is the result of an intrinsic with two results; only its words are used."""
DEEPEST = 6  # how many operations it looks through; each may have several operands


def widest(flow: ControlFlow, value: str, seen: frozenset[str] = frozenset()) -> int:
    """Return the number of low bits above which `value` has none set; 32 if that is not known."""
    if value.isdigit():
        return int(value).bit_length()
    each = flow.instruction(value)
    if each is None or len(seen) == DEEPEST:
        return WORD
    if value in seen:
        return 0  # round a loop: the values from outside it decide
    widths = [widest(flow, operand, seen | {value}) for operand in each.operands[:2]]
    match each.opcode:
        case "load" | "zext":
            return each.bits
        case "and":
            return min(widths)
        case "or" | "xor":
            return max(widths)
        case "phi":
            return max(widest(flow, operand, seen | {value}) for operand in each.operands)
        case "lshr" if each.operands[1].isdigit():
            return max(0, widths[0] - int(each.operands[1]))
    return WORD
