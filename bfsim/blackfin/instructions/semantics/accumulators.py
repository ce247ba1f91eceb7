"""The 40-bit accumulators: moves of them and of their parts, sums, magnitudes, negation and saturation."""

from __future__ import annotations

from collections.abc import Callable

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.results import (
    join,
    part,
    set_overflow,
    set_zero_negative,
    write_half,
)
from bfsim.blackfin.instructions.semantics.saturation import magnitude, negated, rounded, saturated
from bfsim.blackfin.instructions.value import Value

BITS = 40
LARGEST = (1 << BITS - 1) - 1
W32 = 0x80FFFFFFFF
"""The bits of a sum with (W32) that GNU's simulator keeps: 32 bits and the sign of 40."""


def clear_accumulator(fx: Effects, a: str) -> None:
    """A0 = 0."""
    fx.write(a, 0)


def clear_accumulators(fx: Effects) -> None:
    """A1 = A0 = 0."""
    fx.write("A0", 0)
    fx.write("A1", 0)


def copy_accumulator(fx: Effects, a: str, b: str) -> None:
    """A0 = A1."""
    fx.write(a, fx.read(b))


def load_accumulator(fx: Effects, a: str, s: str) -> None:
    """A0 = R0."""
    fx.write(a, fx.read(s).sign_extended(64))


def load_low(fx: Effects, a: str, s: str) -> None:
    """A0.L = R0.L."""
    fx.write(a, join(part(fx.read(a), 16, 48), fx.low(s)))


def load_high(fx: Effects, a: str, s: str) -> None:
    """A0.H = R0.H."""
    fx.write(a, join(join(part(fx.read(a), 32, 32), fx.high(s)), fx.read(a).low(16)))


def load_extension(fx: Effects, a: str, s: str) -> None:
    """A0.X = R0.L."""
    fx.write(f"{a}.X", fx.read(s))


def move_extension(fx: Effects, d: str, a: str) -> None:
    """R0.L = A0.X."""
    fx.write_low(d, fx.read(f"{a}.X").low(16))


def sum_halves(fx: Effects, d: str, e: str) -> None:
    """R1 = A1.L + A1.H, R0 = A0.L + A0.H."""
    for register, accumulator in ((e, fx.read("A1")), (d, fx.read("A0"))):
        fx.write(register, part(accumulator, 16, 16).sign_extended() + accumulator.low(16).sign_extended())


def _at_32_bits(accumulator: Value) -> tuple[Value, Value]:
    result, over = saturated(accumulator, 32)
    return result.sign_extended(BITS), over


def _change(fx: Effects, change: Callable[[Value], tuple[Value, Value]], *pairs: tuple[str, str]) -> None:
    """Write the changed second accumulator of each pair to the first; flags are set if any result sets them."""
    results = []
    for to, source in pairs:
        result, over = change(fx.read(source).low(BITS))
        fx.write(to, result.sign_extended(64))
        set_overflow(fx, over, f"AV{to[1]}")
        results.append(result)
    set_zero_negative(fx, *results)


BOTH = (("A1", "A1"), ("A0", "A0"))


def saturate_accumulator(fx: Effects, a: str) -> None:
    """A0 = A0 (S): at 32 bits."""
    _change(fx, _at_32_bits, (a, a))


def saturate_accumulators(fx: Effects) -> None:
    """A1 = A1 (S), A0 = A0 (S)."""
    _change(fx, _at_32_bits, *BOTH)


def absolute_accumulator(fx: Effects, a: str, b: str) -> None:
    """A0 = ABS A1."""
    _change(fx, magnitude, (a, b))


def absolute_accumulators(fx: Effects) -> None:
    """A1 = ABS A1, A0 = ABS A0."""
    _change(fx, magnitude, *BOTH)


def negate_accumulator(fx: Effects, a: str, b: str) -> None:
    """A0 = -A1."""
    _change(fx, negated, (a, b))
    fx.set_flags(**{f"AC{a[1]}": fx.read(b).equals(0)})


def negate_accumulators(fx: Effects) -> None:
    """A1 = -A1, A0 = -A0. GNU's simulator leaves the flags as they were."""
    for each in ("A0", "A1"):
        fx.write(each, negated(fx.read(each).low(BITS))[0].sign_extended(64))


def _accumulate(fx: Effects, total: Value, over: Value, carry: Value) -> None:
    fx.write("A0", total.sign_extended(64))
    set_overflow(fx, over, "AV0")
    fx.set_flags(AC0=carry)


def _sum(fx: Effects) -> tuple[Value, Value, Value]:
    """Return A0 + A1, whether it did not fit, and its carry, which in GNU's simulator is that of 64 bits."""
    one, other = fx.read("A0"), fx.read("A1")
    return *saturated(one + other, BITS), (~other).below(one)


def _difference(fx: Effects) -> tuple[Value, Value, Value]:
    """Return A0 - A1 likewise. GNU's simulator calls the largest number saturated, and the borrow a carry."""
    one, other = fx.read("A0"), fx.read("A1")
    total, over = saturated(one - other, BITS)
    return total, over | total.equals(LARGEST), other.below(one)


def add_accumulators(fx: Effects) -> None:
    """A0 += A1."""
    total, over, carry = _sum(fx)
    _accumulate(fx, total, over, carry)
    set_zero_negative(fx, total)


def add_accumulators_w32(fx: Effects) -> None:
    """A0 += A1 (W32)."""
    total, over, carry = _sum(fx)
    _accumulate(fx, total & W32, over, carry)
    set_zero_negative(fx, total & W32)


def subtract_accumulators(fx: Effects) -> None:
    """A0 -= A1."""
    total, over, carry = _difference(fx)
    _accumulate(fx, total, over, carry)
    set_zero_negative(fx, total)


def subtract_accumulators_w32(fx: Effects) -> None:
    """A0 -= A1 (W32): GNU's simulator calls every negative result saturated."""
    total, over, carry = _difference(fx)
    _accumulate(fx, total & W32, over | total.negative(), carry)
    set_zero_negative(fx, total & W32)


def add_accumulators_to_register(fx: Effects, d: str) -> None:
    """R0 = (A0 += A1)."""
    total, over, carry = _sum(fx)
    _accumulate(fx, total, over, carry)
    result, register_over = saturated(total, 32)
    fx.write(d, result)
    set_zero_negative(fx, result)
    set_overflow(fx, register_over)


def add_accumulators_to_half(fx: Effects, d: str, h: int) -> None:
    """R0.L = (A0 += A1)."""
    total, over, carry = _sum(fx)
    _accumulate(fx, total, over, carry)
    result, half_over = saturated(rounded(total.sign_extended(64), fx.read("RND_MOD")), 16)
    write_half(fx, d, h, result)
    set_zero_negative(fx, result)
    set_overflow(fx, half_over)


def add_subtract_accumulators(fx: Effects, d: str, e: str, a: str, b: str, q: int) -> None:
    """R1 = A1 + A0, R0 = A1 - A0 (S). In GNU's simulator AZ looks at all bits without (S), and the carries are those of 64 bits."""
    one, other = fx.read(a), fx.read(b)
    exact = one + other, one - other
    near = [saturated(each, 32) for each in exact]
    results = [fit if q else each.low(32) for each, (fit, _) in zip(exact, near, strict=True)]
    fx.write(e, results[0])
    fx.write(d, results[1])
    set_zero_negative(fx, *results)
    if not q:
        fx.set_flags(AZ=exact[0].equals(0) | exact[1].equals(0))
    set_overflow(fx, near[0][1] | near[1][1])
    fx.set_flags(AC0=other.below_or_equal(one), AC1=(~one).below(other))
