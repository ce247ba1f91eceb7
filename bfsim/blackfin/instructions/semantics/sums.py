"""Sums and differences of registers, of their halves, and of both at once; rounding to a half."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.results import (
    any_of,
    half,
    join,
    set_overflow,
    set_zero_negative,
    write_half,
)
from bfsim.blackfin.instructions.semantics.saturation import fitted, negated, saturated
from bfsim.blackfin.instructions.value import Value


@dataclass(frozen=True, slots=True)
class Sum:
    """A sum or difference of two values, as wide as they are; whether it did not fit; its carry."""

    result: Value
    over: Value
    carry: Value

    @classmethod
    def of(cls, one: Value, other: Value, *, minus: int, saturate: int) -> Sum:
        """Add two values, or subtract the second from the first. A difference carries if nothing is borrowed."""
        carry = other.below_or_equal(one) if minus else (~one).below(other)
        return cls(*fitted(_exact(one, other, minus), one.bits, saturate=saturate), carry)

    @classmethod
    def scaled(cls, one: Value, other: Value, *, minus: int, saturate: int, scale: str) -> Sum:
        """Add or subtract, then halve (ASR) or double (ASL), before anything is lost."""
        exact = _exact(one, other, minus)
        exact = exact.shift_right_signed(1) if scale == "ASR" else exact.shift_left(1)
        return cls(*fitted(exact, one.bits, saturate=saturate), one.constant(0, 1))


def _exact(one: Value, other: Value, minus: int) -> Value:
    bits = one.bits + 2
    one, other = one.sign_extended(bits), other.sign_extended(bits)
    return one - other if minus else one + other


def _set_flags(fx: Effects, *sums: Sum) -> None:
    """Set AZ, AN, V and VS if any of the results sets them."""
    set_zero_negative(fx, *(each.result for each in sums))
    set_overflow(fx, any_of(each.over for each in sums))


def _sum(fx: Effects, d: str, s: str, t: str, q: int, minus: int) -> None:
    total = Sum.of(fx.read(s), fx.read(t), minus=minus, saturate=q)
    fx.write(d, total.result)
    _set_flags(fx, total)
    fx.set_flags(AC0=total.carry)


def add_subtract(fx: Effects, d: str, e: str, s: str, t: str, q: int) -> None:
    """R0 = R2 + R3, R1 = R2 - R3 (S); every flag is that of either."""
    total, difference = (Sum.of(fx.read(s), fx.read(t), minus=minus, saturate=q) for minus in (0, 1))
    fx.write(e, total.result)
    fx.write(d, difference.result)
    _set_flags(fx, total, difference)
    fx.set_flags(AC0=total.carry | difference.carry)


def _sum_half(
    fx: Effects,
    d: str,
    h: int,
    s: str,
    k: int,
    t: str,
    l: int,
    q: int,
    minus: int,
) -> None:
    total = Sum.of(half(fx, s, k), half(fx, t, l), minus=minus, saturate=q)
    write_half(fx, d, h, total.result)
    _set_flags(fx, total)
    fx.set_flags(AC0=total.carry)


def vector(fx: Effects, d: str, s: str, t: str, a: int, b: int, m: int) -> None:
    """R0 = R1 +|- R2 (SCO): `m` is 2 to saturate plus 1 to exchange the halves of the result."""
    high = Sum.of(fx.high(s), fx.high(t), minus=a, saturate=m & 2)
    low = Sum.of(fx.low(s), fx.low(t), minus=b, saturate=m & 2)
    fx.write(d, _crossed(high, low, m & 1))
    _set_flags(fx, high, low)
    fx.set_flags(AC0=low.carry, AC1=high.carry)


def _crossed(high: Sum, low: Sum, exchange: int) -> Value:
    return join(low.result, high.result) if exchange else join(high.result, low.result)


def quad(fx: Effects, d: str, e: str, s: str, t: str, m: int, low: int, scale: str = "") -> None:
    """R0 = R2 +|+ R3, R1 = R2 -|- R3 (SCO, ASR), or with `low` R0 = R2 +|- R3, R1 = R2 -|+ R3 (SCO, ASR)."""
    total = partial(Sum.scaled, scale=scale) if scale else Sum.of
    highs = [total(fx.high(s), fx.high(t), minus=minus, saturate=m & 2) for minus in (0, 1)]
    lows = [total(fx.low(s), fx.low(t), minus=minus, saturate=m & 2) for minus in (low, 1 - low)]
    fx.write(e, join(highs[0].result, lows[0].result))
    fx.write(d, _crossed(highs[1], lows[1], m & 1))
    _set_flags(fx, *highs, *lows)


def round12(fx: Effects, d: str, h: int, s: str, t: str, a: int) -> None:
    """R0.L = R1 + R2 (RND12): the upper half of the sum times 16, rounded and saturated."""
    other = negated(fx.read(t))[0] if a else fx.read(t)
    exact = _exact(fx.read(s), other, 0) + 0x800
    _write_rounded(fx, d, h, *saturated(exact.shift_right_signed(12), 16))


def round20(fx: Effects, d: str, h: int, s: str, t: str, a: int) -> None:
    """R0.L = R1 + R2 (RND20): the upper half of a sixteenth of the sum, rounded. It always fits."""
    other = -fx.read(t) if a else fx.read(t)
    sixteenth = _exact(fx.read(s), other, 0).shift_right_signed(4)
    result = (sixteenth + 0x8000).shift_right_signed(16).low(16)
    _write_rounded(fx, d, h, result, result.constant(0, 1))


def round_half(fx: Effects, d: str, h: int, s: str) -> None:
    """R0.L = R1 (RND): a half goes up, whatever RND_MOD says."""
    exact = fx.read(s).sign_extended(33) + 0x8000
    _write_rounded(fx, d, h, *saturated(exact.shift_right_signed(16), 16))


def _write_rounded(fx: Effects, d: str, h: int, result: Value, over: Value) -> None:
    write_half(fx, d, h, result)
    set_zero_negative(fx, result)
    set_overflow(fx, over)


SEMANTICS: dict[str, Callable[..., None]] = {
    "sum_of_registers": partial(_sum, minus=0),
    "difference_of_registers": partial(_sum, minus=1),
    "add_subtract": add_subtract,
    "add_half": partial(_sum_half, minus=0),
    "subtract_half": partial(_sum_half, minus=1),
    "vector": vector,
    "quad": quad,
    "round12": round12,
    "round20": round20,
    "round_half": round_half,
}
