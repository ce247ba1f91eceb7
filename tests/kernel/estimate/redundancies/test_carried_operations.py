"""Operations that the iteration before has done already. Without, an estimate is up to 16 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def filtered(parameters: str, first: str, *statements: str) -> str:
    """A kernel with a mean that goes along."""
    rows = "\n            ".join(statements)
    return f"""
    def f({parameters}, n: i32) -> i32:
        m = {first}
        for i in range(n):
            {rows}
        return m
    """


HALVES = "a: u16[:], o: u16[:]"
CASES = {
    "a mean that is stored": (filtered(HALVES, "0", "m += a[i] - (m >> 4)", "o[i] = m >> 4"), 1044, 0.01),
    "of words": (filtered("a: i32[:], o: i32[:]", "0", "m += a[i] - (m >> 3)", "o[i] = m >> 3"), 1044, 0.01),
    "from what was loaded": (filtered(HALVES, "a[0] << 4", "m += a[i] - (m >> 4)", "o[i] = m >> 4"), 1045, 0.01),
    "another shift is another operation": (filtered(HALVES, "0", "m += a[i] - (m >> 4)", "o[i] = m >> 3"), 1242, 0.01),
    "what some iterations do is not": (
        filtered(HALVES, "0", "m += a[i] - (m >> 4)", "if a[i] & 1:", "    o[i] = m >> 4"), 3281, 0.07,
    ),
}  # fmt: skip
test_operations_are_near_what_gcc_makes, test_operations_are_what_runs = beside_gcc(CASES)
