"""Fractions and pairs of them, as Python has them: the functions of VisualDSP++'s `fract_math.h`, `fr2x16_math.h` and `i2x16_math.h`.

A `fract16` is a half of a word, 1.15; a `fract32` a word, 1.31; a `fract2x16` a word of two `fract16`. Everything
saturates, except what is said to wrap. Of a parameter that is a half, the lower 16 bits count, as in C.
"""

from __future__ import annotations

from collections.abc import Callable

from bfsim.kernel.intrinsics.halves import count, halves, high, low, nearest, sign_bits, signed

HALF = 0x8000  # what rounding to a half adds


def _of_both(half: Callable[[int, int], int], x: int, y: int) -> int:
    return halves(half(high(x), high(y)), half(low(x), low(y)))


def _rounded(product: int) -> int:
    """Return the upper half of a product, rounded, ties to even: ASTAT's RND_MOD is 0 after a reset."""
    return product + HALF - 1 + (product >> 16 & 1) >> 16


def add_fr1x16(x: int, y: int) -> int:
    """Return x + y."""
    return nearest(low(x) + low(y), 16)


def sub_fr1x16(x: int, y: int) -> int:
    """Return x - y."""
    return nearest(low(x) - low(y), 16)


def mult_fr1x16(x: int, y: int) -> int:
    """Return x * y, truncated."""
    return nearest(2 * low(x) * low(y) >> 16, 16)


def multr_fr1x16(x: int, y: int) -> int:
    """Return x * y, rounded, ties to even."""
    return nearest(_rounded(2 * low(x) * low(y)), 16)


def negate_fr1x16(x: int) -> int:
    """Return -x."""
    return nearest(-low(x), 16)


def abs_fr1x16(x: int) -> int:
    """Return the absolute value."""
    return nearest(abs(low(x)), 16)


def min_fr1x16(x: int, y: int) -> int:
    """Return the smaller one."""
    return min(low(x), low(y))


def max_fr1x16(x: int, y: int) -> int:
    """Return the greater one."""
    return max(low(x), low(y))


def shl_fr1x16(x: int, places: int) -> int:
    """Return x shifted to the left, or to the right if `places` is negative; only its lowest six bits count."""
    by = count(places)
    return nearest(low(x) << by, 16) if by >= 0 else low(x) >> -by


def shr_fr1x16(x: int, places: int) -> int:
    """Return x shifted to the right, or to the left if `places` is negative."""
    return shl_fr1x16(x, -places)


def norm_fr1x16(x: int) -> int:
    """Return how far x can be shifted to the left and keep its sign: 0 to 15."""
    return sign_bits(low(x), 16)


def add_fr1x32(x: int, y: int) -> int:
    """Return x + y."""
    return nearest(x + y, 32)


def sub_fr1x32(x: int, y: int) -> int:
    """Return x - y."""
    return nearest(x - y, 32)


def mult_fr1x32(x: int, y: int) -> int:
    """Return the product of two `fract16` as a `fract32`."""
    return nearest(2 * low(x) * low(y), 32)


def negate_fr1x32(x: int) -> int:
    """Return -x."""
    return nearest(-x, 32)


def abs_fr1x32(x: int) -> int:
    """Return the absolute value."""
    return nearest(abs(x), 32)


def min_fr1x32(x: int, y: int) -> int:
    """Return the smaller one."""
    return min(x, y)


def max_fr1x32(x: int, y: int) -> int:
    """Return the greater one."""
    return max(x, y)


def shl_fr1x32(x: int, places: int) -> int:
    """Return x shifted to the left, or to the right if `places` is negative; only its lowest six bits count."""
    by = count(places)
    return nearest(x << by, 32) if by >= 0 else x >> -by


def shr_fr1x32(x: int, places: int) -> int:
    """Return x shifted to the right, or to the left if `places` is negative."""
    return shl_fr1x32(x, -places)


def norm_fr1x32(x: int) -> int:
    """Return how far x can be shifted to the left and keep its sign: 0 to 31."""
    return sign_bits(x, 32)


def round_fr1x32(x: int) -> int:
    """Return the nearest `fract16`, ties up."""
    return nearest(x + HALF >> 16, 16)


def sat_fr1x32(x: int) -> int:
    """Return the nearest number of 16 bits."""
    return nearest(x, 16)


def compose_fr2x16(upper: int, lower: int) -> int:
    """Return the pair of two halves."""
    return halves(upper, lower)


def high_of_fr2x16(x: int) -> int:
    """Return the upper half."""
    return high(x)


def low_of_fr2x16(x: int) -> int:
    """Return the lower half."""
    return low(x)


def add_fr2x16(x: int, y: int) -> int:
    """Return both sums."""
    return _of_both(add_fr1x16, x, y)


def sub_fr2x16(x: int, y: int) -> int:
    """Return both differences."""
    return _of_both(sub_fr1x16, x, y)


def mult_fr2x16(x: int, y: int) -> int:
    """Return both products, truncated."""
    return _of_both(mult_fr1x16, x, y)


def multr_fr2x16(x: int, y: int) -> int:
    """Return both products, rounded, ties to even."""
    return _of_both(multr_fr1x16, x, y)


def negate_fr2x16(x: int) -> int:
    """Return both halves negated."""
    return sub_fr2x16(0, x)


def abs_fr2x16(x: int) -> int:
    """Return both absolute values."""
    return halves(abs_fr1x16(high(x)), abs_fr1x16(x))


def min_fr2x16(x: int, y: int) -> int:
    """Return the smaller upper and the smaller lower half."""
    return _of_both(min, x, y)


def max_fr2x16(x: int, y: int) -> int:
    """Return the greater upper and the greater lower half."""
    return _of_both(max, x, y)


def shl_fr2x16(x: int, places: int) -> int:
    """Return both shifted to the left, or to the right if `places` is negative; only its lowest six bits count."""
    return halves(shl_fr1x16(high(x), places), shl_fr1x16(x, places))


def shr_fr2x16(x: int, places: int) -> int:
    """Return both shifted to the right, or to the left if `places` is negative."""
    return shl_fr2x16(x, -places)


def sum_fr2x16(x: int) -> int:
    """Return the upper half plus the lower one."""
    return add_fr1x16(x, high(x))


def diff_hl_fr2x16(x: int) -> int:
    """Return the upper half minus the lower one."""
    return sub_fr1x16(high(x), x)


def diff_lh_fr2x16(x: int) -> int:
    """Return the lower half minus the upper one."""
    return sub_fr1x16(x, high(x))


def dspaddsubsat(x: int, y: int) -> int:
    """Return the sum of the upper halves and the difference of the lower ones."""
    return halves(add_fr1x16(high(x), high(y)), sub_fr1x16(x, y))


def dspsubaddsat(x: int, y: int) -> int:
    """Return the difference of the upper halves and the sum of the lower ones."""
    return halves(sub_fr1x16(high(x), high(y)), add_fr1x16(x, y))


def add_i2x16(x: int, y: int) -> int:
    """Return both sums, which wrap."""
    return halves(high(x) + high(y), low(x) + low(y))


def sub_i2x16(x: int, y: int) -> int:
    """Return both differences, which wrap."""
    return halves(high(x) - high(y), low(x) - low(y))


def mac_i2x16(total: int, x: int, y: int) -> int:
    """Return `total` plus the products of the upper halves and of the lower ones, as integers: all added up, then saturated."""
    return nearest(total + high(x) * high(y) + low(x) * low(y), 32)


def mac_fr2x16(total: int, x: int, y: int) -> int:
    """Return `total`, a `fract32`, plus the products of the upper halves and of the lower ones: all added up, then saturated."""
    return nearest(signed(total) + 2 * (high(x) * high(y) + low(x) * low(y)), 32)
