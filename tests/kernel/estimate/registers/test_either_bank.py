"""Values that may be in either bank of registers: where one is full, they give way. Without this, an estimate is up to 20 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

CASES = {
    "a selection sort": (
        """
        def f(b: i16[:], n: i32) -> i32:
            for i in range(n - 1):
                m = i
                for j in range(i + 1, n):
                    if b[j] < b[m]:
                        m = j
                if m != i:
                    v = b[i]
                    b[i] = b[m]
                    b[m] = v
            return 0
        """,
        123233,
        0.01,
    ),
}

test_either_bank_is_near_what_gcc_makes_of_it, test_either_bank_is_what_runs = beside_gcc(CASES)
