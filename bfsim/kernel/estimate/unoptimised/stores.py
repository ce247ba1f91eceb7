"""Assignments at -O0. A value that is stored in few bits is computed in few bits [convert_to_integer_1 of convert.cc].

In an assignment to an array, the last operation comes after the address of the element.
"""

from __future__ import annotations

from bfsim.kernel.estimate.unoptimised.computing import Computing
from bfsim.kernel.estimate.unoptimised.expressions import BITWISE, Expr, TreeStatement
from bfsim.kernel.ir.widths import PAIR
from bfsim.kernel.operations import ADD_IMMEDIATE, Op

STORES = {1: Op.STORE8, 8: Op.STORE8, 16: Op.STORE16, 32: Op.STORE32}
FOLDED = ("+", "-", "*", "<<", "neg", "inverse")  # the low bits of these depend only on low bits


def assign(code: Computing, each: TreeStatement) -> None:
    """Compute and store."""
    code.line = each.line
    target = each.target
    if target is None or target.op == "register":
        code.value(each.value)
    elif target.op == "local":
        code.value(each.value, outermost=True)
        code.op(*((Op.STORE32, Op.STORE32) if target.bits == PAIR else (STORES[target.bits],)))
    elif each.value.op == "narrow":
        _store_low_bits(code, each.value.args[0], target)
    else:
        if each.value.calls and not target.args[0].is_const:
            code.saved.add("P5")
        code.address(target)
        code.value(each.value, outermost=True)
        code.op(STORES[target.bits])
        code.makes(target)


def _store_low_bits(code: Computing, value: Expr, target: Expr) -> None:
    """Store in an array of bytes or halves. Only unsigned types wrap, so a sum for a signed one is converted again."""
    value = _stripped(value, target.bits)
    pointer = low_bits_of(code, value, target, late=target.unsigned)
    code.move(_moves_after(value, target) + int(pointer and target.unsigned))
    if value.calls and target.args[0].calls:
        code.saved.add("R7")
    code.address(target)
    code.op(STORES[target.bits])
    code.makes(target)


def low_bits_of(code: Computing, value: Expr, target: Expr, *, late: bool) -> bool:
    """Compute as many bits of `value` as `target` has; return whether the result is in a pointer register.

    The operands are converted, each by a copy. `late`: the operation comes after the address of an element, and its
    operands wait.
    """
    value = _stripped(value, target.bits)
    if value.op == "-" and value.args[0].is_const and (value.args[0].value + 1) % (1 << target.bits) == 0:
        value = Expr("inverse", value.args[1:])
    if _is_shifted_element(value, target):
        code.value(value.args[0])
        code.op(Op.SHIFT)
        return False
    if value.op == "*" and value.args[1].is_const:
        pointer = code.value(value, adds=True)
        code.move(int(pointer))
        return pointer
    parts = [_stripped(each, target.bits) for each in value.args]
    if value.op not in (*FOLDED, *BITWISE) or all(each.is_const for each in parts):
        return code.value(value)
    last = parts[-1]
    sums = value.op == "+" and not last.is_const
    pointers = []
    for part in parts:
        if part.op in (*FOLDED, *BITWISE):
            pointers.append(low_bits_of(code, part, target, late=False))
        elif not part.is_const:
            pointer = code.value(part)
            as_is = part.op == "load" and part.bits == target.bits and target.unsigned
            converted = not as_is and part.op != "widen"
            waits = (late and value.op not in BITWISE) or not (part is last or last.is_const)
            changed_later = late and part.op == "local" and value.is_in_place
            code.move(int(converted and (sums or waits)) + int(changed_later))
            pointers.append(pointer or (converted and sums))
        elif part is not last:
            code.value(part)
    return _operation(code, value, pointers)


def _operation(code: Computing, value: Expr, pointers: list[bool]) -> bool:
    last = value.args[-1]
    if value.op == "+" and not last.is_const:
        return code.add(pointers, to_pointer=True)
    if value.op == "+" and last.value not in ADD_IMMEDIATE:
        return code.add_number(last.value, pointer=pointers[0], to_pointer=True)
    if value.op in BITWISE and last.is_const and (value.op == "&" or last.value.bit_count() != 1):
        code.value(last)
    code.op({"<<": Op.SHIFT, "*": Op.MUL16}.get(value.op, Op.ALU))
    return False


def _stripped(value: Expr, bits: int) -> Expr:
    """Leave out operations that do not change the low bits: extensions, masks."""
    while True:
        if value.op == "widen" and value.bits >= bits:
            value = value.args[0].args[0] if value.args[0].op == "narrow" else value.args[0]
        elif value.op == "&" and value.args[1].is_const and (value.args[1].value + 1) % (1 << bits) == 0:
            value = value.args[0]
        else:
            return value


def _is_shifted_element(value: Expr, target: Expr) -> bool:
    """Whether a value is an element like the target, shifted right: no bits need to be cut off."""
    return value.op == ">>" and value.args[1].is_const and value.args[0].is_loaded_narrow and (
        value.args[0].bits == target.bits
    )  # fmt: skip


def _moves_after(value: Expr, target: Expr) -> int:
    """Moves between a narrow value and its store: for waiting until the address is computed, and then for a conversion."""
    if value.op in ("const", "local", "register", "widen") or _is_shifted_element(value, target):
        return 0
    if value.op == "load":
        return int(value.bits != target.bits)
    if value.op in FOLDED:
        return 0 if target.unsigned else 1 + (value.op != "neg")
    if value.op in BITWISE:
        parts = [_stripped(each, target.bits) for each in value.args]
        as_stored = parts[1].is_const or all(part.op == "load" for part in parts)
        return 0 if as_stored or not target.unsigned else 2
    return 2 if value.is_call else 1
