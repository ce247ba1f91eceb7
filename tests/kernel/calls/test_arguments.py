"""Wrong arguments at a kernel's call: an error that names the parameter, the kernel and where it stands."""

from __future__ import annotations

import gc
import re
from typing import Any

import numpy as np
import pytest

from bfsim.errors import KernelError
from bfsim.kernel import VDSP_O2, i16, i32, kernel, u8, u32
from tests.kernel.running import run


@kernel
def shade(row: u8[:], table: i16[:], gain: i32, bits: u32) -> i32:
    row[0] = gain
    return table[0] + i32(bits)


@kernel
def total(row: u8[:]) -> i32:
    found = 0
    for i in range(len(row)):
        found += row[i]
    return found


@kernel
def shade_by_another(row: u8[:], table: i16[:]):
    shade(row, table, 1, 2)


ROW, TABLE = np.zeros(8, np.uint8), np.zeros(8, np.int16)
PLACE = re.escape(f"{__file__}:{shade.function.first_line})")


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        ((ROW, TABLE, 1), "shade must get row, table, gain, bits, not 3 arguments"),
        ((ROW, TABLE, 1, 2, 3), "shade must get row, table, gain, bits, not 5 arguments"),
        (([1, 2], TABLE, 1, 2), r"row must be an array u8\[:\], not list"),
        ((7, TABLE, 1, 2), r"row must be an array u8\[:\], not int"),
        ((None, TABLE, 1, 2), r"row must be an array u8\[:\], not NoneType"),
        ((ROW.astype(np.int8), TABLE, 1, 2), "row must be one contiguous row of uint8, not int8 of shape 8"),
        (
            (ROW, TABLE.astype(np.float64), 1, 2),
            "table must be one contiguous row of int16, not float64 of shape 8",
        ),
        ((ROW, TABLE.astype(">i2"), 1, 2), "table must be one contiguous row of int16, not >i2 of shape 8"),
        ((ROW.reshape(2, 4), TABLE, 1, 2), "row must be one contiguous row of uint8, not uint8 of shape 2x4"),
        (
            (ROW[::2], TABLE, 1, 2),
            "row must be one contiguous row of uint8, not a view in steps of 2 elements; pass a copy",
        ),
        (
            (ROW, TABLE[::-1], 1, 2),
            "table must be one contiguous row of int16, not a view in steps of -1 elements; pass",
        ),
        ((ROW, np.zeros(9, np.uint8)[1:].view(np.int16), 1, 2), "table must lie at a multiple of 2 bytes"),
        ((ROW, TABLE, 1.5, 2), "gain must be an int in -2147483648..2147483647, not 1.5"),
        ((ROW, TABLE, "1", 2), "gain must be an int in -2147483648..2147483647, not '1'"),
        ((ROW, TABLE, ROW, 2), "gain must be an int in -2147483648..2147483647, not array"),
        ((ROW, TABLE, 2**31, 2), "gain must be an int in -2147483648..2147483647, not 2147483648"),
        ((ROW, TABLE, 1, -1), "bits must be an int in 0..4294967295, not -1"),
    ],
)
def test_a_wrong_argument_is_refused_by_name(arguments: tuple[Any, ...], what: str) -> None:
    """The message says which parameter of which kernel must be what, and where the kernel stands."""
    with pytest.raises(KernelError, match=f"{what}.*{PLACE}"):
        shade(*arguments)


def test_a_row_that_is_stored_into_must_be_writeable() -> None:
    """A read-only row is refused where the kernel, or one that it calls, stores into it, and only there."""
    frozen = np.frombuffer(b"picture!", np.uint8)
    for storing, arguments in ((shade, (frozen, TABLE, 1, 2)), (shade_by_another, (frozen, TABLE))):
        with pytest.raises(KernelError, match="row must be writeable, because the kernel stores into it"):
            storing(*arguments)
    assert total(frozen) == sum(b"picture!")


def test_integers_of_numpy_and_the_whole_range_are_taken() -> None:
    """numpy's integers are integers; the ends of the range come back as they went in."""
    table = np.array([0], np.int16)
    assert shade(ROW, table, np.int64(-1), np.uint8(200)) == 200
    assert ROW[0] == 255
    assert shade(ROW, table, -(2**31), 2**32 - 1) == -1


def test_an_unsigned_result_is_not_negative(import_kernels: Any) -> None:
    """A kernel that returns u32 returns 0..2**32-1."""
    assert import_kernels("@kernel\ndef f(x: u32) -> u32:\n    return ~x\n").f(0) == 2**32 - 1


def test_a_prepared_call_keeps_its_arrays_alive() -> None:
    """A call that was prepared with arrays that nobody else has runs on them, and adds up its counts."""
    code = total.compile(VDSP_O2)
    calls = [total.prepare(code, [np.full(10_000, n, np.uint8)], code.new_totals()) for n in range(8)]
    gc.collect()
    np.zeros(80_000, np.uint8)
    assert [call.run(None).value for call in calls] == [10_000 * n for n in range(8)]


@kernel
def levels(row: u8[:], first: u32, second: i32) -> i32:
    row[0] = first
    return second - 1


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        ((None, 1 << 32, 0), "first must be an int in 0..4294967295, not 4294967296"),
        ((None, -1, 0), "first must be an int in 0..4294967295, not -1"),
        ((None, 0, 1 << 31), "second must be an int in -2147483648..2147483647, not 2147483648"),
        ((None, 0, 1 << 70), "second must be an int in -2147483648..2147483647, not 1180591620717411303424"),
        ((None, 0, 1.0), "second must be an int in -2147483648..2147483647, not 1.0"),
        ((None, 0), "levels must get row, first, second, not 2 arguments"),
    ],
)
def test_a_prepared_call_refuses_what_its_types_do_not_hold(arguments: tuple[Any, ...], what: str) -> None:
    """As the call of a kernel does, and nothing is run; the next call is as ever."""
    code, row = levels.compile(VDSP_O2), np.full(4, 9, np.uint8)
    call = levels.prepare(code, [row], code.new_totals())
    with pytest.raises(KernelError, match=re.escape(what)):
        call.run(*arguments)
    assert row[0] == 9
    assert call.run(None, (1 << 32) - 1, -(1 << 31) + 1).value == -(1 << 31)
    assert row[0] == 255


def test_totals_add_up_over_calls() -> None:
    """The totals that a call was prepared with hold the events of all its runs; each run reports its own cycles."""
    code = total.compile(VDSP_O2)
    totals = code.new_totals()
    row = np.zeros(32, np.uint8)
    call = total.prepare(code, [row], totals)
    cycles = {call.run(row).issue_cclk for _ in range(5)}
    assert cycles == {run(total, row).issue_cclk}
    assert (
        sum(int(n) * each.issue_cclk for n, each in zip(totals, code.counters, strict=True))
        == 5 * cycles.pop()
    )


def test_arguments_by_name_are_refused() -> None:
    """As in a kernel that calls another one."""
    with pytest.raises(
        KernelError, match="shade must get row, table, gain, bits by their places, not bits by name"
    ):
        shade(ROW, TABLE, 1, bits=2)


@pytest.mark.parametrize(("options", "shown"), [({}, ""), ({"fast": True, "inline": 1}, "fast, inline")])
def test_the_decorator_has_no_options(options: dict[str, object], shown: str) -> None:
    """It is told what to write, and where what it may have looked for is."""
    with pytest.raises(
        KernelError, match=re.escape(f"must stand without brackets, not as @kernel({shown}): how")
    ):
        kernel(**options)
