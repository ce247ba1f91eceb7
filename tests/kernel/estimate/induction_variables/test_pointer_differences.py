"""What only some iterations want of a counter: a difference to the pointer that all of them step, a counter, or a variable of its own.

GCC takes what costs least, and where nothing else is left at a loop's end than its test, the loop is no hardware loop: twice the cycles.
"""

from __future__ import annotations

from tests.kernel.beside_gcc import Case, beside_gcc

SHAPE = """
def f(a: {array}[:], out: {result}[:], n: i32, t: i32) -> i32:
    k = 0
    for i in range({limits}):
        if {test}:
            out[k] = {wanted}
            k += 1
    return k
"""


def _case(
    cycles: int,
    near: float,
    wanted: str = "i",
    limits: str = "n",
    test: str = "a[i] > t",
    array: str = "u8",
    result: str = "u16",
) -> Case:
    return SHAPE.format(array=array, result=result, limits=limits, test=test, wanted=wanted), cycles, near


CASES = {
    "the position": _case(4831, 0.001),
    "one more is the pointer less the array, and no cheaper": _case(2480, 0.1, "i + 1"),
    "one less": _case(4716, 0.005, "i - 1"),
    "counted from the other end": _case(4714, 0.005, "n - i"),
    "a word is the counter itself": _case(2480, 0.005, result="i32"),
    "a word, two more": _case(4596, 0.005, "i + 2", result="i32"),
    "where the neighbour is large": _case(4832, 0.005, test="a[i + 1] > t"),
    "from one on": _case(2467, 0.005, limits="1, n"),
    "from two on": _case(4668, 0.005, limits="2, n"),
    "from anywhere on": _case(2444, 0.005, limits="t, n"),
    "a limit that is a number": _case(4829, 0.005, limits="200"),
    "down to zero": _case(2602, 0.05, limits="n - 1, -1, -1"),
    "down to ten": _case(4510, 0.005, limits="n, 10, -1"),
    "a slope": _case(4800, 0.04, test="a[i + 1] - a[i] > t"),
    "a slope about it": _case(2663, 0.08, limits="1, n - 1", test="a[i + 1] - a[i - 1] > t"),
    "of half-words, a pointer is twice as far": _case(2240, 0.005, array="i16"),
    "a multiple": _case(2480, 0.05, "i * 2"),
}

test_an_estimate_is_near, test_what_is_costed_computes_what_python_does = beside_gcc(CASES, counts=(0, 1, 60))

PEAK = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    best = -1
    top = 0
    for i in range({limits}):
        if a[i] > top:
            top = a[i]
            best = {wanted}
    return best * 256 + top
"""
IN_A_PICTURE = """
def f(a: u8[:], n: i32, t: i32) -> i32:
    best = -1
    top = 0
    for y in range(16):
        for x in range(n >> 4):
            p = y * (n >> 4) + x
            if a[p] > top:
                top = a[p]
                best = p
    return best * 256 + top
"""
PEAKS: dict[str, Case] = {
    "in a picture": (IN_A_PICTURE, 1769, 0.1),
    "in all": (PEAK.format(limits="n", wanted="i"), 1646, 0.005),
    "from a variable on": (PEAK.format(limits="t, n", wanted="i"), 854, 0.005),
    "in a window": (PEAK.format(limits="t, t + 50", wanted="i"), 451, 0.02),
    "the last one first": (PEAK.format(limits="n - 1, t, -1", wanted="i"), 860, 0.005),
    "where the next one is, which is the step": (PEAK.format(limits="n", wanted="i + 1"), 3837, 0.005),
    "how far from the start": (PEAK.format(limits="t, n", wanted="i - t"), 1879, 0.02),
}

test_a_peak_is_near, test_a_peak_is_what_python_finds = beside_gcc(PEAKS, counts=(1, 60, 200))

DOWNWARDS = """
def f(a: u8[:], o: u8[:], n: i32, t: i32) -> i32:
    s = 0
    for i in range(n - 1, -1, -1):
        {}
    return s
"""
WALKS: dict[str, Case] = {
    "the one above": (DOWNWARDS.format("o[i] = a[i + 1]"), 441, 0.06),
    "up while the other goes down": (DOWNWARDS.format("o[i] = a[250 - i]"), 420, 0.02),
}

test_a_walk_down_is_near, test_a_walk_down_is_what_python_does = beside_gcc(WALKS, counts=(1, 60, 200))
