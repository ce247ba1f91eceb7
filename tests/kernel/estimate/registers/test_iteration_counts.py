"""What computes how often a loop iterates, and the registers that this takes. Without, an estimate of 40 turns is up to 24 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def loop(parameters: str, statement: str, turns: str = "len(a)") -> str:
    """A kernel with one loop."""
    return f"""
    def f({parameters}) -> None:
        for i in range({turns}):
            {statement}
    """


TWO = "a: i16[:], b: i16[:]"
CASES = {
    "a length in a register is moved beside its shift": (loop(TWO, "b[i] = a[i] + 1"), 808, 0.005),
    "so is a number": (loop(f"{TWO}, n: i32", "b[i] = a[i] + 1", "n"), 640, 0.005),
    "and of words": (loop("a: i32[:], b: i16[:]", "b[i] = a[i] + 1"), 808, 0.005),
    "of every second byte": (loop("a: u8[:], b: u8[:], t: i32", "b[i] = a[2 * i]", "t"), 340, 0.005),
    "a number of the source is loaded": (loop("a: u8[:], b: u8[:]", "b[i] = a[2 * i]", "100"), 309, 0.01),
    "bytes are not shifted": (loop("a: u8[:], b: u8[:]", "b[i] = a[i] + 1"), 779, 0.005),
    "the first pointer is compared, here one of bytes": (loop("a: u8[:], b: i16[:]", "b[i] = a[i] + 1"), 779, 0.005),
    "and here one of half-words": (loop("a: u8[:], b: i16[:]", "b[i] += a[i]"), 1064, 0.005),
    "a counter that is wanted is compared itself": (loop(TWO, "b[i] = a[i] + i"), 1036, 0.005),
    "a length on the stack is loaded where it is shifted": (loop(f"{TWO}, t: i32", "b[i] = max(a[i], t)"), 784, 0.005),
    "one that an address takes is in a pointer register": (loop(TWO, "b[len(a) - 1 - i] = a[i]"), 528, 0.01),
    "a step of two is no shift to the left": (loop("a: u8[:], b: u8[:]", "b[i] = a[i + 1]", "0, len(a) - 1, 2"), 527, 0.01),
    "three pointers and the count": (loop("a: u8[:], b: u8[:], c: u8[:]", "c[i] = a[i] + b[i]"), 1061, 0.005),
}  # fmt: skip
test_counts_are_near_what_gcc_makes, test_counts_are_what_runs = beside_gcc(CASES)
