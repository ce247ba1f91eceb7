"""What every way from a test computes or loads comes before it, also where one way leads to a join that does, and another one brings it.

Without, gaps were 47 % too cheap, and what both sides and the join load 13 % too dear.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

GAPS = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    widest = 0
    begin = 0
    where = 0
    for i in range(n):
        if a[i] < t:
            if i - begin > widest:
                widest = i - begin
                where = begin
            begin = i + 1
    return where * 256 + widest
"""
LOADS = """
def f(a: i16[:], o: i16[:], n: i32, t: i32) -> i32:
    s = 0
    k = 0
    for i in range(n):
        if a[i] > t:
            s += o[i]
        else:
            k -= o[i]
        s ^= o[i]
    return s + k
"""
CASES = {
    "loads": (LOADS, 2960, 0.02),
    "the widest gap": (GAPS, 5072, 0.03),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
