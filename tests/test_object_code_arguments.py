"""What is handed over to object code: numbers as its registers have them, arrays in the Blackfin's memory."""

from __future__ import annotations

from mmap import mmap

import numpy as np
import pytest

from bfsim.api import f32, i32, kernel_from, u8
from bfsim.blackfin.execution.address_space import AddressSpace
from bfsim.blackfin.execution.placed import ARRAYS, placed
from bfsim.chip.boards import CM_BF561
from bfsim.errors import ConfigError, KernelError
from bfsim.kernel import GCC_O2
from bfsim.machine.memories import Memories
from tests.sums import DATA, ROW, expected_sums, sums


def test_arrays_that_overlap_do_so_in_the_blackfin_s_memory() -> None:
    """`out` lies over the row: what is stored is read again."""
    octets = np.zeros(256, np.uint8)
    octets[:32] = ROW
    out = octets.view(np.int32)
    apart = np.zeros(32, np.int32)
    sums()(octets[:32].copy(), apart, 32, 8)
    sums()(octets[:32], out[:32], 32, 8)
    assert out[8] == apart[8]  # beyond the row: stored at 32, behind all that is read
    before = octets.copy()
    sums()(octets[:32], out[:32], 32, 0)
    assert (octets != before).any()


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_arrays_lie_in_the_order_of_the_arguments(order: tuple[int, ...]) -> None:
    """Wherever they are on the host: code that compares addresses takes the same cycles."""
    space = AddressSpace()
    space.add(ARRAYS, 4096)
    octets = np.zeros(3 * 256, np.uint8)
    arrays = [octets[256 * each : 256 * each + 100] for each in order]
    parts, addresses = placed(arrays, [True, False, False], space)
    first = addresses[0]
    assert addresses == [first, first + 112, first + 224]
    assert [each.is_written for each in parts] == [True, False, False]


def test_arrays_in_the_memory_of_a_board_are_not_copied() -> None:
    """The code sees what is stored there, stores there, and takes the cycles that it takes on copies."""
    kernel, totals = sums(), []
    code = kernel.compile(GCC_O2)
    memory = Memories(CM_BF561).arena
    row, out = memory[4096 : 4096 + len(ROW)], memory[8192 : 8192 + 4 * len(ROW)].view(np.int32)
    calls = [kernel.prepare(code, [ROW, np.zeros(len(ROW), np.int32)], code.new_totals())]
    calls.append(kernel.prepare(code, [row, out], code.new_totals(), memory=memory))
    row[:] = ROW
    for each in calls:
        work = each.run(None, None, len(ROW), 2)
        totals.append((work.issue_cclk, work.stall_cclk, work.value))
    assert totals[0] == totals[1]
    assert (out == expected_sums(ROW)).all()
    space = code.subroutine.processor.space
    assert (space.at(space.window(memory) + 4096, len(ROW)) == ROW).all()


def test_integers_of_any_kind_are_handed_over() -> None:
    """Those of numpy, and -1, which the C interface of Python returns for a mistake, too."""
    out = np.zeros(len(ROW), np.int32)
    assert sums()(ROW, out, np.int16(len(ROW)), np.uint8(2)) == expected_sums(ROW).sum()
    assert sums()(ROW, out, -1, 2) == 0


@pytest.mark.parametrize("count", [2.0, "2", None, 2**31, -(2**31) - 1, 2**70])
def test_what_is_no_integer_of_32_bits_is_refused(count: object) -> None:
    """So are arguments too few and too many; the next call is made."""
    kernel = sums()
    code, out = kernel.compile(GCC_O2), np.zeros(len(ROW), np.int32)
    call = kernel.prepare(code, [ROW, out], code.new_totals())
    with pytest.raises(KernelError, match=r"n must be an int in -2147483648..2147483647, not "):
        call.run(ROW, out, count, 2)
    for wrong in ((ROW, out, 5), (ROW, out, 5, 2, 1)):
        with pytest.raises(
            KernelError, match=f"sums must get row, out, n, first, not {len(wrong)} arguments"
        ):
            call.run(*wrong)
    assert call.run(ROW, out, len(ROW), 2).value == expected_sums(ROW).sum()


def test_a_float_is_handed_over_as_the_bits_of_a_single() -> None:
    """What no single can hold is refused."""
    kernel = kernel_from(DATA / "sums.o", "sums", row=u8[:], out=i32[:], n=f32, first=i32, result=i32)
    out = np.zeros(len(ROW), np.int32)
    assert (
        kernel(ROW, out, len(ROW) * 2.0**-149, 2) == expected_sums(ROW).sum()
    )  # the least single has the bits of 1
    assert kernel(ROW, out, -1.0, 2) == 0
    for wrong in (1e39, "1", True):
        with pytest.raises(KernelError, match="n must be"):
            kernel(ROW, out, wrong, 2)


def test_a_window_is_there_for_as_long_as_its_memory() -> None:
    """Two memories have windows of their own; the next one takes the place of one that is gone."""
    space = AddressSpace()
    first, second = (np.frombuffer(mmap(-1, 8192), np.uint8) for _ in range(2))
    first[5], second[5] = 1, 2
    there = space.window(first)
    assert space.window(first) == there
    assert space.window(second) == there + 8192
    assert [int(space.at(each + 5, 1)[0]) for each in (there, there + 8192)] == [1, 2]
    del first
    third = np.frombuffer(mmap(-1, 4096), np.uint8)
    third[5] = 3
    assert space.window(third) == there
    assert space.at(there + 5, 1) == 3
    with pytest.raises(ConfigError, match="but there is none"):
        space.at(there + 4096, 1)


def test_arguments_are_checked_as_those_of_other_kernels() -> None:
    """Numbers by their types, arrays by their elements."""
    kernel = sums()
    out = np.zeros(32, np.int32)
    with pytest.raises(KernelError, match="n must be an int in"):
        kernel(ROW, out, 1 << 40, 2)
    with pytest.raises(KernelError, match="out must be one contiguous row of int32"):
        kernel(ROW, ROW, 32, 2)


def test_what_must_not_be_changed_is_not() -> None:
    """Nobody knows before what object code stores into: what it left in a read-only array was lost without a word."""
    kernel, row, out = sums(), ROW.copy(), np.zeros(32, np.int32)
    row.flags.writeable = False
    kernel(row, out, 32, 2)
    np.testing.assert_array_equal(out, expected_sums(ROW))
    out[:] = 0
    out.flags.writeable = False
    with pytest.raises(
        KernelError, match=r"out must be writeable, because the kernel stores into it \(out of sums"
    ):
        kernel(row, out, 32, 2)
    with pytest.raises(KernelError, match="out must be writeable"):
        kernel.cost(row, out, 32, 2)
    assert not out.any()
