"""Operands and results of DSP instructions: halves of registers, parts of values, the flags that follow from results."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from operator import or_

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.value import Value


def half(fx: Effects, register: str, high: int) -> Value:
    """Return the high or low half of a register."""
    return fx.high(register) if high else fx.low(register)


def write_half(fx: Effects, register: str, high: int, value: Value) -> None:
    """Write the high or low half of a register."""
    (fx.write_high if high else fx.write_low)(register, value)


def join(high: Value, low: Value) -> Value:
    """Return two values as one, as wide as both."""
    bits = high.bits + low.bits
    return high.zero_extended(bits).shift_left(low.bits) | low.zero_extended(bits)


def part(whole: Value, first: int, bits: int) -> Value:
    """Return `bits` bits of a value, from bit number `first` on."""
    return whole.shift_right(first).low(bits)


def any_of(bits: Iterable[Value]) -> Value:
    """Return one bit: whether any of them is set."""
    return reduce(or_, bits)


def set_zero_negative(fx: Effects, *results: Value) -> None:
    """Set AZ if any of the results is zero, AN if any is negative."""
    fx.set_flags(
        AZ=any_of(each.equals(0) for each in results), AN=any_of(each.negative() for each in results)
    )


def set_overflow(fx: Effects, over: Value, flag: str = "V") -> None:
    """Set V, or an accumulator's AV0 or AV1, if a result did not fit, else clear it; its sticky flag stays set."""
    fx.set_flags(**{flag: over})
    fx.set_sticky(f"{flag}S", over)
