"""Saturation and rounding, which the arithmetic of the DSP instructions shares."""

from __future__ import annotations

from bfsim.blackfin.instructions.value import Value


def saturated(exact: Value, bits: int) -> tuple[Value, Value]:
    """Return a signed number in `bits` bits, the nearest one if it does not fit, and whether it did not fit."""
    most = (1 << bits - 1) - 1
    near = exact.larger(-most - 1).smaller(most)
    return near.low(bits), near.differs(exact)


def saturated_unsigned(exact: Value, bits: int) -> tuple[Value, Value]:
    """Return an unsigned number in `bits` bits, the largest one if it does not fit, and whether it did not fit."""
    most = exact.constant((1 << bits) - 1)
    over = most.below(exact)
    return over.choose(most, exact).low(bits), over


def fitted(exact: Value, bits: int, *, saturate: int) -> tuple[Value, Value]:
    """Return a signed number in `bits` bits, `saturated` or wrapped, and whether it did not fit."""
    near, over = saturated(exact, bits)
    return (near if saturate else exact.low(bits)), over


def negated(number: Value) -> tuple[Value, Value]:
    """Return minus `number`, for the least number the largest one, and whether it was the least."""
    least = 1 << number.bits - 1
    over = number.equals(least)
    return over.choose(number.constant(least - 1), -number), over


def magnitude(number: Value) -> tuple[Value, Value]:
    """Return the absolute value, for the least number the largest one, and whether it was the least."""
    minus, over = negated(number)
    return number.negative().choose(minus, number), over


def rounded(number: Value, biased: Value) -> Value:
    """Return a signed number without its lowest 16 bits, rounded to the nearest; half goes up if `biased`, else to even.

    `biased` is ASTAT's RND_MOD (programming reference, chapter 1, "Rounding and truncating").
    """
    stays = (number & 0x1FFFF).equals(0x8000) & ~biased
    return stays.choose(number, number + 0x8000).shift_right_signed(16)
