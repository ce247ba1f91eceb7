"""The shifter's shifts and rotations: of half registers, registers, pairs of halves and accumulators, by a register or a number."""

from __future__ import annotations

from collections.abc import Callable

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.results import (
    half,
    join,
    set_overflow,
    set_zero_negative,
    write_half,
)
from bfsim.blackfin.instructions.semantics.shifting import (
    Count,
    Shifted,
    amount,
    arithmetic,
    logical,
    rotated,
    saturating,
)
from bfsim.blackfin.instructions.value import Value

Semantics = Callable[..., None]
Shift = Callable[[Value, Count], Shifted]


def _silent(number: Value, count: Count) -> Shifted:
    """Shift logically; nothing overflows."""
    return logical(number, count)[0], number.constant(0, 1)


def _watchful(number: Value, count: Count) -> Shifted:
    """Shift logically; as in GNU's simulator, V is that of an arithmetic shift to the left."""
    return logical(number, count)[0], arithmetic(number, count)[1]


def _short(number: Value, count: Count) -> Shifted:
    """Shift a half by a six-bit number: by up to 16 to the right, or else to the left, by its lowest four bits."""
    assert isinstance(count, int)
    return arithmetic(number, count if -16 <= count <= 0 else count % 16 or 16)


def _short_saturating(number: Value, count: Count) -> Shifted:
    """Shift a half to the left by a number of five bits; from 16 on, it goes to the right."""
    assert isinstance(count, int)
    return saturating(number, count if count < 16 else count - 32)


def _short_right_saturating(number: Value, count: Count) -> Shifted:
    """Shift a half to the right, or from 17 on to the left, where it saturates if its sign changes."""
    assert isinstance(count, int)
    if count >= -16:
        return arithmetic(number, count)
    result = logical(number, 32 + count)[0]
    turned = (result ^ number).negative()
    most = number.constant((1 << number.bits - 1) - 1)
    return turned.choose(number.negative().choose(~most, most), result), turned


def _half(fx: Effects, shift: Shift, count: Count, d: str, h: int, t: str, l: int) -> None:
    result, over = shift(half(fx, t, l), count)
    write_half(fx, d, h, result)
    set_zero_negative(fx, result)
    set_overflow(fx, over)


def _pair(fx: Effects, shift: Shift, count: Count, d: str, t: str) -> None:
    (high, high_over), (low, low_over) = shift(fx.high(t), count), shift(fx.low(t), count)
    fx.write(d, join(high, low))
    set_zero_negative(fx, high, low)
    set_overflow(fx, high_over | low_over)


def _register(fx: Effects, shift: Shift, count: Count, d: str, t: str) -> None:
    result, over = shift(fx.read(t), count)
    fx.write(d, result)
    set_zero_negative(fx, result)
    set_overflow(fx, over)


def _accumulator(fx: Effects, shift: Shift, count: Count, a: str) -> None:
    result, _ = shift(fx.read(a).low(40), count)
    fx.write(a, result.sign_extended(64))
    set_zero_negative(fx, result)
    fx.set_flags(**{f"AV{a[1]}": 0})


def _rotate_register(fx: Effects, count: Count, d: str, t: str) -> None:
    result, carry = rotated(fx.read(t), fx.read("CC"), count)
    fx.write(d, result)
    fx.set_flags(CC=carry)


def _rotate_accumulator(fx: Effects, count: Count, a: str) -> None:
    result, carry = rotated(fx.read(a).low(40), fx.read("CC"), count)
    fx.write(a, result.sign_extended(64))
    fx.set_flags(CC=carry)


def _by_register(place: Semantics, *shift: Shift) -> Semantics:
    return lambda fx, s, **operands: place(fx, *shift, amount(fx.read(s)), **operands)


def _by_number(place: Semantics, *shift: Shift) -> Semantics:
    return lambda fx, n, **operands: place(fx, *shift, n, **operands)


SEMANTICS: dict[str, Semantics] = {
    "ashift_half": _by_register(_half, arithmetic),
    "ashift_half_s": _by_register(_half, saturating),
    "lshift_half": _by_register(_half, _silent),
    "ashift_pair": _by_register(_pair, arithmetic),
    "ashift_pair_s": _by_register(_pair, saturating),
    "lshift_pair": _by_register(_pair, _silent),
    "ashift_register": _by_register(_register, arithmetic),
    "ashift_register_s": _by_register(_register, saturating),
    "lshift_register": _by_register(_register, _watchful),
    "ashift_accumulator": _by_register(_accumulator, arithmetic),
    "lshift_accumulator": _by_register(_accumulator, logical),
    "rotate_register": _by_register(_rotate_register),
    "rotate_accumulator": _by_register(_rotate_accumulator),
    "shift_half": _by_number(_half, _short),
    "shift_half_right_s": _by_number(_half, _short_right_saturating),
    "shift_half_s": _by_number(_half, saturating),
    "shift_half_logical": _by_number(_half, logical),
    "shift_pair": _by_number(_pair, _short),
    "shift_pair_s": _by_number(_pair, _short_saturating),
    "shift_pair_logical": _by_number(_pair, logical),
    "shift_register": _by_number(_register, arithmetic),
    "shift_register_s": _by_number(_register, saturating),
    "shift_register_logical": _by_number(_register, logical),
    "shift_accumulator": _by_number(_accumulator, arithmetic),
    "shift_accumulator_logical": _by_number(_accumulator, logical),
    "rotate_register_by": _by_number(_rotate_register),
    "rotate_accumulator_by": _by_number(_rotate_accumulator),
}
