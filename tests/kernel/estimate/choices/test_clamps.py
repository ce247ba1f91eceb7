"""Values that are limited, some by what is computed for that. Without, an estimate is up to 128 % too dear, or 26 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def limited(parameters: str, value: str, *limits: str, result: str = "o[i] = v") -> str:
    """A kernel that limits each value."""
    rows = "\n            ".join(limits)
    return f"""
    def f({parameters}, n: i32, t: i32) -> i32:
        s = 0
        for i in range(n):
            v = {value}
            {rows}
            {result}
        return s
    """


HALVES, WORDS, BYTES = "a: i16[:], o: i16[:]", "a: i32[:], o: i32[:]", "a: u8[:], o: u8[:]"
UPWARDS = ("if v < 0:", "    v = 0", "elif v > 255:", "    v = 255")
DOWNWARDS = ("if v > 255:", "    v = 255", "elif v < 0:", "    v = 0")
LAST = ("if v >= t:", "    v = t - 1")
CASES = {
    "half-words on both sides": (limited(HALVES, "a[i] >> 2", *UPWARDS), 1044, 0.01),
    "the larger ones first": (limited(HALVES, "a[i] >> 2", *DOWNWARDS), 1044, 0.01),
    "words on both sides": (limited(WORDS, "a[i] >> 2", *UPWARDS), 1044, 0.01),
    "the last place is computed before the loop": (limited(HALVES, "a[i]", *LAST), 1045, 0.01),
    "of bytes, too": (limited(BYTES, "a[i]", *LAST), 1015, 0.01),
    "of words it is not": (limited(WORDS, "a[i]", *LAST), 2069, 0.01),
    "nor behind another limit": (limited(HALVES, "a[i]", "if v < 0:", "    v = 0", *LAST), 2353, 0.04),
    "what is computed on either side": (limited(HALVES, "5", "if a[i] > t:", "    v = t + 3"), 1044, 0.01),
    "a sum as limit is none": (
        limited(WORDS, "a[i] + 3", "if v > t - 1:", "    v = t - 1", result="s += o[v & 127]"), 3272, 0.03,
    ),
    "but one that has a name": (
        limited(WORDS, "a[i] + 3", "last = t - 1", "if v > last:", "    v = last", result="s += o[v & 127]"), 1846, 0.03,
    ),
}  # fmt: skip
test_limits_are_near_what_gcc_makes, test_limits_are_what_runs = beside_gcc(CASES)
