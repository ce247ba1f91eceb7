"""How loops go round and end: by `continue`, around loops that few iterations come to, over windows, and by a `break` at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2
from bfsim.kernel.emitting.subloops import makes_subloop
from bfsim.kernel.language import tree
from bfsim.kernel.operations import Op
from tests.kernel.beside_gcc import beside_gcc
from tests.kernel.lowered import lowered
from tests.kernel.modules import kernel_of

SKIPPING = """
def f(a: u8[:], o: u8[:], n: i32) -> i32:
    k = 0
    x = 0
    while x < n:
        if a[x] < {0}:
            x += 1
            continue
        {1}
        k += 1
    return k
"""
RUN = """o[k] = x
        while x < n and a[x] >= 128:
            x += 1"""
PIXEL = """o[k] = a[x]
        x += 2"""
WORD = """v = 0
        while x < n and a[x] >= 40:
            v = (v * 10 + a[x] - 48) & 4095
            x += 1
        o[k] = v"""
RUNS_IN_ROWS = """
def f(a: u8[:], o: u8[:], n: i32) -> i32:
    k = 0
    w = n >> 3
    for y in range(8):
        x = 0
        while x < w:
            if a[y * w + x] < 128:
                x += 1
                continue
            if k == 200:
                return -1
            o[k] = x
            while x < w and a[y * w + x] >= 128:
                x += 1
            k += 1
    return k
"""
WINDOW = """
def f(a: u8[:], c: u8[:], n: i32) -> i32:
    w = n >> 4
    s = 0
    x0 = c[0] & 3
    y0 = c[1] & 3
    for y in range(y0, y0 + w - 4):
        for x in range(x0, x0 + w - 4):
            {}
    return s
"""
MOMENT = """p = a[y * w + x]
            if p > 100:
                s += x * p"""
AROUND = """
def f(a: u8[:], o: u8[:], n: i32) -> None:
    r = n >> 5
    for x in range(r, n - r):
        s = 0
        for k in range(x - r, x + r + 1):
            s += a[k]
        o[x] = s >> 3
"""
MATCHED = """
def f(a: u32[:], b: u32[:], o: i16[:], t: i32, n: i32) -> None:
    m = n >> 5
    w = t & 15
    for q in range(m):
        best = 1 << 30
        second = 1 << 30
        for p in range(m):
            d = 0
            for k in range(w):
                v = a[q * w + k] ^ b[p * w + k]
                v = v - ((v >> 1) & 0x55555555)
                v = (v & 0x33333333) + ((v >> 2) & 0x33333333)
                v = (v + (v >> 4)) & 0x0F0F0F0F
                d += i32((v * 0x01010101) >> 24)
                if d >= second:
                    break
            if d < best:
                second = best
                best = d
            elif d < second:
                second = d
        o[q] = second - best
"""
HISTOGRAM = """
def f(a: u8[:], h: u16[:], n: i32) -> i32:
    s = 0
    for x in range(n):
        v = a[x]
        h[v] += 1
        {}
    return s
"""

# Without these rules estimates are off by up to 100 %.
CASES = {
    "runs": (SKIPPING.format(128, RUN), 3374, 0.02),
    "skipped": (SKIPPING.format(128, PIXEL), 2586, 0.02),
    "words": (SKIPPING.format(40, WORD), 3469, 0.08),
    "runs in rows": (RUNS_IN_ROWS, 3829, 0.02),
    "the sum of a window": (WINDOW.format("s += a[y * w + x]"), 258, 0.1),
    "the moment of a window": (WINDOW.format(MOMENT), 1039, 0.05),
    "around a pixel": (AROUND, 7378, 0.03),
    "a histogram": (HISTOGRAM.format("s += v"), 1838, 0.02),
    "a histogram of some": (HISTOGRAM.format("s = max(s, v)"), 1838, 0.02),
}


test_estimates_are_near_what_gcc_makes, test_they_compute_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 2, 17, 90)
)


TAKEN = """
def f(a: u8[:], o: i16[:], n: i32) -> i32:
    top = n
    found = 0
    while top > 0:
        {}
    return found
"""


@pytest.mark.parametrize(
    ("body", "is_one"),
    [
        ("top -= 1\n        if a[top] > 9: continue\n        found += 1\n        top -= 1", True),
        ("top -= 1\n        if a[top] > 9: continue\n        found += 1", False),
        ("top -= 1\n        if a[top] > 9: continue\n        if found > 3: top -= 1", False),
        ("top -= 1\n        if a[top] > 9: continue\n        if found > 3: top -= 1\n        found += 1", True),
        ("top -= 1\n        p = a[top]\n        if p > 9: continue\n        found += p\n        top -= 1", True),
        ("top -= 1\n        found = a[top]\n        if found > 9: continue\n        top -= 1", False),
        ("top -= 1\n        found = 1\n        if a[top] > 9: continue\n        top -= 1", True),
        ("top -= 1\n        o[top] = 1\n        if a[top] > 9: continue\n        top -= 1", False),
        ("if a[top] > 9:\n            top -= 1\n            continue\n        top -= 2", False),
        ("top -= 1", False),
    ],
)  # fmt: skip
def test_a_continue_makes_two_loops_if_all_it_hands_on_changes_later(
    body: str, is_one: bool, tmp_path: Path
) -> None:
    """On each other way back: what does not is the same variable of one loop. Numbers, and what no iteration takes up, do not count."""
    block = tree.body_of(kernel_of(TAKEN.format(body), tmp_path).function).block
    (loop,) = [each for each in block if isinstance(each, tree.While)]
    assert makes_subloop(loop, block) is is_one


def test_a_window_s_column_is_counted_beside_the_pointer(tmp_path: Path) -> None:
    """The pointer less the row's address gives the column of a row that begins at 0: one operation where it is wanted, and no step."""
    whole = WINDOW.format(MOMENT).replace("range(x0, x0 + w - 4)", "range(w)")
    assert "range(w)" in whole
    window = lowered(WINDOW.format(MOMENT), tmp_path, GCC_O2)
    assert (window[Op.LOOP_SETUP], lowered(whole, tmp_path, GCC_O2)[Op.LOOP_SETUP]) == (2, 1)


def test_bits_that_are_counted_are_one_statement_of_a_header(tmp_path: Path) -> None:
    """So GCC makes both tests of that loop before it, all that the second one needs with them; with six statements more, the first one alone."""
    more = "".join(f"                d = (d ^ {each}) + 3\n" for each in "tmq")
    longer = MATCHED.replace("                if d >=", f"{more}                if d >=")
    assert lowered(MATCHED, tmp_path, GCC_O2)[Op.EXTEND] == 2
    assert lowered(longer, tmp_path, GCC_O2)[Op.EXTEND] == 1
