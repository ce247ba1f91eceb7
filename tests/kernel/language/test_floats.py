"""Floats in kernels: numpy's float32 results bit for bit, calls of a library in cycles, and clear refusals."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import KernelError
from bfsim.kernel import GCC_O0, GCC_O2, VDSP_O2, f32, i32, kernel, sqrt, u32
from bfsim.kernel.operations import COSTS, Op
from tests.kernel.modules import import_text
from tests.kernel.running import run

SINGLE = st.floats(width=32)


@kernel
def arithmetic(a: f32, b: f32, out: f32[:]):
    out[0] = a + b
    out[1] = a - b
    out[2] = a * b
    out[3] = a / b
    out[4] = min(a, b)
    out[5] = max(a, b)
    out[6] = -a
    out[7] = abs(b)
    out[8] = a * b + a


@kernel
def relations(a: f32, b: f32) -> i32:
    bits = 0
    if a < b:
        bits += 1
    if a <= b:
        bits += 2
    if a == b:
        bits += 4
    if a != b:
        bits += 8
    if a > b:
        bits += 16
    if a >= b:
        bits += 32
    return bits


@kernel
def converted(x: f32, signed: i32[:], unsigned: u32[:]) -> f32:
    signed[0] = i32(x)
    unsigned[0] = u32(x)
    return f32(i32(x)) + 0.5


@kernel
def product(a: f32, b: f32) -> f32:
    return a * b


@kernel
def norm(row: f32[:]) -> f32:
    total = 0.0
    for i in range(len(row)):
        total = total + product(row[i], row[i])
    return sqrt(total)


@given(a=SINGLE, b=SINGLE)
def test_results_are_those_of_numpy_bit_for_bit(a: float, b: float) -> None:
    """Every operation rounds once, to single precision; a product and a sum are not fused."""
    out, (x, y) = np.zeros(9, np.float32), np.array([a, b], np.float32)
    arithmetic(a, b, out)
    with np.errstate(all="ignore"):
        expected = [x + y, x - y, x * y, x / y, min(x, y), max(x, y), -x, abs(y), x * y + x]
    np.testing.assert_array_equal(out, np.array(expected, np.float32))


@given(a=SINGLE, b=SINGLE)
def test_comparisons_are_those_of_python(a: float, b: float) -> None:
    """A NaN is equal to nothing, less than nothing, and differs from everything."""
    expected = [a < b, a <= b, a == b, a != b, a > b, a >= b]
    assert relations(a, b) == sum(bit << number for number, bit in enumerate(expected))


@pytest.mark.parametrize(
    ("x", "signed", "unsigned"),
    [(2.9, 2, 2), (-2.9, -2, 0), (3e9, 2**31 - 1, 3_000_000_000), (-1e30, -(2**31), 0), (math.nan, 0, 0)],
)
def test_conversion_rounds_to_zero_and_stops_at_the_ends(x: float, signed: int, unsigned: int) -> None:
    """What does not fit becomes the nearest integer, on every host; a NaN becomes 0."""
    ints, words = np.zeros(1, np.int32), np.zeros(1, np.uint32)
    assert converted(x, ints, words) == np.float32(signed) + np.float32(0.5)
    assert (ints[0], words[0]) == (signed, unsigned)


def test_floats_pass_between_kernels_and_come_back() -> None:
    """Scalars, results and arrays of floats cross a call."""
    assert norm(np.array([3, 4], np.float32)) == 5.0


def test_an_operation_is_a_call_of_the_library() -> None:
    """One product: the call, the library's cycles, and the kernel's own return."""
    assert GCC_O2.floats
    assert VDSP_O2.floats
    for profile, library in ((GCC_O2, GCC_O2.floats), (VDSP_O2, VDSP_O2.floats)):
        cycles = run(product, 2.0, 3.0, profile=profile).issue_cclk
        least = COSTS[Op.CALL].cclk + library.multiply.cclk + COSTS[Op.RETURN].cclk
        assert least <= cycles < least + 40  # what it saves around the call


def test_a_profile_without_a_library_refuses_floats() -> None:
    """The refusal names the profile, the kernel and the line of the first float, also in a callee."""
    bare = dataclasses.replace(GCC_O2, floats=None)
    with pytest.raises(
        KernelError, match=r"norm must do without floats, for the profile gcc-O2 has no library"
    ):
        norm.compile(bare)
    with pytest.raises(KernelError, match="gcc-O0"):
        product.compile(GCC_O0)


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("y = x + 1", "the two sides are f32 and i32; write f32(...) around the integer, or 2.0 for 2"),
        ("y = x // 2.0", "// is not for f32"),
        ("y = x & 1.0", "& is not for f32"),
        ("y = ~x", "~ is not for f32"),
        ("if x: y = 1", "an f32 is no truth value; write `x != 0.0`"),
        ("y = a[x]", "an integer is needed here, not an f32; write i32(...) around it"),
        ("a[0] = 1", "f32 is needed here, not i32; write 1.0"),
    ],
)
def test_floats_and_integers_do_not_mix_by_themselves(line: str, what: str, tmp_path: Path) -> None:
    """C would convert silently, with a call; here it must be written."""
    with pytest.raises(KernelError) as caught:
        import_text(f"@kernel\ndef f(x: f32, a: f32[:]):\n    {line}\n", tmp_path)
    assert what in str(caught.value)


def test_wrong_arguments_are_refused() -> None:
    """What is no number, or too large for one, and arrays of doubles, are refused at the call."""
    with pytest.raises(KernelError, match="a must be a float of 32 bits, not 'x'"):
        product("x", 1.0)
    with pytest.raises(KernelError, match=r"a must be a float of 32 bits, not 1e\+39"):
        product(1e39, 1.0)
    assert product(float("inf"), 1.0) == float("inf")
    with pytest.raises(KernelError, match="must be one contiguous row of float32, not float64"):
        norm(np.zeros(3))
