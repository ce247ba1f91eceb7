"""Words, their halves and their bytes, as Python's integers: the means by which intrinsics are written in Python."""

from __future__ import annotations


def nearest(number: int, bits: int) -> int:
    """Return a number in `bits` bits with sign: the nearest one if it does not fit."""
    most = (1 << bits - 1) - 1
    return min(max(number, -most - 1), most)


def signed(number: int, bits: int = 32) -> int:
    """Return the lowest bits of a number, the highest of them its sign."""
    sign = 1 << bits - 1
    return (number & 2 * sign - 1 ^ sign) - sign


def low(word: int) -> int:
    """Return the lower half of a word, with its sign."""
    return signed(word, 16)


def high(word: int) -> int:
    """Return the upper half of a word, with its sign."""
    return signed(word >> 16, 16)


def halves(upper: int, lower: int) -> int:
    """Return a word of two halves."""
    return signed(upper << 16 | lower & 0xFFFF)


def octets(word: int) -> tuple[int, int, int, int]:
    """Return the four bytes of a word, lowest first, without signs."""
    b0, b1, b2, b3 = (word & 0xFFFFFFFF).to_bytes(4, "little")
    return b0, b1, b2, b3


def of_octets(b0: int, b1: int, b2: int, b3: int) -> int:
    """Return a word of the lowest bytes of four numbers, lowest first."""
    return signed((b3 & 255) << 24 | (b2 & 255) << 16 | (b1 & 255) << 8 | b0 & 255)


def count(number: int) -> int:
    """Return how far a register shifts to the left: its lowest six bits, with their sign."""
    return signed(number, 6)


def sign_bits(number: int, bits: int) -> int:
    """Return how many bits below the sign of a number repeat it."""
    return bits - 1 - (number ^ number >> bits - 1).bit_length()
