"""The video instructions: four bytes of each of two register pairs at once, aligned by I0 and I1; none touches a flag.

Each lets the loads beside it ignore the lowest two bits of their addresses.
"""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.results import half, join, part
from bfsim.blackfin.instructions.semantics.saturation import saturated_unsigned
from bfsim.blackfin.instructions.value import Value

PAIRS = {"R1:0": ("R1", "R0"), "R3:2": ("R3", "R2")}


def disalgnexcpt(fx: Effects) -> None:
    """Let the loads beside this ignore the lowest two bits of their addresses."""
    fx.aligns = True


def _aligned(fx: Effects, pair: str, index: str, reverse: int) -> Value:
    """Return four of the eight bytes of a pair, from the number in the lowest bits of I0 or I1 on; (R) exchanges the registers."""
    fx.aligns = True
    upper, lower = map(fx.read, PAIRS[pair][::-1] if reverse else PAIRS[pair])
    first = (fx.read(index) & 3).zero_extended(64).shift_left(3)
    return join(upper, lower).shift_right(first).low(32)


def _bytes(four: Value) -> list[Value]:
    """Return four bytes, lowest first, in 16 bits each."""
    return [part(four, first, 8).zero_extended(16) for first in (0, 8, 16, 24)]


def _operands(fx: Effects, s: str, t: str, q: int) -> list[tuple[Value, Value]]:
    """Return four pairs of bytes, lowest first, in 16 bits each."""
    return list(zip(_bytes(_aligned(fx, s, "I0", q)), _bytes(_aligned(fx, t, "I1", q)), strict=True))


def _of_bytes(numbers: list[Value]) -> Value:
    """Return the lowest bytes of four numbers, lowest first."""
    b0, b1, b2, b3 = (each.low(8) for each in numbers)
    return join(join(b3, b2), join(b1, b0))


def _write_halves(fx: Effects, d: str, e: str, halves: list[Value]) -> None:
    fx.write(d, join(halves[1], halves[0]))
    fx.write(e, join(halves[3], halves[2]))


def byteop1p(fx: Effects, d: str, s: str, t: str, q: int, up: int) -> None:
    """R0 = BYTEOP1P (R1:0, R3:2): means; a half goes up, or with (T) down."""
    fx.write(d, _of_bytes([(one + other + up).shift_right(1) for one, other in _operands(fx, s, t, q)]))


def byteop2p(fx: Effects, d: str, s: str, t: str, q: int, c: int, h: int) -> None:
    """R0 = BYTEOP2P (R1:0, R3:2) (RNDL): means of two by two bytes, all aligned by I0, as the low or high bytes of halves."""
    first, second = (_bytes(_aligned(fx, pair, "I0", q)) for pair in (s, t))
    up = 0 if c else 2
    totals = [first[place] + first[place + 1] + second[place] + second[place + 1] + up for place in (2, 0)]
    fx.write(d, join(*(each.shift_right(2).shift_left(8 * h) for each in totals)))


def byteop3p(fx: Effects, d: str, s: str, t: str, q: int, h: int) -> None:
    """R0 = BYTEOP3P (R1:0, R3:2) (LO): halves plus bytes, clipped to bytes, as the low or high bytes of halves."""
    halves, octets = _aligned(fx, s, "I0", q), _aligned(fx, t, "I1", q)
    results = []
    for place in (16, 0):
        octet = part(octets, place + 8 - 8 * h, 8)
        total = part(halves, place, 16).sign_extended(18) + octet.zero_extended(18)
        results.append(total.larger(0).smaller(255).low(16).shift_left(8 * h))
    fx.write(d, join(*results))


def byteop16p(fx: Effects, d: str, e: str, s: str, t: str, q: int) -> None:
    """(R0, R1) = BYTEOP16P (R3:2, R1:0): four sums."""
    _write_halves(fx, d, e, [one + other for one, other in _operands(fx, s, t, q)])


def byteop16m(fx: Effects, d: str, e: str, s: str, t: str, q: int) -> None:
    """(R0, R1) = BYTEOP16M (R3:2, R1:0): four differences."""
    _write_halves(fx, d, e, [one - other for one, other in _operands(fx, s, t, q)])


def bytepack(fx: Effects, d: str, s: str, t: str) -> None:
    """R0 = BYTEPACK (R1, R2): the low bytes of four halves."""
    fx.aligns = True
    fx.write(d, _of_bytes([half(fx, register, high) for register in (s, t) for high in (0, 1)]))


def byteunpack(fx: Effects, d: str, e: str, s: str, q: int) -> None:
    """(R0, R1) = BYTEUNPACK R3:2: four bytes as halves."""
    _write_halves(fx, d, e, _bytes(_aligned(fx, s, "I0", q)))


def saa(fx: Effects, s: str, t: str, q: int) -> None:
    """SAA (R1:0, R3:2): add four distances of bytes to the halves of A0 and A1, which saturate without sign."""
    sums = []
    for place, (one, other) in enumerate(_operands(fx, s, t, q)):
        distance = one.below(other).choose(other - one, one - other)
        before = part(fx.read(f"A{place // 2}"), 16 * (place % 2), 16)
        sums.append(saturated_unsigned(before.zero_extended(17) + distance.zero_extended(17), 16)[0])
    fx.write("A0", join(sums[1], sums[0]).zero_extended(64))
    fx.write("A1", join(sums[3], sums[2]).zero_extended(64))
