"""Factors that GCC knows to be narrow, and others that LLVM knows to be. Without, an estimate is up to 189 % too dear, or 66 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def product(kind: str, result: str, *before: str) -> str:
    """A kernel that computes products of the elements of an array, behind the statements `before`."""
    body = "\n            ".join((*before, f"b[i] = {result}"))
    return f"""
    def f(a: {kind}[:], b: i32[:], n: i32) -> i32:
        for i in range(n):
            {body}
        return 0
    """


CASES = {
    "bits of a half-word": (product("u16", "(a[i] & 31) * 232"), 844, 0.01),
    "bits of a variable that is used twice": (product("u16", "s * 77 + v", "v = i32(a[i])", "s = v & 15"), 1244, 0.01),
    "bits of a byte are extended for the product": (product("u8", "(a[i] & 31) * 232"), 1014, 0.01),
    "two masks of a byte": (product("u8", "(v & 15) * (v & 3)", "v = i32(a[i])"), 1414, 0.01),
    "three colours": (
        product("u16", "((a[i] & 31) * 77 + (a[i + 1] & 31) * 150 + (a[i + 2] & 31) * 29) >> 8"), 2645, 0.01,
    ),
    "two half-words are not extended for their products": (product("u16", "a[i] * 77 + a[i + 1] * 150"), 1244, 0.01),
    "a bit that is set in a byte": (product("u8", "(a[i] | 1) * 77"), 1013, 0.01),
    "the upper half of an element": (product("u16", "(a[i] >> 8) * 77"), 842, 0.01),
    "bits of an element that is shifted": (product("u16", "((a[i] >> 3) & 15) * 77"), 1044, 0.01),
    "a shifted variable is a word": (product("u8", "s * 77", "v = i32(a[i])", "s = v >> 3"), 1837, 0.01),
    "an element that is shifted with its sign": (product("i8", "(a[i] >> 3) * 77"), 1013, 0.01),
    "a number that fits a half-word": (product("u16", "a[i] * 40000"), 642, 0.01),
    "a number that fits no byte": (product("u8", "a[i] * 300"), 1637, 0.01),
    "a difference is a word": (product("u8", "(255 - a[i]) * a[i + 1]"), 1413, 0.01),
    "a product is a word": (product("i16", "((a[i] & 7) * (a[i + 1] & 7)) * 19"), 2042, 0.11),
}  # fmt: skip
test_narrow_factors_are_near_what_gcc_makes, test_narrow_factors_are_what_runs = beside_gcc(CASES)
