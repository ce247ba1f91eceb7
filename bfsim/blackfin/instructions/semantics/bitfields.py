"""Bits of registers: extract and deposit, packing, alignment, counting, multiplexing, and the steps of Viterbi and CRC."""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.results import half, join, part, set_zero_negative
from bfsim.blackfin.instructions.value import Value


def _write_logical(fx: Effects, d: str, result: Value) -> None:
    fx.write(d, result)
    set_zero_negative(fx, result)
    fx.set_flags(AC0=0, V=0)


def _field(register: Value) -> tuple[Value, Value]:
    """Return the length and the first bit of a field that a register describes."""
    return register & 0x1F, register.shift_right(8) & 0x1F


def _mask(length: Value) -> Value:
    return length.constant(1).shift_left(length) - 1


def extract_z(fx: Effects, d: str, s: str, t: str) -> None:
    """Extract a field, zeros above it."""
    length, first = _field(fx.read(s))
    _write_logical(fx, d, fx.read(t).shift_right(first) & _mask(length))


def extract_x(fx: Effects, d: str, s: str, t: str) -> None:
    """Extract a field, its sign above it."""
    length, first = _field(fx.read(s))
    room = -length.zero_extended(64) + 63  # and one more, for a field may be empty
    field = fx.read(t).shift_right(first).zero_extended(64).shift_left(room).shift_left(1)
    _write_logical(fx, d, field.shift_right_signed(room).shift_right_signed(1).low(32))


def deposit(fx: Effects, d: str, s: str, t: str) -> None:
    """Lay bits of a register's upper half over another register; its lower half says how many, and where."""
    foreground = fx.read(s)
    length, first = _field(foreground)
    mask = _mask(length.smaller(16))
    field = (foreground.shift_right(16) & mask).shift_left(first)
    _write_logical(fx, d, fx.read(t) & ~mask.shift_left(first) | field)


def deposit_x(fx: Effects, d: str, s: str, t: str) -> None:
    """Do so, and lay the sign over all bits above."""
    foreground = fx.read(s)
    length, first = _field(foreground)
    room = -length + 16 & 0x1F
    field = (foreground.shift_right(16) & _mask(length.smaller(16))).shift_left(room).low(16)
    field = field.sign_extended(32).shift_right_signed(room).shift_left(first)
    below = length.constant(1).shift_left(first) - 1
    _write_logical(fx, d, fx.read(t) & below | field)


def pack(fx: Effects, d: str, s: str, t: str, k: int, l: int) -> None:
    """Make a register of two halves."""
    fx.write(d, join(half(fx, t, k), half(fx, s, l)))


def align(fx: Effects, d: str, s: str, t: str, distance: int) -> None:
    """Take four of the eight bytes of two registers."""
    fx.write(d, part(join(fx.read(t), fx.read(s)), distance, 32))


def sign_bits(number: Value) -> Value:
    """Return how many bits of a number of at least 16 bits repeat its sign, in 16 bits."""
    repeated = number ^ number.shift_right_signed(number.bits - 1)
    return repeated.leading_zeros().low(16) - 1


def signbits_register(fx: Effects, d: str, t: str) -> None:
    """R0.L = SIGNBITS R1."""
    fx.write_low(d, sign_bits(fx.read(t)))


def signbits_half(fx: Effects, d: str, t: str, l: int) -> None:
    """R0.L = SIGNBITS R1.H."""
    fx.write_low(d, sign_bits(half(fx, t, l)))


def signbits_accumulator(fx: Effects, d: str, a: str) -> None:
    """R0.L = SIGNBITS A0: as if it had 32 bits, so it may be negative."""
    fx.write_low(d, sign_bits(fx.read(a)) - 32)


def ones(fx: Effects, d: str, t: str) -> None:
    """Count the bits that are set."""
    fx.write_low(d, fx.read(t).ones().low(16))


def _smaller_exponent(found: Value, before: Value, bits: int) -> Value:
    """Return the smaller of two exponents, comparing `bits` bits."""
    mask = (1 << bits) - 1
    return (found & mask).below(before & mask).choose(found, before)


def expadj_register(fx: Effects, d: str, s: str, t: str) -> None:
    """R0.L = EXPADJ (R1, R2.L)."""
    fx.write_low(d, _smaller_exponent(sign_bits(fx.read(t)), fx.low(s), 5))


def expadj_half(fx: Effects, d: str, s: str, t: str, l: int) -> None:
    """R0.L = EXPADJ (R1.H, R2.L)."""
    fx.write_low(d, _smaller_exponent(sign_bits(half(fx, t, l)), fx.low(s), 4))


def expadj_pair(fx: Effects, d: str, s: str, t: str) -> None:
    """R0.L = EXPADJ (R1, R2.L) (V)."""
    both = _smaller_exponent(sign_bits(fx.high(t)), sign_bits(fx.low(t)), 4)
    fx.write_low(d, _smaller_exponent(both, fx.low(s), 4))


def bitmux_right(fx: Effects, s: str, t: str) -> None:
    """Shift the lowest bits of two registers into A0 from above."""
    first, second = fx.read(s), fx.read(t)
    history = part(fx.read("A0"), 2, 38)
    fx.write("A0", join(join(second.low(1), first.low(1)), history).sign_extended(64))
    fx.write(s, first.shift_right(1))
    fx.write(t, second.shift_right(1))


def bitmux_left(fx: Effects, s: str, t: str) -> None:
    """Shift the highest bits of two registers into A0 from below."""
    first, second = fx.read(s), fx.read(t)
    bits = join(part(second, 31, 1), part(first, 31, 1))
    fx.write("A0", fx.read("A0").shift_left(2) | bits.zero_extended(64))
    fx.write(s, first.shift_left(1))
    fx.write(t, second.shift_left(1))


def _survivor(fx: Effects, register: str) -> tuple[Value, Value]:
    """Return the half that is ahead of the other on the circle of 16-bit numbers, and whether it is the high one."""
    high, low = fx.high(register), fx.low(register)
    ahead = ~(high - low).negative()
    return ahead.choose(high, low), ahead.zero_extended(64)


def vit_max_left(fx: Effects, d: str, t: str) -> None:
    """R0.L = VIT_MAX (R1) (ASL)."""
    result, ahead = _survivor(fx, t)
    fx.write_low(d, result)
    fx.write("A0", fx.read("A0").shift_left(1) | ahead)


def vit_max_right(fx: Effects, d: str, t: str) -> None:
    """R0.L = VIT_MAX (R1) (ASR)."""
    result, ahead = _survivor(fx, t)
    fx.write_low(d, result)
    fx.write("A0", (fx.read("A0") & 0xFEFFFFFFFF).shift_right(1) | ahead.shift_left(31))


def vit_max_pair_left(fx: Effects, d: str, s: str, t: str) -> None:
    """R0 = VIT_MAX (R1, R2) (ASL)."""
    (low, low_ahead), (high, high_ahead) = _survivor(fx, s), _survivor(fx, t)
    fx.write(d, join(high, low))
    fx.write("A0", fx.read("A0").shift_left(2) | low_ahead.shift_left(1) | high_ahead)


def vit_max_pair_right(fx: Effects, d: str, s: str, t: str) -> None:
    """R0 = VIT_MAX (R1, R2) (ASR)."""
    (low, low_ahead), (high, high_ahead) = _survivor(fx, s), _survivor(fx, t)
    fx.write(d, join(high, low))
    fx.write("A0", fx.read("A0").shift_right_signed(2) | high_ahead.shift_left(31) | low_ahead.shift_left(30))


def _folded(fx: Effects, mask: Value) -> Value:
    """Return one bit: whether A0 has an odd number of the bits of a mask of 40."""
    return (fx.read("A0") & mask & 0xFFFFFFFFFF).ones().low(1)


def _write_cc(fx: Effects, d: str, bit: Value) -> None:
    fx.set_flags(CC=bit)
    fx.write_low(d, bit.zero_extended(16))


def bxorshift_register(fx: Effects, d: str, s: str) -> None:
    """R0.L = CC = BXORSHIFT (A0, R1)."""
    _write_cc(fx, d, _folded(fx, fx.read(s).shift_right(1).zero_extended(64)))
    fx.write("A0", fx.read("A0").shift_left(1))


def bxor_register(fx: Effects, d: str, s: str) -> None:
    """R0.L = CC = BXOR (A0, R1)."""
    _write_cc(fx, d, _folded(fx, fx.read(s).zero_extended(64)))


def bxorshift(fx: Effects) -> None:
    """A0 = BXORSHIFT (A0, A1, CC)."""
    bit = fx.read("CC") ^ _folded(fx, fx.read("A1"))
    fx.write("A0", fx.read("A0").shift_left(1) | bit.zero_extended(64))


def bxor(fx: Effects, d: str) -> None:
    """R0.L = CC = BXOR (A0, A1, CC)."""
    _write_cc(fx, d, fx.read("CC") ^ _folded(fx, fx.read("A1")))
