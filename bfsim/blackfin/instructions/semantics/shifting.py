"""Shifts and rotations of values of 16, 32 and 40 bits, and whether they overflow.

A count is a number, or a value of 64 bits; positive to the left, between -32 and 32. Overflow is as in GNU's simulator:
the bits that leave must all be zeros, or all ones before a negative result.
"""

from __future__ import annotations

from collections.abc import Callable

from bfsim.blackfin.instructions.semantics.results import part
from bfsim.blackfin.instructions.value import Value

Count = int | Value
Shifted = tuple[Value, Value]
"""A result, and whether it overflowed."""


def amount(register: Value) -> Value:
    """Return the count in the lowest six bits of a register."""
    return register.low(6).sign_extended(64)


def logical(number: Value, count: Count) -> Shifted:
    """Shift; zeros come in from both sides."""
    return _either(
        number, count, _left, lambda size: number.zero_extended(64).shift_right(size).low(number.bits)
    )


def arithmetic(number: Value, count: Count) -> Shifted:
    """Shift; the sign comes in from the left, and a result of another sign has overflowed."""
    return _either(
        number,
        count,
        _signed_left,
        lambda size: number.sign_extended(64).shift_right_signed(size).low(number.bits),
    )


def saturating(number: Value, count: Count) -> Shifted:
    """Shift arithmetically; what overflows becomes the largest or the smallest number."""
    result, over = arithmetic(number, count)
    most = number.constant((1 << number.bits - 1) - 1)
    return over.choose(number.negative().choose(~most, most), result), over


def rotated(number: Value, carry: Value, count: Count) -> Shifted:
    """Rotate a number with the carry as its highest bit; return both."""
    bits = number.bits + 1
    ring = carry.zero_extended(64).shift_left(number.bits) | number.zero_extended(64)
    places = ring.constant(count) if isinstance(count, int) else count
    places = places.negative().choose(places + bits, places)
    turned = ring.shift_left(places) | ring.shift_right(-places + bits)
    return turned.low(number.bits), part(turned, number.bits, 1)


def _left(number: Value, count: Count) -> Shifted:
    wide = number.zero_extended(64).shift_left(count)
    gone, result = wide.shift_right(number.bits), wide.low(number.bits)
    ones = wide.constant(1).shift_left(count) - 1
    kept = gone.equals(0) | gone.equals(ones) & result.negative()
    return result, ~kept


def _signed_left(number: Value, count: Count) -> Shifted:
    result, lost = _left(number, count)
    return result, lost | (result ^ number).negative()


def _either(
    number: Value, count: Count, left: Callable[[Value, Count], Shifted], right: Callable[[Count], Value]
) -> Shifted:
    never = number.constant(0, 1)
    if isinstance(count, int):
        return left(number, count) if count >= 0 else (right(-count), never)
    leftwards, over = left(number, count.larger(0))
    down = count.negative()
    return down.choose(right((-count).larger(0)), leftwards), ~down & over
