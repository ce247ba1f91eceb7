"""What a call gives may answer tests of what is called: then less of it is inlined, and so it is inlined sooner."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2
from bfsim.kernel.estimate.inlining.inlining import decisions
from tests.kernel.beside_gcc import check_estimate
from tests.kernel.modules import kernel_of

WAVE = """
@kernel
def wave(a: i16[:], x: i32) -> i32:
    p = x & 127
    if p < 32:
        return a[p] + 3
    if p < 64:
        return a[64 - p] - (a[p] >> 2)
    if p < 96:
        return (a[p] >> 1) - a[p - 64] + (a[p - 32] >> 2)
    return -a[128 - p]


"""
IN_RANGE = """
def f(a: i16[:], o: i32[:], n: i32) -> None:
    for y in range(n >> 4):
        for x in range(16):
            o[x] += wave(a, 4 * x) * wave(a, 2 * x + 32)
"""
ANYWHERE = """
def f(a: i16[:], o: i32[:], n: i32) -> None:
    for y in range(n >> 4):
        for x in range(16):
            o[x] += wave(a, o[x]) * wave(a, y)
"""
SHAPED = """
@kernel
def shaped(a: u8[:], i: i32, kind: i32, width: i32) -> i32:
    if kind == 0:
        return (a[i] * 3 + a[i + 1]) >> 2
    if kind == 1:
        total = 0
        for j in range(width):
            total += a[i + j]
        return total // width
    low = a[i]
    for j in range(width):
        low = min(low, a[i + j])
    return low


"""
OF_NUMBERS = """
def f(a: u8[:], o: i32[:], n: i32) -> None:
    for i in range(n - 8):
        o[i] = shaped(a, i, 0, 4) + shaped(a, i + 2, 0, 4)
"""
ROWS = """
@kernel
def product(a: i32, b: i32) -> i32:
    high = a >> 16
    low = a & 65535
    other = b >> 16
    return ((high * other) << 16) + high * (b & 65535) + low * other + (low * (b & 65535) >> 16)


@kernel
def row(m: i32[:], first: i32, x: i32, y: i32, z: i32) -> i32:
    return product(m[first], x) + product(m[first + 1], y) + product(m[first + 2], z)


"""
OF_A_MATRIX = """
def f(m: i32[:], a: i32[:], o: i32[:], n: i32) -> None:
    for i in range(n - 3):
        x = a[i]
        y = a[i + 1]
        z = a[i + 2]
        o[i] = row(m, 0, x, y, z) + row(m, 3, x, y, z) - row(m, 6, x, y, z)
"""
STEP = """
@kernel
def step(state: i32[:], at: i32, wanted: i32, actual: i32) -> i32:
    error = wanted - actual
    rate = actual - state[at + 5]
    state[at + 5] = actual
    state[at + 6] += ((rate << 4) - state[at + 6]) >> 2
    total = state[at + 4] + state[at + 1] * error
    output = (state[at] * error + total - (state[at + 2] * state[at + 6] >> 4)) >> 8
    if output > state[at + 3]:
        output = state[at + 3]
        if error < 0:
            state[at + 4] = total
    elif output < -state[at + 3]:
        output = -state[at + 3]
        if error > 0:
            state[at + 4] = total
    else:
        state[at + 4] = total
    return output


"""
TWO_CONTROLLERS = """
def f(a: i16[:], b: i16[:], state: i32[:], o: i16[:], n: i32) -> None:
    for i in range(n >> 1):
        o[2 * i] = step(state, 0, a[i], b[2 * i])
        o[2 * i + 1] = step(state, 7, a[i], b[2 * i + 1])
"""

CASES = [
    (IN_RANGE, WAVE, 5878, 0.03, True),
    (ANYWHERE, WAVE, 15473, 0.03, False),
    (OF_NUMBERS, SHAPED, 2343, 0.08, True),  # without a bundle of a product and a load
]


@pytest.mark.parametrize(
    ("text", "helper", "cycles", "near", "inlined"), CASES, ids=["range", "anything", "number"]
)
def test_arguments_that_answer_tests_make_a_callee_small(
    text: str, helper: str, cycles: int, near: float, inlined: bool, tmp_path: Path
) -> None:
    """A counter goes from one number to another, or a number says which of three ways; the estimates were 196 and 1,033 % above."""
    found = decisions(kernel_of(text, tmp_path, helper).function, GCC_O2)
    assert [each.inlined for each in found] == [inlined] * len(found)
    check_estimate(text, cycles, near, tmp_path, helper)


def test_numbers_that_say_which_element_make_a_callee_small(tmp_path: Path) -> None:
    """Their addresses are numbers: so the rows are inlined before what they call makes them large. What is off are moves between registers."""
    found = decisions(kernel_of(OF_A_MATRIX, tmp_path, ROWS).function, GCC_O2)
    assert [each.inlined for each in found] == [True] * len(found)
    check_estimate(OF_A_MATRIX, 57771, 0.21, tmp_path, ROWS)


def test_a_sum_with_the_address_of_an_array_stays_where_the_index_is_given(tmp_path: Path) -> None:
    """So a helper that gets where its state begins in an array is called: were its addresses free, it would be inlined twice, and 47 % cheaper."""
    found = decisions(kernel_of(TWO_CONTROLLERS, tmp_path, STEP).function, GCC_O2)
    assert [each.inlined for each in found] == [False] * len(found)
    check_estimate(TWO_CONTROLLERS, 21289, 0.02, tmp_path, STEP)
