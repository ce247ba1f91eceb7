"""Starts of the pointers of a loop in another one, which that steps. Without, an estimate is up to 18 % off."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def picture(parameters: str, statement: str, rows: str = "h", columns: str = "w") -> str:
    """A kernel that goes through a picture."""
    return f"""
    def f({parameters}, n: i32, t: i32) -> i32:
        w = n >> 4
        h = t >> 4
        s = 0
        for y in range({rows}):
            for x in range({columns}):
                {statement}
        return s
    """


BYTES, HALVES = "a: u8[:], b: u8[:]", "a: i16[:], b: i16[:]"
CASES = {
    "one array": (picture("a: u8[:]", "s += a[y * w + x]"), 242, 0.02),
    "two arrays of bytes share what is stepped": (picture(BYTES, "b[y * w + x] = a[y * w + x] + 1"), 322, 0.02),
    "arrays of half-words do not": (picture(HALVES, "b[y * w + x] = a[y * w + x] + 1"), 338, 0.04),
    "bytes and half-words": (picture("a: u8[:], b: i16[:]", "b[y * w + x] = a[y * w + x] + 1"), 335, 0.02),
    "rows of a known width": (picture(BYTES, "b[y * 16 + x] = a[y * 16 + x]", "12", "10"), 361, 0.02),
    "half-words in such": (picture(HALVES, "b[y * 16 + x] = a[y * 16 + x]", "12", "10"), 360, 0.02),
    "a table beside": (picture("a: u8[:], b: i16[:]", "s += a[y * w + x] * b[x]", columns="5"), 225, 0.02),
    "a filter": (picture(HALVES, "s += a[y + x] * b[x]"), 398, 0.02),
    "columns": (picture(BYTES, "s += a[x * w + y]"), 284, 0.05),
}  # fmt: skip
test_row_pointers_are_near_what_gcc_makes, test_row_pointers_are_what_runs = beside_gcc(CASES)
