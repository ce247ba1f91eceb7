"""Factors of 16 bits or fewer: what GCC multiplies in one cycle [is_widening_mult_p in tree-ssa-math-opts.cc of GCC 12].

Each factor must be the extension of a narrow value, or a number that fits the type of the other one. Narrow values are
loaded or converted. Bits of one, or bits changed by a number that fits, are narrow, too: that is done before the extension
["(bitop (convert @0) (convert? @1))" in match.pd]. A shift is if it is of an element itself, and not of a variable
[short_shift in c-typeck.cc]. Sums, differences, products and what is shifted left are words, though LLVM computes many of
them with fewer bits.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import BYTE, WORD

BITWISE = ("and", "or", "xor")
EXTENSIONS = ("zext", "sext")
SHIFTS = ("lshr", "ashr")
PLAIN = ("load", "phi", "trunc", "select")
"""What is narrow as it is: loaded, chosen or converted."""
ABSOLUTE = "@llvm.abs."
NARROW = (BYTE, 2 * BYTE)


@dataclass(frozen=True, slots=True)
class NarrowType:
    """A type of C with fewer bits than a word."""

    bits: int
    is_signed: bool

    def holds(self, number: int) -> bool:
        """Whether a number fits."""
        low = -(1 << (self.bits - 1)) if self.is_signed else 0
        return low <= number < low + (1 << self.bits)


def is_narrow_product(flow: ControlFlow, product: Instruction) -> bool:
    """Whether both factors are narrow."""
    left, right = product.operands[:2]
    if is_number(right):
        narrow = narrow_type(flow, left)
        return narrow is not None and narrow.holds(int(right))
    return narrow_type(flow, left) is not None and narrow_type(flow, right) is not None


def narrow_type(flow: ControlFlow, value: str) -> NarrowType | None:
    """The type that GCC extends to have a factor; None if that is a word."""
    each = flow.instruction(value)
    if each is None:
        return None
    if each.opcode in EXTENSIONS and each.bits in NARROW:
        return NarrowType(each.bits, each.opcode == "sext") if _is_narrow(flow, each.operands[0]) else None
    if each.bits in NARROW:
        return NarrowType(each.bits, is_signed=False) if _is_narrow(flow, value) else None
    if each.opcode in BITWISE and is_number(each.operands[1]):
        narrow = narrow_type(flow, each.operands[0])
        if narrow is not None and narrow.holds(int(each.operands[1])):
            return None if narrow.bits == BYTE and _is_difference(each) else narrow
    return None


def is_extended_for_product(flow: ControlFlow, value: str) -> bool:
    """Whether a factor is a byte with bits that a number changed, or that was shifted with its sign: it is extended for the product."""
    each = flow.instruction(value)
    if (
        each is None
        or not each.operands
        or (narrow := narrow_type(flow, value)) is None
        or narrow.bits != BYTE
    ):
        return False
    if each.opcode in BITWISE:
        return each.bits >= WORD
    made = flow.instruction(each.operands[0]) if each.opcode in EXTENSIONS else None
    return made is not None and (
        made.opcode == "ashr" or (made.opcode in ("or", "xor") and is_number(made.operands[1]))
    )


def _is_narrow(flow: ControlFlow, value: str) -> bool:
    """Whether a value that LLVM has as a narrow one is one to GCC."""
    each = flow.instruction(value)
    if each is None or each.opcode in PLAIN or ABSOLUTE in each.text:
        return True
    if each.opcode in SHIFTS:
        shifted = flow.instruction(each.operands[0])
        return shifted is not None and shifted.opcode == "load" and shifted.line == each.line
    others = (operand for operand in each.operands if not is_number(operand))
    is_difference = each.bits == BYTE and _is_difference(each)
    return each.opcode in BITWISE and not is_difference and all(_is_narrow(flow, one) for one in others)


def _is_difference(each: Instruction) -> bool:
    """Whether it inverts all bits of a byte: LLVM makes that of 255 - x."""
    return each.opcode == "xor" and each.operands[1] in ("-1", "255")
