"""Division in LLVM IR: `//` and `%` round down, as Python does; `quotient` and `remainder` towards zero, as C and the chip do."""

from __future__ import annotations

from llvmlite import ir

I32 = ir.IntType(32)
SIGNED = "signed"  # names divisions: LLVM may make them unsigned, but the run-time library's routine stays the signed one
ROUNDED = "signed.rounded"  # names divisions by `//` and `%`: in C a function of ints, which never divides in fewer bits
FLOOR = "floor"  # names remainders that only round a quotient down


def unsigned(builder: ir.IRBuilder, op: str, left: ir.Value, right: ir.Value) -> ir.Value:
    """Return the quotient or the remainder of two u32, for which all operators round alike."""
    return (builder.udiv if op in ("//", "quotient") else builder.urem)(left, right)


def signed(builder: ir.IRBuilder, op: str, left: ir.Value, right: ir.Value, constant: int | None) -> ir.Value:
    """Return the quotient or the remainder of two i32; `constant` is the divisor if it is one."""
    if op in ("quotient", "remainder"):
        return (builder.sdiv if op == "quotient" else builder.srem)(left, right, name=SIGNED)
    if constant is not None and constant > 0 and constant.bit_count() == 1:
        return _by_power_of_two(builder, op, left, constant)
    return _rounded_down(builder, op, left, right)


def _by_power_of_two(builder: ir.IRBuilder, op: str, left: ir.Value, divisor: int) -> ir.Value:
    """Divide by a shift, which rounds down: no compiler calls the library here."""
    if op == "//":
        return builder.ashr(left, I32(divisor.bit_length() - 1))
    return builder.and_(left, I32(divisor - 1))


def _rounded_down(builder: ir.IRBuilder, op: str, left: ir.Value, right: ir.Value) -> ir.Value:
    """Round down by a correction. LLVM drops it if the signs are known; otherwise the remainder comes from the quotient."""
    rest_name = FLOOR if op == "//" else ROUNDED
    quotient, rest = builder.sdiv(left, right, name=ROUNDED), builder.srem(left, right, name=rest_name)
    signs_differ = builder.icmp_signed("<", builder.xor(rest, right), I32(0))
    down = builder.and_(signs_differ, builder.icmp_signed("!=", rest, I32(0)))
    if op == "//":
        return builder.sub(quotient, builder.zext(down, I32))
    return builder.add(rest, builder.select(down, right, I32(0)))
