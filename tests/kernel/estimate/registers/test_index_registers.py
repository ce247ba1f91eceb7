"""Pointers to half-words in index registers, by which nothing is extended as it is loaded. Without, an estimate is up to 19 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def rows(parameters: str, result: str) -> str:
    """A kernel that computes each element of one row of others."""
    return f"""
    def f({parameters}) -> None:
        for i in range(n):
            d[i] = {result}
    """


THREE = "a: i16[:], b: i16[:], c: i16[:], d: i32[:], n: i32"
CASES = {
    "two arrays and a result fill the registers": (
        rows("a: i16[:], b: i16[:], d: i32[:], n: i32", "a[i] + b[i]"), 1016, 0.01,
    ),
    "three arrays": (rows(THREE, "c[i] - a[i] - b[i]"), 1442, 0.02),
    "three arrays without signs": (rows(THREE.replace("i16", "u16"), "c[i] - a[i] - b[i]"), 1442, 0.02),
    "two pointers do not": (rows(THREE, "2 * a[i] - c[i]"), 1041, 0.03),
    "sums in pointer registers come first": (rows(THREE, "c[i] + 4 * a[i] + b[i]"), 2242, 0.01),
    "a fourth array is in a register that is saved": (
        rows("a: i16[:], b: i16[:], c: i16[:], e: i16[:], d: i32[:], n: i32", "a[i] + b[i] + c[i] - e[i]"), 1843, 0.01,
    ),
    "what stays narrow is not extended": (
        rows("d: i16[:], a: i16[:], b: i16[:], c: i16[:], n: i32", "a[i] + b[i] - c[i]"), 1242, 0.02,
    ),
    "bytes have no such loads": (
        rows("a: u8[:], b: u8[:], c: u8[:], d: i32[:], n: i32", "c[i] - a[i] - b[i]"), 1238, 0.01,
    ),
    "a start behind the first element": (rows(THREE, "a[i + 1] - b[i + 1] + c[i + 1]"), 1445, 0.02),
}  # fmt: skip
test_index_registers_are_near_what_gcc_makes, test_index_registers_are_what_runs = beside_gcc(CASES)
