"""Short loops that may end early are written out, as those that do not, where the code does not grow. Without, an estimate is up to 392 % too dear."""

from __future__ import annotations

from tests.kernel.beside_gcc import beside_gcc


def search(loop: str, start: str = "k = 0") -> str:
    """A kernel that seeks in a short table for each element."""
    return f"""
    def f(a: u8[:], b: i16[:], o: u8[:], n: i32, t: i32) -> None:
        for i in range(n):
            v = a[i] * 2
            {start}
            {loop}
            o[i] = k
    """


CASES = {
    "two steps": (search("while k < 2 and v > b[k]: k += 1"), 2039, 0.1),
    "three": (search("while k < 3 and v > b[k]: k += 1"), 2639, 0.08),
    "four": (search("while k < 4 and v > b[k]: k += 1"), 4993, 0.01),
    "three that end with a product": (search("while k < 3 and v * 8 > t * b[k]: k += 1"), 4438, 0.05),
    "twelve stay a loop": (search("while k < 12 and v > b[k]: k += 1"), 10421, 0.01),
    "downwards": (search("while k > 0 and v < b[k]: k -= 1", "k = 3"), 4115, 0.05),
}
test_short_searches_are_near_what_gcc_makes, test_short_searches_are_what_runs = beside_gcc(CASES)
