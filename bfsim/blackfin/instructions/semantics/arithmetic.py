"""Arithmetic and logic of 32 bits."""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.value import Value


def add_with_flags(fx: Effects, left: Value, right: Value) -> Value:
    """Return the sum of two words, and set all flags of it."""
    total = left + right
    overflow = ((left ^ total) & (right ^ total)).negative()
    fx.set_flags(AZ=total.equals(0), AN=total.negative(), V=overflow, AC0=total.below(left))
    fx.set_sticky("VS", overflow)
    return total


def subtract_with_flags(fx: Effects, left: Value, right: Value) -> Value:
    """Return the difference of two words, and set all flags of it. The carry says that nothing was borrowed."""
    difference = left - right
    overflow = ((left ^ right) & (left ^ difference)).negative()
    fx.set_flags(
        AZ=difference.equals(0), AN=difference.negative(), V=overflow, AC0=right.below_or_equal(left)
    )
    fx.set_sticky("VS", overflow)
    return difference


def logic_flags(fx: Effects, result: Value) -> Value:
    """Set the flags of a logical result, and return it."""
    fx.set_flags(AZ=result.equals(0), AN=result.negative(), AC0=0, V=0)
    return result


def shift_flags(fx: Effects, result: Value) -> Value:
    """Set the flags of a shift that cannot overflow, and return its result."""
    fx.set_flags(AZ=result.equals(0), AN=result.negative(), V=0)
    return result


def add(fx: Effects, d: str, s: str, t: str) -> None:
    fx.write(d, add_with_flags(fx, fx.read(s), fx.read(t)))


def subtract(fx: Effects, d: str, s: str, t: str) -> None:
    fx.write(d, subtract_with_flags(fx, fx.read(s), fx.read(t)))


def logic(fx: Effects, d: str, s: str, t: str, operator: str) -> None:
    left, right = fx.read(s), fx.read(t)
    result = {"&": left.__and__, "|": left.__or__, "^": left.__xor__}[operator](right)
    fx.write(d, logic_flags(fx, result))


def multiply_32(fx: Effects, d: str, s: str) -> None:
    fx.write(d, fx.read(d) * fx.read(s))


def negate(fx: Effects, d: str, s: str) -> None:
    fx.write(d, subtract_with_flags(fx, fx.constant(0), fx.read(s)))


def invert(fx: Effects, d: str, s: str) -> None:
    fx.write(d, logic_flags(fx, ~fx.read(s)))


def extend(fx: Effects, d: str, s: str, bits: int, signed: int) -> None:
    part = fx.read(s).low(bits)
    fx.write(d, logic_flags(fx, part.sign_extended() if signed else part.zero_extended()))


def change_bit(fx: Effects, d: str, b: int, how: str) -> None:
    old, bit = fx.read(d), 1 << b
    fx.write(d, logic_flags(fx, {"set": old | bit, "toggle": old ^ bit, "clear": old & ~bit}[how]))


def shift(fx: Effects, d: str, b: int, how: str) -> None:
    fx.write(d, shift_flags(fx, _shifted(fx.read(d), fx.constant(b), how)))


def shift_by_register(fx: Effects, d: str, s: str, how: str) -> None:
    """Shift by all 32 bits of a register: from 32 on, nothing is left but copies of the sign, or zeros.

    Such a shift to the right, with zeros, leaves the flags alone (sim/bfin in GDB 13.1).
    """
    old, amount = fx.read(d), fx.read(s)
    enough = amount.below(32)
    most = amount.constant(31 if how == "arithmetic" else 0)
    shifted = _shifted(old, enough.choose(amount, most), how)
    result = shifted if how == "arithmetic" else enough.choose(shifted, 0)
    fx.write(d, result)
    none = fx.constant(0, 1)
    flags = {"AZ": result.equals(0), "AN": result.negative(), "V": none, "V_COPY": none}
    for name, value in flags.items():
        fx.write(name, enough.choose(value, fx.read(name)) if how == "right" else value)


def _shifted(value: Value, amount: Value, how: str) -> Value:
    return {"arithmetic": value.shift_right_signed, "right": value.shift_right, "left": value.shift_left}[
        how
    ](amount)


def add_and_shift(fx: Effects, d: str, s: str, shift: int) -> None:
    """Add and shift; it overflows if the sum or a step of the shift does."""
    left, right = fx.read(d), fx.read(s)
    total = left + right
    overflow = ((left ^ total) & (right ^ total)).negative()
    result = total
    for _ in range(shift):
        doubled = result.shift_left(1)
        overflow |= (result ^ doubled).negative()
        result = doubled
    fx.set_flags(AZ=result.equals(0), AN=result.negative(), V=overflow)
    fx.set_sticky("VS", overflow)
    fx.write(d, result)


def divide_sign(fx: Effects, d: str, s: str) -> None:
    """Begin a division: the sign of the quotient goes to AQ and comes in on the right."""
    dividend = fx.read(d)
    sign = (fx.high(d) ^ fx.low(s)).negative()
    fx.write("AQ", sign)
    fx.write(d, dividend.shift_left(1) | sign.zero_extended())


def divide_step(fx: Effects, d: str, s: str) -> None:
    """Add or subtract the divisor, as AQ says; the next bit of the quotient comes in on the right."""
    dividend, divisor, upper = fx.read(d), fx.low(s), fx.high(d)
    rest = fx.read("AQ").choose(upper + divisor, upper - divisor)
    sign = (rest ^ divisor).negative()
    fx.write("AQ", sign)
    lower = dividend.shift_left(1) & 0x1FFFE | (~sign).zero_extended()
    fx.write(d, lower | rest.zero_extended().shift_left(17))


def add_pointers(fx: Effects, d: str, s: str, t: str, shift: int) -> None:
    fx.write(d, fx.read(s) + fx.read(t).shift_left(shift))


def subtract_pointer(fx: Effects, d: str, s: str) -> None:
    fx.write(d, fx.read(d) - fx.read(s))


def shift_pointer(fx: Effects, d: str, s: str, by: int, t: str = "") -> None:
    value = fx.read(s)
    fx.write(d, value.shift_left(by) if by > 0 else value.shift_right(-by))


def add_and_shift_pointers(fx: Effects, d: str, s: str, shift: int) -> None:
    fx.write(d, (fx.read(d) + fx.read(s)).shift_left(shift))


def add_reversed(fx: Effects, d: str, s: str) -> None:
    fx.write(d, sum_reversed(fx.read(d), fx.read(s)))


def sum_reversed(left: Value, right: Value) -> Value:
    """Return the sum of two words whose carries go to the right."""
    return (left.reversed() + right.reversed()).reversed()
