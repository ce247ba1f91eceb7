"""Every index and every divisor of a kernel is checked as it runs; what is wrong is an error, and changes no memory."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from benchmarks.twins.cases import CASES
from benchmarks.twins.measured import Role, measured
from bfsim.errors import KernelError
from bfsim.kernel import GCC_O0, VDSP_O2, Kernel, f32, i16, i32, kernel, quotient, remainder, u8, u16, u32

LOWEST, HIGHEST = -(2**31), 2**31 - 1
MARGIN, FILL = 64, 77


@kernel
def load(row: u8[:], i: i32) -> i32:
    return row[i]


@kernel
def load_unsigned(row: u16[:], i: u32) -> i32:
    return row[i]


@kernel
def load_sum(row: u32[:], i: u32, j: u32) -> u32:
    return row[i + j]


@kernel
def store(row: u8[:], other: u32[:], i: i32):
    row[0] = 9
    other[i] = 1
    row[1] = 9


@kernel
def store_float(row: f32[:], i: i32):
    row[i] = 1.5


@kernel
def store_one_of_two(row: i32[:], i: i32):
    n = row[i - 1]
    if n > 4:
        row[i] = 1
    else:
        row[i] = n


@kernel
def store_one_of_three(row: i32[:], i: i32):
    n = row[i - 1]
    if n > 4:
        row[i] = 4
    elif n < 0:
        row[i] = 0
    else:
        row[i] = n


@kernel
def put_one(row: i32[:], i: i32):
    row[i] = 1


@kernel
def put(row: i32[:], i: i32, n: i32):
    row[i] = n


@kernel
def put_one_of_two(row: i32[:], i: i32):
    n = row[i - 1]
    if n > 4:
        put_one(row, i)
    else:
        put(row, i, n)


@kernel
def either(row: u8[:], other: u8[:], i: i32, first: i32) -> i32:
    return row[i] if first == 1 else other[i]


@kernel
def store_behind(row: u8[:], other: u32[:], i: i32):
    store(row, other, i + 1)


@kernel
def two_ways(row: u8[:], other: u32[:], i: i32):
    if i < 3:
        store(row, other, i)
    else:
        store_behind(row, other, i)


@kernel
def quotient_of(a: i32, b: i32) -> i32:
    return a // b


@kernel
def rest_of(a: i32, b: i32) -> i32:
    return a % b


@kernel
def unsigned_quotient_of(a: u32, b: u32) -> u32:
    return a // b


@kernel
def unsigned_rest_of(a: u32, b: u32) -> u32:
    return a % b


@kernel
def c_quotient_of(a: i32, b: i32) -> i32:
    return quotient(a, b)


@kernel
def c_rest_of(a: i32, b: i32) -> i32:
    return remainder(a, b)


@kernel
def divide_rows(a: i16[:], b: i16[:]):
    for i in range(len(a)):
        a[i] = a[i] // b[i]


def row_of(kind: type[np.generic], n: int = 8) -> np.ndarray[Any, Any]:
    """Return 0, 1, 2 ... in the middle of a larger array, whose margins are filled."""
    around = np.full(n + 2 * MARGIN, FILL, kind)
    around[MARGIN : MARGIN + n] = np.arange(n)
    return around[MARGIN : MARGIN + n]


def place(of: Kernel, text: str) -> str:
    """Return file:line of the line of a kernel that has `text`."""
    lines = of.function.source.splitlines()
    number = next(i for i, line in enumerate(lines) if text in line)
    return f"{__file__}:{of.function.first_line + number}"


def column(of: Kernel, text: str) -> str:
    """Return file:line:column of `text` in a kernel."""
    line = next(each for each in of.function.source.splitlines() if text in each)
    return f"{place(of, text)}:{line.index(text) + 1}"


def caret(of: Kernel, text: str) -> str:
    """Return the line of a kernel that has `text`, with a caret under it."""
    line = next(each for each in of.function.source.splitlines() if text in each)
    return f"\n    {line}\n    {' ' * line.index(text)}^"


def fails(how: str, called: Kernel, *arguments: Any) -> str:
    """Return the message of a run that fails; what lies around its arrays must stay as it was."""
    with pytest.raises(KernelError) as caught:
        called.sanitize(arguments) if how == "sanitized" else called(*arguments)
    for each in arguments:
        if isinstance(each, np.ndarray):
            margins = np.delete(each.base, np.s_[MARGIN : MARGIN + len(each)])
            np.testing.assert_array_equal(margins, FILL)
    return str(caught.value)


def test_a_kernel_that_was_read_twice_tells_its_own_failure() -> None:
    """As firmware is that one process loads again: both have the same code."""
    row = row_of(np.uint8)
    for each in (load, kernel(load.definition)):
        assert each(row, 1) == 1
    assert "index 8 is outside of row" in fails("checked", load, row, 8)


both_ways = pytest.mark.parametrize("how", ["checked", "sanitized"])


@both_ways
@pytest.mark.parametrize("index", [-1, 8, 9, HIGHEST, LOWEST, 2**30, 2**24])
def test_an_index_outside_of_its_array_is_an_error(how: str, index: int) -> None:
    """A load below 0 or at the length of its array is refused with file, line, kernel, array, index and length."""
    assert fails(how, load, row_of(np.uint8), index) == (
        f"{column(load, 'row[i]')}: index {index} is outside of row in kernel load; "
        f"an index must be 0 or more and less than len(row), which is 8{caret(load, 'row[i]')}"
    )


@pytest.mark.parametrize("index", [0, 7])
def test_an_index_inside_of_its_array_is_none(index: int) -> None:
    """The first and the last element can be loaded."""
    assert load(row_of(np.uint8), index) == index


@both_ways
@pytest.mark.parametrize("index", [8, 2**30, 2**31, 2**32 - 1])
def test_an_unsigned_index_is_shown_unsigned(how: str, index: int) -> None:
    """A u32 beyond 2**31 is named as the kernel has it, not as a negative number."""
    assert f"index {index} is outside of row" in fails(how, load_unsigned, row_of(np.uint16), index)


@pytest.mark.parametrize(("i", "j"), [(2**31, 2**31 + 3), (2**32 - 1, 4), (3, 0), (2**32 - 5, 8)])
def test_a_sum_that_wraps_into_the_array_is_an_index_of_it(i: int, j: int) -> None:
    """Indexes are counted modulo 2**32, as in the chip's registers."""
    assert load_sum(row_of(np.uint32), i, j) == 3


@both_ways
def test_a_sum_that_does_not_wrap_into_the_array_is_outside(how: str) -> None:
    """Two halves of the address space are not the first element when one is missing."""
    assert f"index {2**31} is outside" in fails(how, load_sum, row_of(np.uint32), 2**31, 0)
    assert f"index {2**30} is outside" in fails(how, load_sum, row_of(np.uint32), 2**29, 2**29)


@both_ways
@pytest.mark.parametrize("index", [-1, 2, 2**30])
def test_a_store_outside_of_its_array_does_not_happen(how: str, index: int) -> None:
    """It is refused as a load is, its own array is named, and nothing runs after it."""
    row = row_of(np.uint8)
    message = fails(how, store, row, row_of(np.uint32, 2), index)
    assert message.startswith(
        f"{column(store, 'other[i]')}: index {index} is outside of other in kernel store;"
    )
    assert row[1] == 1


@both_ways
def test_floats_are_checked(how: str) -> None:
    """An array of floats has no other elements either."""
    assert "index 8 is outside of row in kernel store_float" in fails(how, store_float, row_of(np.float32), 8)


@both_ways
def test_accesses_that_the_compiler_merges_are_told_apart_as_far_as_can_be(how: str) -> None:
    """Of two stores that have become one, both lines are named; what is as it is written has one, and so has a load of one of two arrays."""
    message = fails(how, store_one_of_two, row_of(np.int32), 8)
    assert (
        f"{column(store_one_of_two, 'row[i] = 1')}: index 8 is outside of row in kernel store_one_of_two"
        in message
    )
    assert ("; or line " in message) == (how == "checked")
    message = fails(how, store_one_of_three, row_of(np.int32), 8)
    assert "index 8 is outside of row in kernel store_one_of_three" in message
    first = int(place(store_one_of_three, "row[i] = 4").rsplit(":", 1)[1])
    assert how == "sanitized" or all(str(first + line) in message for line in (0, 2, 4))
    row = row_of(np.uint8)
    message = fails(how, either, row_of(np.uint8, 20), row, 9, 0)
    assert "index 9 is outside of other in kernel either" in message


def test_accesses_of_several_kernels_that_the_compiler_merges_name_the_one_they_are_in() -> None:
    """Nothing is left of the kernels that were inlined, but the file, the caller, the index and the length are right."""
    message = fails("checked", put_one_of_two, row_of(np.int32), 8)
    assert __file__ in message
    assert (
        "index 8 is outside of an array in kernel put_one_of_two; an index must be 0 or more and less than 8"
        in message
    )
    assert "^" not in message
    message = fails("sanitized", put_one_of_two, row_of(np.int32), 8)
    assert f"{column(put_one, 'row[i] = 1')}: index 8 is outside of row in kernel put_one" in message


@both_ways
def test_an_error_in_a_callee_names_it_and_the_way_to_it(how: str) -> None:
    """The message points into the kernel whose line it is, and says from where it was called: each way of two."""
    wrong = f"{column(store, 'other[i]')}: index {{}} is outside of other in kernel store; an index must be 0 or more"
    message = fails(how, two_ways, row_of(np.uint8), row_of(np.uint32, 2), 2)
    assert message.startswith(wrong.format(2))
    direct = place(two_ways, "        store(")
    assert f"len(other), which is 2; called at {direct}{caret(store, 'other[i]')}" in message
    message = fails(how, two_ways, row_of(np.uint8), row_of(np.uint32, 2), 4)
    assert message.startswith(wrong.format(5))
    way = f"; called at {place(store_behind, 'store(')}; called at {place(two_ways, 'store_behind(')}\n"
    assert way in message


@both_ways
@pytest.mark.parametrize(
    ("divide", "shown"),
    [
        (quotient_of, "7 // 0"),
        (rest_of, "7 % 0"),
        (unsigned_quotient_of, "7 // 0"),
        (unsigned_rest_of, "7 % 0"),
        (c_quotient_of, "quotient(7, 0)"),
        (c_rest_of, "remainder(7, 0)"),
    ],
)
def test_a_division_by_zero_is_an_error(how: str, divide: Kernel, shown: str) -> None:
    """It is named with its kernel, file and line, whatever kind of division it is."""
    what = divide.function.source.partition("return ")[2].strip()
    wrong = f"{column(divide, what)}: {shown} is undefined in kernel {divide.name}; the divisor must not be 0"
    assert fails(how, divide, 7, 0) == f"{wrong}{caret(divide, what)}"


@both_ways
@pytest.mark.parametrize("divide", [quotient_of, rest_of, c_quotient_of, c_rest_of])
def test_the_lowest_number_cannot_be_divided_by_minus_one(how: str, divide: Kernel) -> None:
    """The result does not fit in 32 bits; C leaves the rest undefined, too."""
    message = fails(how, divide, LOWEST, -1)
    assert (
        f"is undefined in kernel {divide.name}; the divisor must not be -1 where the dividend is -2147483648"
        in message
    )
    assert divide(LOWEST + 1, -1) == (HIGHEST if "quotient" in divide.name else 0)
    assert divide(LOWEST, 1) == (LOWEST if "quotient" in divide.name else 0)
    assert unsigned_quotient_of(2**31, 2**32 - 1) == 0


@both_ways
def test_what_was_done_before_a_failure_is_done(how: str) -> None:
    """A run ends at its first failure: what it stored before stays, unless it was a trial."""
    row, divisors = row_of(np.int16), np.ones(8 + 2 * MARGIN, np.int16)[MARGIN:-MARGIN]
    divisors.base[:] = FILL
    divisors[:] = [1, 1, 2, 0, 1, 1, 1, 1]
    assert "3 // 0 is undefined in kernel divide_rows" in fails(how, divide_rows, row, divisors)
    assert row.tolist() == ([0, 1, 1, 3, 4, 5, 6, 7] if how == "checked" else list(range(8)))


def test_the_next_run_is_checked_anew() -> None:
    """A kernel that has failed once can be right the next time, and wrong once more."""
    for _ in range(2):
        assert "index 8" in fails("checked", load, row_of(np.uint8), 8)
        assert load(row_of(np.uint8), 3) == 3


def test_the_profile_without_optimisation_is_checked() -> None:
    """Every build of a kernel is."""
    code = load.compile(GCC_O0)
    row = row_of(np.uint8)
    with pytest.raises(KernelError, match="index 8 is outside of row in kernel load"):
        load.prepare(code, [row], code.new_totals()).run(row, 8)


REFERENCES = [each for each in CASES if measured()[each.name].role is Role.REFERENCE]


@pytest.mark.parametrize("case", REFERENCES[::3], ids=lambda each: each.name)
def test_checks_change_no_cycle_and_no_result(case: Any) -> None:
    """A reference kernel costs the same with and without checks, counter by counter, and computes the same."""
    found = []
    for checked in (True, False):
        code = case.kernel.compile(VDSP_O2, checked=checked)
        totals = code.new_totals()

        def run(*arguments: Any, code: Any = code, totals: Any = totals) -> Any:
            arrays = [each for each in arguments if isinstance(each, np.ndarray)]
            return case.kernel.prepare(code, arrays, totals).run(*arguments).value

        found.append((case.checksum(run), totals.tolist()))
    assert found[0] == found[1]
    assert sum(found[0][1]) > 0
