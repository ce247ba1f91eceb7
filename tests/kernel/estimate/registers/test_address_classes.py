"""Addresses of a few bytes, added in data or in pointer registers. Without, an estimate is up to 18 % too cheap, or 156 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def bytes_of(body: str, parameters: str = "a: u8[:], n: i32, t: i32") -> str:
    """A kernel of one line."""
    return f"""
    def f({parameters}) -> i32:
        {body}
    """


TWO = "a: u8[:], b: u8[:], n: i32, t: i32"
CASES = {
    "one access: the sum moves": (bytes_of("return a[n]"), 9, 0.01),
    "two accesses by one sum: the array and the index move": (bytes_of("return a[n] + a[n + 1]"), 11, 0.01),
    "three accesses": (bytes_of("return a[n] + a[n + 1] + a[n + 2]"), 13, 0.01),
    "two elements": (bytes_of("return a[n] + a[t]"), 13, 0.01),
    "two elements with computed indices: their sums move": (bytes_of("return a[n >> 1] + a[t >> 1]"), 14, 0.01),
    "an element and the next, twice": (bytes_of("return a[n] + a[t] + a[n + 1] + a[t + 1]"), 17, 0.01),
    "neighbours": (bytes_of("return a[n + 1] - a[n - 1]"), 11, 0.01),
    "an index that is stored": (bytes_of("a[n] = n; return 0"), 10, 0.01),
    "an element of an element": (bytes_of("return a[a[n]]"), 12, 0.01),
    "two arrays with one index": (bytes_of("return a[n] + b[n]", TWO), 13, 0.01),
    "from one array to another: an argument waits in its data register": (bytes_of("a[n] = b[t]; a[n + 1] = b[t + 1]; return 0", TWO), 16, 0.01),
}  # fmt: skip
test_address_classes_are_near_what_gcc_makes, test_address_classes_are_what_runs = beside_gcc(CASES)
