"""Bits whose number is computed: the value is shifted, and tested without a mask. Without, an estimate is up to 9 % off."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def bits(test: str, before: str = "") -> str:
    """A kernel that goes through the bits of a stream of bytes."""
    return f"""
    def f(a: i32[:], b: u8[:], o: i32[:], n: i32, t: i32) -> None:
        k = 0
        for i in range(n):
            {before or "pass"}
            if {test}:
                k += a[i]
            else:
                k ^= a[i]
            o[i] = k
    """


CASES = {
    "shifted down": (bits("(b[i >> 3] >> (i & 7)) & 1"), 3942, 0.01),
    "from the highest one": (bits("(b[i >> 3] >> (7 - (i & 7))) & 1"), 4142, 0.01),
    "a mask in the test": (bits("b[i >> 3] & (1 << (i & 7))"), 3942, 0.01),
    "a mask with a name stays one, and the 1 is copied": (
        bits("b[i >> 3] & mask", "mask = 1 << (i & 7)"),
        4543,
        0.05,
    ),
    "the same bit each time is a mask before the loop": (bits("(b[i] >> (t & 7)) & 1"), 3155, 0.01),
    "a number that the source masks": (bits("(a[i >> 5] >> (i & 31)) & 1"), 3915, 0.01),
    "a number that nobody masks": (bits("(t >> (b[i] >> 3)) & 1"), 3423, 0.01),
}
test_shifted_bits_are_near_what_gcc_makes, test_shifted_bits_are_what_runs = beside_gcc(CASES)
