"""Elements of one of two arrays: each side of the test loads its own. Without, an estimate is up to 74 % too cheap."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc

CASES = {
    "steps in a tree": (
        """
        def f(a: u8[:], left: u8[:], right: u8[:], o: u8[:], n: i32) -> None:
            node = 0
            for i in range(n):
                if a[i] > 100:
                    node = right[node]
                else:
                    node = left[node]
                o[i] = node
        """, 3518, 0.06),
    "what is copied": (
        """
        def f(a: u8[:], b: u8[:], c: u8[:], o: u8[:], n: i32) -> None:
            for i in range(n):
                if a[i] > 100:
                    o[i] = b[i]
                else:
                    o[i] = c[i]
        """, 3318, 0.01),
    "what is added": (
        """
        def f(a: u8[:], b: i16[:], c: i16[:], n: i32) -> i32:
            s = 0
            for i in range(n):
                if a[i] > 100:
                    s += b[a[i]]
                else:
                    s += c[a[i]]
            return s
        """, 6110, 0.07),
    "one side alone": (
        """
        def f(a: u8[:], b: i16[:], n: i32) -> i32:
            s = 0
            for i in range(n):
                if a[i] > 100:
                    s += b[a[i]]
            return s
        """, 4989, 0.01),
    "two elements of one array": (
        """
        def f(a: i16[:], n: i32, t: i32) -> i32:
            if t > 3:
                return a[n]
            return a[t]
        """, 20, 0.01),
}  # fmt: skip
test_chosen_arrays_are_near_what_gcc_makes, test_chosen_arrays_are_what_runs = beside_gcc(CASES)
