"""Minima, maxima, magnitudes and signs, of registers and of both halves; the search for an extreme."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.results import half, join, set_overflow, set_zero_negative
from bfsim.blackfin.instructions.semantics.saturation import magnitude, negated
from bfsim.blackfin.instructions.value import Value


def _select(fx: Effects, d: str, s: str, t: str, choice: Callable[[Value, Value], Value]) -> None:
    """Write one of two registers."""
    result = choice(fx.read(s), fx.read(t))
    fx.write(d, result)
    set_zero_negative(fx, result)
    fx.set_flags(V=0)


def _select_pair(fx: Effects, d: str, s: str, t: str, choice: Callable[[Value, Value], Value]) -> None:
    """Write one of two halves, for both halves."""
    high, low = choice(fx.high(s), fx.high(t)), choice(fx.low(s), fx.low(t))
    fx.write(d, join(high, low))
    set_zero_negative(fx, high, low)
    fx.set_flags(V=0)


def absolute(fx: Effects, d: str, s: str) -> None:
    """R0 = ABS R1."""
    result, over = magnitude(fx.read(s))
    fx.write(d, result)
    set_zero_negative(fx, result)
    set_overflow(fx, over)


def absolute_pair(fx: Effects, d: str, s: str) -> None:
    """R0 = ABS R1 (V)."""
    (high, high_over), (low, low_over) = magnitude(fx.high(s)), magnitude(fx.low(s))
    fx.write(d, join(high, low))
    set_zero_negative(fx, high, low)
    set_overflow(fx, high_over | low_over)


def negate_register(fx: Effects, d: str, s: str, q: int) -> None:
    """R0 = -R1 (S): GNU's simulator sets V if it saturates, and never clears it."""
    near, over = negated(fx.read(s))
    result = near if q else -fx.read(s)
    fx.write(d, result)
    set_zero_negative(fx, result)
    if q:
        copy = fx.read("V_COPY") | over
        fx.set_sticky("V", over)
        fx.set_flags(V_COPY=copy)
        fx.set_sticky("VS", over)


def negate_pair(fx: Effects, d: str, s: str) -> None:
    """R0 = -R1 (V)."""
    (high, high_over), (low, low_over) = negated(fx.high(s)), negated(fx.low(s))
    fx.write(d, join(high, low))
    set_zero_negative(fx, high, low)
    set_overflow(fx, high_over | low_over)
    fx.set_flags(AC0=low.equals(0), AC1=high.equals(0))


def sign(fx: Effects, d: str, s: str, t: str) -> None:
    """R0.H = R0.L = SIGN (R1.H) * R2.H + SIGN (R1.L) * R2.L; zero counts as positive."""
    high, low = (
        half(fx, s, each).negative().choose(-half(fx, t, each), half(fx, t, each)) for each in (1, 0)
    )
    fx.write(d, join(high + low, high + low))


def search(fx: Effects, d: str, e: str, s: str, m: str) -> None:
    """(R0, R1) = SEARCH R2 (GT): A1 and A0 keep the best of all high and low halves, the registers P0 of where it was."""
    for accumulator, candidate, register in (("A1", fx.high(s), e), ("A0", fx.low(s), d)):
        best = fx.read(accumulator).low(16)
        better = {
            "GT": candidate > best,
            "GE": candidate >= best,
            "LT": candidate < best,
            "LE": candidate <= best,
        }[m]
        fx.write(accumulator, better.choose(candidate, best).sign_extended(64))
        fx.write(register, better.choose(fx.read("P0"), fx.read(register)))


SEMANTICS: dict[str, Callable[..., None]] = {
    "maximum": partial(_select, choice=Value.larger),
    "minimum": partial(_select, choice=Value.smaller),
    "maximum_pair": partial(_select_pair, choice=Value.larger),
    "minimum_pair": partial(_select_pair, choice=Value.smaller),
    "absolute": absolute,
    "absolute_pair": absolute_pair,
    "negate_register": negate_register,
    "negate_pair": negate_pair,
    "sign": sign,
    "search": search,
}
