"""What is loaded of a choice is chosen too, where some ways have it already. Without, sifting was 13 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

SIFT = """
def f(h: i32[:], n: i32) -> i32:
    root = 0
    value = h[0]
    child = 1
    while child < n:
        if child + 1 < n and h[child + 1] > h[child]:
            child += 1
        if h[child] <= value:
            break
        h[root] = h[child]
        root = child
        child = 2 * root + 1
    h[root] = value
    return root
"""
CASES = {"sifting": (SIFT, 82, 0.05)}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_is_what_runs = beside_gcc(CASES)
