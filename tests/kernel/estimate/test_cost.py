"""What kernels cost: closed forms worked out by hand from the table of operations, in the profile gcc-O2."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from bfsim.errors import BfsimWarning, KernelError
from bfsim.kernel import GCC_O2, VDSP_O2, Kernel
from bfsim.kernel.operations import COSTS, Op
from bfsim.kernel.profile import DEFAULT
from tests.kernel import cost_kernels
from tests.kernel.conftest import ImportText
from tests.kernel.running import CALLING_GCC, CALLING_VDSP, line_executions, run

RETURN = COSTS[Op.RETURN].cclk
SAVED = GCC_O2.push_multiple_cclk + GCC_O2.pop_multiple_cclk
SKIP, ENTER = COSTS[Op.BRANCH_TAKEN_BP].cclk, COSTS[Op.BRANCH_NOT_TAKEN_BP].cclk  # over a body, and into it
COUNT_DOWN = 1 + 1 + COSTS[Op.BRANCH_TAKEN].cclk  # P -= 1; CC = P == 0; IF !CC JUMP


def cclk(kernel: Kernel, *arguments: Any) -> int:
    """Return the cycles of one run in the profile gcc-O2, which has no interlocks."""
    work = run(kernel, *arguments, profile=GCC_O2)
    assert work.stall_cclk == 0
    return work.issue_cclk


def words(n: int) -> np.ndarray[tuple[int], np.dtype[np.uint32]]:
    """Return `n` words."""
    return np.zeros(n, np.uint32)


def test_an_empty_kernel_only_returns() -> None:
    """A kernel without a body costs its RTS, and the four NOPs that a compiler puts before one so early."""
    assert cclk(cost_kernels.nothing) == 4 + RETURN


def test_cost_is_that_of_one_call() -> None:
    """Issue cycles and interlocks in the profile that is named; without a name that of the default, here without code. The call is made."""
    source, target = words(8) + 7, words(8)
    for profile in (GCC_O2, VDSP_O2):
        work = run(cost_kernels.copy_words, source, words(8), profile=profile)
        cost = cost_kernels.copy_words.cost(source, target, profile=profile.name)
        assert cost == work.issue_cclk + work.stall_cclk > 0
    work = run(cost_kernels.copy_words, source, words(8), profile=DEFAULT)
    with pytest.warns(
        BfsimWarning, match="copy_words in gcc-adi is an estimate: only what `kernel` of bfsim.api"
    ):
        assert cost_kernels.copy_words.cost(source, target) == work.issue_cclk + work.stall_cclk
    assert target.tolist() == [7] * 8
    with pytest.raises(KernelError, match="must get"):
        cost_kernels.copy_words.cost(source)


def test_a_copy_loop_costs_a_load_and_a_store_per_word() -> None:
    """A counted loop without branches is a hardware loop: two cycles a word, nothing per iteration."""
    cost = {n: cclk(cost_kernels.copy_words, words(n), words(n)) for n in (1, 2, 320)}
    assert cost[2] - cost[1] == 2
    assert cost[320] - cost[1] == 2 * 319
    # the pointers (2) and the count (move, 3 to make it of the words' bytes) to P registers, parameters (2 + 1),
    # the guard (compare, branch not taken), LSETUP; a fourth pointer register, in which the count is shifted, is saved
    assert cost[1] == 2 + RETURN + (2 + 1 + 3) + 2 + 2 + 1 + SAVED


def test_two_nested_counted_loops_are_hardware_loops() -> None:
    """One more word of the inner loop costs its three operations and no branch."""
    row = words(50)
    per_word = cclk(cost_kernels.flip_grid, row, 1, 21) - cclk(cost_kernels.flip_grid, row, 1, 20)
    assert per_word == 3  # load, exclusive or, store


def test_a_loop_whose_end_is_empty_counts_in_a_register() -> None:
    """A hardware loop needs an operation before its end: the outer loop, which only repeats the inner one, has none."""
    row = words(50)
    per_line = cclk(cost_kernels.flip_grid, row, 9, 20) - cclk(cost_kernels.flip_grid, row, 8, 20)
    guard = 1 + 1  # whether there are columns is known before: CC gets it back; branch not taken
    set_up = (
        1 + (2 + 3) + 1
    )  # pointer; count of words, from what is known before both loops, to a P register; LSETUP
    assert per_line == 20 * 3 + guard + set_up + COUNT_DOWN


def test_the_third_loop_is_not_a_hardware_loop() -> None:
    """The chip has two sets of loop registers: a third level counts in a register and branches back."""
    counters = cost_kernels.flip_cube.compile(GCC_O2).counters
    operations = [each.op for counter in counters for each in counter.charges]
    assert operations.count(Op.LOOP_SETUP) == 2
    back = [each for each in counters if each.value is not None and each.issue_cclk == 9 - 1]
    assert len(back) == 1  # taken 9 instead of not taken 1


def test_a_loop_that_waits_for_data_branches_every_iteration() -> None:
    """A `while` on data is no hardware loop: load, compare, increment, and the branch back, predicted taken."""
    row = np.arange(40, dtype=np.uint8)
    cost = [cclk(cost_kernels.find, row, n) for n in range(10)]
    per_iteration = {b - a for a, b in itertools.pairwise(cost)}
    assert per_iteration == {1 + 1 + 1 + SKIP}


def test_a_loop_on_a_square_is_not_counted() -> None:
    """`root * root < n` has no number of iterations before it starts, so every iteration pays its branch."""
    per_iteration = cclk(cost_kernels.square_root, 101) - cclk(cost_kernels.square_root, 100)
    product = 1 + COSTS[Op.MUL32].cclk  # R *= R overwrites its operand, which is still needed: a copy first
    assert per_iteration == product + 1 + 1 + SKIP  # compare, increment, branch back


def test_a_loop_with_a_call_branches_and_pays_the_call() -> None:
    """A loop that calls is no hardware loop; an iteration costs CALL, the callee with its RTS, and the branch."""
    row = np.zeros(20, np.uint8)
    callee = cclk(cost_kernels.store_three, row, 3)
    nine, eight = (run(cost_kernels.store_each, row, n, profile=CALLING_GCC).issue_cclk for n in (9, 8))
    per_iteration = nine - eight
    arguments = 2  # moved to R0 and R1
    assert per_iteration == arguments + COSTS[Op.CALL].cclk + callee + 1 + 1 + SKIP  # increment, compare


def test_registers_are_saved_as_the_profile_says() -> None:
    """GNU's simulator charges 14 and 11 cycles for a push and a pop multiple; the chip one per register."""
    row = np.zeros(1, np.uint8)
    gnu = run(cost_kernels.store_each, row, 1, profile=CALLING_GCC).issue_cclk
    chip = run(cost_kernels.store_each, row, 1, profile=CALLING_VDSP).issue_cclk
    saved = 3  # the count, the pointer and the limit, which live across the call
    assert gnu - chip == 14 + 11 - 2 * saved


def test_a_division_costs_the_run_time_library() -> None:
    """An unsigned division is a call of the profile's library; who calls keeps RETS."""
    around = 1 + 1 + 1 + 1 + RETURN  # RETS pushed and popped, room on the stack and back
    for profile in (GCC_O2, VDSP_O2):
        library = COSTS[Op.CALL].cclk + profile.library.divide_unsigned.cclk
        assert run(cost_kernels.quotient, 7, 2, profile=profile).issue_cclk == library + around


def test_one_division_of_bytes_needs_no_correction() -> None:
    """Bytes are never negative: rounding down is rounding to zero, one library call per pixel and no more."""
    a, b, out = (np.full(9, 12, np.uint8) for _ in range(3))
    per_pixel = cclk(cost_kernels.quotients, a, b, out) - cclk(cost_kernels.quotients, a[1:], b[1:], out[1:])
    library = COSTS[Op.CALL].cclk + GCC_O2.library.divide_signed.cclk
    # two loads, store, compare with the end, branch back; the loop calls, so it is no hardware loop
    assert per_pixel == pytest.approx(library + 2 + 1 + 1 + SKIP, abs=6)


def test_dividing_by_a_power_of_two_shifts() -> None:
    """`// 8` and `% 16` round down, as an arithmetic shift and a mask (and its constant) do; no library is called."""
    assert cclk(cost_kernels.rounded_down, -5) == 1 + 2 + 1 + RETURN
    assert cost_kernels.rounded_down(-5) == -5 // 8 + -5 % 16


def test_dividing_towards_zero_needs_no_correction() -> None:
    """`quotient` is C's division: one call of the library, where `//` must mend what is negative; by 8 it is a branch."""
    assert [cost_kernels.divided(a, b) for a, b in ((7, 2), (-7, 2), (7, -2), (-7, -2))] == [3, -3, -3, 3]
    assert [cost_kernels.left_over(a, 2) for a in (7, -7)] == [1, -1]
    assert [cost_kernels.eighths(a) for a in (-9, -8, -1, 0, 17)] == [-1, -1, 0, 0, 2]
    around = 1 + 1 + 1 + 1 + RETURN  # RETS pushed and popped, room on the stack and back
    for profile in (GCC_O2, VDSP_O2):
        call = COSTS[Op.CALL].cclk + around
        library = profile.library
        assert (
            run(cost_kernels.divided, 7, 2, profile=profile).issue_cclk == call + library.divide_signed.cclk
        )
        assert (
            run(cost_kernels.left_over, 7, 2, profile=profile).issue_cclk
            == call + library.remainder_signed.cclk
        )
    assert cclk(cost_kernels.eighths, 17) == 1 + COSTS[Op.BRANCH_TAKEN_BP].cclk + 1 + RETURN


@pytest.mark.parametrize("above", [0, 1, 7, 32])
def test_a_branch_costs_what_the_data_makes_it_cost(above: int) -> None:
    """A pixel that skips the body pays 5 cycles, one that enters it pays 9 and the body."""
    row = np.array([200] * above + [10] * (32 - above), np.uint8)
    work = run(cost_kernels.positions_above, row, 100, words(32), profile=GCC_O2)
    assert work.value == above
    none = cclk(cost_kernels.positions_above, np.full(32, 10, np.uint8), 100, words(32))
    body = 1 + 1 + 1  # address, store, increment
    assert work.issue_cclk - none == above * (ENTER - SKIP + body)


def test_interlocks_are_counted_apart() -> None:
    """A table look-up waits for its index to reach the address unit; GCC's figures have no such waits."""
    labels, lut = np.arange(64, dtype=np.uint16), np.arange(64, dtype=np.uint16)
    gnu = run(cost_kernels.relabel, labels, lut, profile=GCC_O2)
    chip = run(cost_kernels.relabel, labels, lut, profile=VDSP_O2)
    assert gnu.stall_cclk == 0
    assert chip.stall_cclk == 64 * 4  # D to P move, then the shift-add: nothing to put in between
    assert chip.issue_cclk == gnu.issue_cclk - (14 + 11) + (1 + 1)  # GCC saves P5: [SIM] and [EE-171]


def test_a_product_takes_a_load_along_where_the_compiler_bundles() -> None:
    """In vdsp-O2 a 16-bit product and a load of the next operands share an instruction of 64 bits."""

    def operations(profile: Any) -> list[int]:
        counters = cost_kernels.energies.compile(profile).counters
        return [each.issue_cclk for counter in counters for each in counter.charges if each.op is Op.LOAD16]

    assert 0 not in operations(GCC_O2)
    assert 0 in operations(VDSP_O2)


def test_cycles_depend_on_the_picture() -> None:
    """Non-maximum suppression costs more or less with what it sees; equal pictures cost the same."""
    random = np.random.default_rng(5)
    pictures = random.integers(0, 256, (2, 4, 64), np.uint8)
    out = np.zeros(64, np.uint8)
    costs = [cclk(cost_kernels.suppress, *rows, out) for rows in (*pictures, *pictures)]
    assert costs[:2] == costs[2:]
    assert costs[0] != costs[1]


def test_a_table_made_by_the_optimiser_is_costed_and_belongs_to_no_array() -> None:
    """A chain of `elif` that becomes a table in memory runs right, and its loads are not the arrays' loads."""
    row, out = np.arange(8, dtype=np.uint8), words(8)
    assert cclk(cost_kernels.translate, row, out) > 0
    assert out.tolist() == [10, 77, 5, 1234, 99, 33, 0, 0]
    names = {
        name
        for each in cost_kernels.translate.compile(VDSP_O2).counters
        for name, _, _ in each.array_accesses
    }
    assert names == {"row", "out"}


def test_every_line_is_counted_as_often_as_it_ran() -> None:
    """Line executions are those of the Python source: the loop's line, the test in it, and the body."""
    row = np.array([1, 200, 3, 250, 5], np.uint8)
    ran = line_executions(cost_kernels.positions_above, row, 100, words(9))
    first = 1
    assert ran[first + 4] == 5  # the test
    assert ran[first + 5] == ran[first + 6] == 2  # what it guards


def test_accesses_are_counted_per_array() -> None:
    """A kernel's reads and writes of each array follow from its counts."""
    code = cost_kernels.copy_words.compile(VDSP_O2)
    totals = code.new_totals()
    cost_kernels.copy_words.prepare(code, [words(17), words(17)], totals).run(words(17), words(17))
    found: dict[str, tuple[int, int]] = {}
    for counter, events in zip(code.counters, totals.tolist(), strict=True):
        for name, reads, writes in counter.array_accesses:
            found[name] = (events * reads, events * writes)
    assert found == {"source": (17, 0), "target": (0, 17)}


def test_the_same_kernel_costs_the_same_wherever_it_stands(import_kernels: ImportText) -> None:
    """Moving a kernel to another file, line and module name does not change its cycles."""
    text = "@kernel\ndef f(a: u8[:], b: u8[:]):\n    for i in range(len(a)):\n        b[i] = max(a[i] - 3, 0) * 5\n"
    here: Kernel = import_kernels(text).f
    there: Kernel = import_kernels("\n\n# moved\n" + text).f
    row = np.arange(100, dtype=np.uint8)
    assert cclk(here, row, row.copy()) == cclk(there, row, row.copy())


def test_counting_does_not_change_the_pixels() -> None:
    """The build without counters writes the same pixels and costs nothing."""
    random = np.random.default_rng(1)
    rows = list(random.integers(0, 256, (4, 64), np.uint8))
    counted, bare = np.zeros(64, np.uint8), np.zeros(64, np.uint8)
    cost_kernels.suppress(*rows, counted)
    code = cost_kernels.suppress.compile(VDSP_O2, counted=False)
    assert code.counters == ()
    arguments = (*rows, bare)
    assert cost_kernels.suppress.prepare(code, arguments, code.new_totals()).run(*arguments).issue_cclk == 0
    np.testing.assert_array_equal(counted, bare)


def test_dividing_by_zero_is_told_and_the_host_lives_on() -> None:
    """What C leaves undefined ends the call, at every width."""
    zeros = np.zeros(4, np.uint8)
    with pytest.raises(KernelError, match="the divisor must not be 0"):
        cost_kernels.quotients(np.full(4, 9, np.uint8), zeros, zeros.copy())
    with pytest.raises(KernelError, match="the divisor must not be 0"):
        cost_kernels.quotient(9, 0)
