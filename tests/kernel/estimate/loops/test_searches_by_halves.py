"""Searches by halves, beside GCC: two loops that begin with one test, which is not copied in front, and half of a sum as an index.

Without this, an estimate is off by up to 17 %.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel.emitting.subloops import end_of_subloop
from bfsim.kernel.language import tree
from tests.kernel.beside_gcc import Case, beside_gcc
from tests.kernel.modules import kernel_of

SHAPE = """
def f(a: {kind}[:], b: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n):
        x = {wanted}
        low = 0
        high = {most}
        while {test}:
            m = (low + high) >> 1
            if {first}:
                {yes}
            else:
                {no}
        s += low
    return s
"""


def _case(
    cycles: int,
    near: float,
    *,
    kind: str = "u16",
    wanted: str = "b[i]",
    most: str = "200",
    test: str = "high - low > 1",
    first: str = "a[m] <= x",
    yes: str = "low = m",
    no: str = "high = m",
) -> Case:
    text = SHAPE.format(kind=kind, wanted=wanted, most=most, test=test, first=first, yes=yes, no=no)
    return text, cycles, near


LOWER = {"most": "t", "test": "low < high", "first": "a[m] < x", "yes": "low = m + 1"}
CASES = {
    "the place before": _case(31651, 0.06),
    "from a variable": _case(28051, 0.06, most="t"),
    "the other side first": _case(31651, 0.06, first="a[m] > x", yes="high = m", no="low = m"),
    "the lower bound": _case(29837, 0.12, **LOWER),
    "of bytes": _case(28471, 0.01, kind="u8"),
    "of words": _case(27679, 0.02, kind="i32"),
    "a lower bound of bytes": _case(29753, 0.1, kind="u8", **LOWER),
    "a root": _case(30690, 0.02, wanted="a[i] * 64", first="m * m <= x"),
}
test_estimates_are_near_what_gcc_makes, test_what_is_costed_computes_what_python_does = beside_gcc(
    CASES, counts=(0, 1, 7, 100)
)


ENDED = """
def f(a: u8[:], n: i32) -> i32:
    i = 0
    j = n
    while i < j:
        {0}
    return i * 256 + j
"""


@pytest.mark.parametrize(
    ("body", "leaves"),
    [
        ("m = (i + j) >> 1\n        if a[m] > 9: j = m\n        else: i = m + 1", False),
        ("m = (i + j) >> 1\n        if a[m] < 9: i = m + 1\n        else: j = m", True),
        ("if a[i] > 9: i += 1", True),
        ("j -= 1\n        if a[j] > 9: i += 1", None),
        ("j -= 1\n        if a[j] > 9: j -= 1", True),
        ("if a[i] > 9: i += 1\n        else: j -= 1", None),
        ("i += a[i]\n        j -= a[j]\n        if i < j:\n            i += 1\n            j -= 1", None),
        ("if a[i] > 9: j -= 1\n        i += 1", None),
    ],
)
def test_a_side_that_only_says_what_is_next_leads_back_at_once(
    body: str, leaves: bool | None, tmp_path: Path
) -> None:
    """Unless it hands on what the other one hands on, too, or the loop's own test has just failed."""
    block = tree.body_of(kernel_of(ENDED.format(body), tmp_path).function).block
    (loop,) = [each for each in block if isinstance(each, tree.While)]
    end = end_of_subloop(loop, block)
    assert (end and end[1]) == leaves
