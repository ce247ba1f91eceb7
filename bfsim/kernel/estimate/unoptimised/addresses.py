"""The offset of an array element at -O0: the index converted to an unsigned number, which is a copy, and scaled."""

from __future__ import annotations

from bfsim.kernel.estimate.unoptimised.computing import Computing
from bfsim.kernel.estimate.unoptimised.expressions import Expr, const, simplified
from bfsim.kernel.estimate.unoptimised.registers import MODIFIERS
from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.operations import ADD_IMMEDIATE, Op

BYTE_MASKS = (0xFF, 0xFFFF)


def offset_of(code: Computing, index: Expr, size: int) -> bool:
    """Compute `index * size`; return whether it is in a pointer register.

    Factors of the index merge with the size, and a number added to the index is then added to the product.
    """
    added = 0
    if index.op == "+" and index.args[1].is_const:
        index, added = index.args[0], index.args[1].value
    times = _factor(index)
    if size > 1 and times > 1:
        index, added, size = simplified("*", index.args[0], const(times * size)), added * size, 1
    pointer = _converted(code, index, to_pointer=size == 1 and not added)
    if added < 0 and size > 1:
        added += (1 << WORD) // size  # GCC reduces it modulo what the scaling shifts out
    if added:
        to_pointer = size == 1 and (added in MODIFIERS or added not in ADD_IMMEDIATE)
        pointer = code.add_number(added, pointer=pointer, to_pointer=to_pointer)
    if size > 1:
        code.move(int(pointer))
        code.op(Op.SHIFT)
        return False
    return pointer


def _converted(code: Computing, index: Expr, *, to_pointer: bool) -> bool:
    """Convert an index: a copy of a computed value, none of one that was just loaded or extended."""
    if index.op in ("local", "load", "widen", "register") or index.unsigned:
        return code.value(index)
    if index.op == "&" and index.args[1].is_const and index.args[1].value >= 0:
        return _converted_mask(code, index)
    pointer = code.value(index, adds=not index.is_call)
    code.move(int(to_pointer and not pointer))
    return to_pointer or pointer


def _converted_mask(code: Computing, index: Expr) -> bool:
    """Conversions pass through masks."""
    inner, mask = index.args
    if mask.value in BYTE_MASKS or inner.is_leaf or inner.unsigned:
        return code.value(index)
    code.value(inner)
    code.move()
    code.value(mask)
    code.op(Op.ALU)
    return False


def _factor(index: Expr) -> int:
    """The constant factor of a product or shift, or 1."""
    if index.op == "<<" and index.args[1].is_const:
        return 1 << index.args[1].value
    if index.op == "*" and index.args[1].is_const:
        return max(1, index.args[1].value)
    return 1
