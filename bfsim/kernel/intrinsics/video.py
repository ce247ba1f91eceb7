"""Four bytes at once, as Python has them: the functions of VisualDSP++'s `video.h`, and `ones` and `clip`.

In VisualDSP++ the operands are eight bytes and a pointer whose lowest bits say which four of them are meant. Here they
are just these four, a word: `align8`, `align16` and `align24` take it from two. The lowest byte of a word is the first
in memory. Functions with two results return both, the upper one first.
"""

from __future__ import annotations

from bfsim.kernel.intrinsics.halves import halves, high, low, nearest, octets, of_octets, signed

MOST = 0xFFFF  # of a half without sign


def _pairs(x: int, y: int) -> list[tuple[int, int]]:
    return list(zip(octets(x), octets(y), strict=True))


def _both(b0: int, b1: int, b2: int, b3: int) -> tuple[int, int]:
    return halves(b3, b2), halves(b1, b0)


def _aligned(x: int, y: int, by: int) -> int:
    return signed(((x & 0xFFFFFFFF) << 32 | y & 0xFFFFFFFF) >> by)


def align8(x: int, y: int) -> int:
    """Return the lowest byte of x above the upper three of y."""
    return _aligned(x, y, 8)


def align16(x: int, y: int) -> int:
    """Return the lower two bytes of x above the upper two of y."""
    return _aligned(x, y, 16)


def align24(x: int, y: int) -> int:
    """Return the lower three bytes of x above the highest of y."""
    return _aligned(x, y, 24)


def bytepack(x: int, y: int) -> int:
    """Return the low bytes of four halves: those of y above those of x."""
    return of_octets(low(x), high(x), low(y), high(y))


def byteunpack(x: int) -> tuple[int, int]:
    """Return four bytes as halves: the upper two, and the lower two."""
    return _both(*octets(x))


def add_i4x8(x: int, y: int) -> tuple[int, int]:
    """Return four sums of bytes as halves: the upper two, and the lower two (BYTEOP16P)."""
    b0, b1, b2, b3 = (one + other for one, other in _pairs(x, y))
    return _both(b0, b1, b2, b3)


def sub_i4x8(x: int, y: int) -> tuple[int, int]:
    """Return four differences of bytes as halves: the upper two, and the lower two (BYTEOP16M)."""
    b0, b1, b2, b3 = (one - other for one, other in _pairs(x, y))
    return _both(b0, b1, b2, b3)


def avg_i4x8(x: int, y: int) -> int:
    """Return four means of bytes, rounded up (BYTEOP1P)."""
    b0, b1, b2, b3 = (one + other + 1 >> 1 for one, other in _pairs(x, y))
    return of_octets(b0, b1, b2, b3)


def avg_i4x8_t(x: int, y: int) -> int:
    """Return four means of bytes, truncated (BYTEOP1P)."""
    b0, b1, b2, b3 = (one + other >> 1 for one, other in _pairs(x, y))
    return of_octets(b0, b1, b2, b3)


def _squares(x: int, y: int, up: int) -> tuple[int, int]:
    """Return the means of the upper and of the lower two by two bytes."""
    b0, b1, b2, b3 = (one + other for one, other in _pairs(x, y))
    return b2 + b3 + up >> 2, b0 + b1 + up >> 2


def avg_i2x8_lo(x: int, y: int) -> int:
    """Return the means of two by two bytes, rounded, as the low bytes of two halves (BYTEOP2P)."""
    return halves(*_squares(x, y, 2))


def avg_i2x8_lot(x: int, y: int) -> int:
    """Return the means of two by two bytes, truncated, as the low bytes of two halves (BYTEOP2P)."""
    return halves(*_squares(x, y, 0))


def avg_i2x8_hi(x: int, y: int) -> int:
    """Return the means of two by two bytes, rounded, as the high bytes of two halves (BYTEOP2P)."""
    upper, lower = _squares(x, y, 2)
    return halves(upper << 8, lower << 8)


def avg_i2x8_hit(x: int, y: int) -> int:
    """Return the means of two by two bytes, truncated, as the high bytes of two halves (BYTEOP2P)."""
    upper, lower = _squares(x, y, 0)
    return halves(upper << 8, lower << 8)


def _clipped(number: int) -> int:
    return min(max(number, 0), 255)


def addclip_lo(x: int, y: int) -> int:
    """Return two halves plus bytes 3 and 1 of y, clipped to bytes, as the low bytes of two halves (BYTEOP3P)."""
    _, b1, _, b3 = octets(y)
    return halves(_clipped(high(x) + b3), _clipped(low(x) + b1))


def addclip_hi(x: int, y: int) -> int:
    """Return two halves plus bytes 2 and 0 of y, clipped to bytes, as the high bytes of two halves (BYTEOP3P)."""
    b0, _, b2, _ = octets(y)
    return halves(_clipped(high(x) + b2) << 8, _clipped(low(x) + b0) << 8)


def saa(x: int, y: int, upper: int, lower: int) -> tuple[int, int]:
    """Return four sums of distances: `upper` and `lower` are halves without signs, to which the distances of the bytes are added."""
    before = [number & MOST for number in (lower, lower >> 16, upper, upper >> 16)]
    b0, b1, b2, b3 = (
        min(old + abs(one - other), MOST) for old, (one, other) in zip(before, _pairs(x, y), strict=True)
    )
    return _both(b0, b1, b2, b3)


def ones(x: int) -> int:
    """Return how many bits are set."""
    return (x & 0xFFFFFFFF).bit_count()


def clip(x: int, limit: int) -> int:
    """Return x, or what is nearest to it between the absolute value of `limit` and minus that."""
    most = nearest(abs(limit), 32)
    return max(min(x, most), -most)
