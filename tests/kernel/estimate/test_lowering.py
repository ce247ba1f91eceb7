"""What a compiler for the Blackfin makes of small kernels: branches, minima, loops, spills, flags."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from benchmarks.twins.lines import grow_segments
from bfsim.errors import ConfigError
from bfsim.kernel import GCC_O2, Kernel, profile_named
from bfsim.kernel.estimate.arithmetic.multiples import multiple
from bfsim.kernel.estimate.costing import optimised
from bfsim.kernel.estimate.prediction.predict import combined
from bfsim.kernel.estimate.scheduling.schedule import issues
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.operations import COSTS, Op
from bfsim.kernel.rules import Rule
from tests.kernel.lowered import context, lowered
from tests.kernel.modules import import_text, kernel_of
from tests.kernel.running import CALLING_VDSP, run


@pytest.mark.parametrize(
    "body", ["y = x if x < 9 else 9", "y = x\n    if y > 9:\n        y = 9", "y = min(x, 9)"]
)
def test_a_minimum_is_one_operation_however_it_is_written(body: str, tmp_path: Path) -> None:
    """MIN and its constant; no comparison and no branch. Two NOPs keep the return away from the call."""
    found = lowered(f"def f(x: i32) -> i32:\n    {body}\n    return y\n", tmp_path)
    assert found == {Op.NOP: 2, Op.DSP_ALU: 1, Op.IMM: 1, Op.RETURN: 1}


@pytest.mark.parametrize(
    ("body", "shifts"),
    [
        ("y = (a[0] * a[1]) >> 4\n    if y > 255:\n        y = 255", 1),
        ("y = a[0] + a[1] - 20\n    if y < 0:\n        y = 0", 0),
        ("y = (a[0] - a[1]) >> 2\n    if y < -9:\n        y = -9\n    elif y > 50:\n        y = 50", 1),
    ],
)
def test_a_minimum_of_what_was_shifted_or_added_is_one(body: str, shifts: int, tmp_path: Path) -> None:
    """LLVM tests the product, the sum and the difference; GCC has MIN or MAX, and no branch."""
    text = f"def f(a: u8[:]) -> i32:\n    {body}\n    return y\n"
    found = lowered(text, tmp_path)
    assert found[Op.DSP_ALU] == (2 if "elif" in body else 1)
    assert (found[Op.SHIFT], found[Op.COMPARE]) == (shifts, 0)
    kernel = kernel_of(text, tmp_path)
    for pair in ((0, 0), (3, 250), (250, 3), (255, 255), (9, 12), (60, 200)):
        assert run(kernel, np.array(pair, np.uint8)).value == kernel.python(list(pair))


@pytest.mark.parametrize(
    ("element", "value", "is_call"),
    [
        ("i32", "quotient(a[i], 10)", True),
        ("i32", "a[i] // 10", True),
        ("i32", "a[i] % 10", True),
        ("i16", "quotient(a[i], 10)", True),
        ("u8", "a[i] // 10", True),
        ("u8", "a[i] % 10", True),
        ("u8", "quotient(a[i], 10)", False),
        ("u8", "u32(a[i]) // 10", False),
        ("u8", "(u32(a[i]) + u32(a[0])) // 10", True),
        ("u32", "a[i] // 10", False),
    ],
)
def test_what_is_divided_by_a_constant_as_a_signed_int_calls_the_library(
    element: str, value: str, is_call: bool, tmp_path: Path
) -> None:
    """Elements of i32 and i16, what `//` and `%` divide, functions of ints in C, and u32 sums that are known to be small; so does GCC 12.2."""
    kind = "u32" if "u32" in element + value else "i32"
    text = f"def f(a: {element}[:], out: {kind}[:]):\n    for i in range(len(a)):\n        out[i] = {value}"
    assert (lowered(text, tmp_path)[Op.CALL] > 0) is is_call


@pytest.mark.parametrize(
    ("element", "value", "is_call"),
    [
        ("u8", "a[i] // 10", True),
        ("u8", "a[i] % 10", True),
        ("u8", "(a[i] // 10) * 10", True),
        ("u16", "a[i] // 7", True),
        ("u8", "quotient(a[i], 10)", False),
        ("u8", "u32(a[i]) // 10", False),
    ],
)
def test_a_division_of_which_only_a_byte_is_stored_calls_the_library_all_the_same(
    element: str, value: str, is_call: bool, tmp_path: Path
) -> None:
    """LLVM divides in fewer bits then, under no name; of `//` and `%`, C divides ints (the estimate was 95 % too low)."""
    text = f"def f(a: {element}[:], o: {element}[:]) -> None:\n    for i in range(len(a)):\n        o[i] = {value}\n"
    assert (lowered(text, tmp_path)[Op.CALL] > 0) is is_call


def test_a_sum_with_a_constant_is_no_narrow_factor(tmp_path: Path) -> None:
    """x * 454 - 58112 to LLVM; GCC subtracts, and multiplies words: R0 = R0 + R1, R0 *= R2."""
    text = "def f(a: u8[:], out: i16[:]):\n    out[0] = ((a[0] - 128) * 454 + {0}) >> 8\n"
    for added, sums in ((0, 1), (64, 2)):
        found = lowered(text.format(added), tmp_path)
        assert (found[Op.MUL32], found[Op.MUL16], found[Op.ALU]) == (1, 0, sums)
        kernel = kernel_of(text.format(added), tmp_path)
        for value in (0, 1, 127, 128, 255):
            out = np.zeros(1, np.int16)
            run(kernel, np.array([value], np.uint8), out)
            assert out[0] == ((value - 128) * 454 + added) >> 8


def test_an_absolute_value_is_one_operation_but_not_of_a_difference(tmp_path: Path) -> None:
    """-(x - y) has become y - x before anyone looks for an absolute value, so that stays a branch."""
    text = "def f(x: i32, y: i32) -> i32:\n    z = {0}\n    if z < 0:\n        z = -z\n    return z\n"
    assert Op.DSP_ALU in lowered(text.format("x ^ y"), tmp_path)
    difference = lowered(text.format("x - y"), tmp_path)
    assert Op.DSP_ALU not in difference
    assert difference[Op.COMPARE] == 1


def test_a_choice_of_two_values_that_are_there_is_a_conditional_move(tmp_path: Path) -> None:
    """An arm that must be computed first makes it a branch."""
    found = lowered("def f(a: i32, b: i32, c: i32) -> i32:\n    return c if a < b else a\n", tmp_path)
    assert found[Op.COND_MOVE] == 1
    branched = lowered("def f(a: i32, b: i32, c: i32) -> i32:\n    return c * 3 if a < b else a\n", tmp_path)
    assert branched[Op.COND_MOVE] == 0


def test_values_are_guessed_to_be_positive_and_unequal(tmp_path: Path) -> None:
    """GCC's heuristics: 59 % against x < 0, 66 % against x == 7, nothing about x == 0."""
    for test, chance in (
        ("x < 0", 0.41),
        ("x >= 0", 0.59),
        ("x == 7", 0.34),
        ("x == 0", 0.5),
        ("x < 40", 0.5),
    ):
        text = f"def f(x: i32, a: i32[:]):\n    if {test}:\n        a[0] = 1\n    else:\n        a[1] = a[2]\n    a[3] = 5\n"
        known = context(text, tmp_path)
        block = known.flow.routine.blocks[0]
        first = known.flow.blocks[block.successors[0]]
        stores_first = any(each.opcode == "store" and each.operands[0] == "1" for each in first.instructions)
        found = known.likelihood.taken[block.label, block.successors[0]]
        assert found == pytest.approx(chance if stores_first else 1 - chance), test


@pytest.mark.parametrize(("joined", "goes_on"), [("and", 0.5), ("or", 0.67)])
def test_only_a_test_that_leads_to_a_continue_by_itself_is_guessed_by_it(
    joined: str, goes_on: float, tmp_path: Path
) -> None:
    """The second part of `and` does so; each of `or` does."""
    found = context(
        f"def f(a: i32[:], b: i32[:], least: i32, most: i32):\n    for x in range(len(a)):\n"
        f"        if a[x] < least {joined} b[x] > most:\n            continue\n        b[x] = a[x]\n",
        tmp_path,
    )
    taken = found.likelihood.taken
    assert taken["body", joined] == pytest.approx(goes_on)  # on to the second part
    assert taken[joined, "after.1"] == pytest.approx(0.67)


def test_two_heuristics_are_combined() -> None:
    """Dempster and Shafer's rule; even votes change nothing."""
    assert combined([]) == combined([0.5]) == 0.5
    assert combined([0.8, 0.8]) == pytest.approx(0.64 / (0.64 + 0.04))
    assert combined([0.7, 0.3]) == pytest.approx(0.5)


def test_what_does_not_change_in_a_loop_is_computed_before_it(tmp_path: Path) -> None:
    """Arithmetic moves out; a load moves only if nothing in the loop may write what it reads."""
    moved = context(
        "def f(a: i32[:], b: u16[:], n: i32):\n    for i in range(n):\n        a[i] = b[3] + n * 7\n",
        tmp_path,
    )
    kept = context(
        "def f(a: i32[:], b: i32[:], n: i32):\n    for i in range(n):\n        a[i] = b[3]\n", tmp_path
    )

    def in_loop(known: Context, opcode: str) -> bool:
        (loop,) = known.flow.loops
        return any(
            known.code_motion.of[each.result or ""] in loop.blocks
            for block in known.routine.blocks
            for each in block.instructions
            if each.opcode == opcode
        )

    assert not in_loop(moved, "load")
    assert in_loop(kept, "load")  # both are words: they may be the same array
    assert not in_loop(moved, "mul")


def test_pointers_walk_along_for_nothing_or_for_an_addition(tmp_path: Path) -> None:
    """A step as wide as the access is a post-increment; another step is one addition an iteration."""
    text = "def f(a: u8[:], out: u8[:], n: i32):\n    for i in range(n):\n        out[i] = a[{0}]\n"
    groups = context(text.format("i"), tmp_path).induction_variables.all
    assert [each.steps_free for each in groups] == [True, True]
    strided = context(text.format("3 * i + 1"), tmp_path).induction_variables.all
    assert sorted((each.increment.constant, each.steps_free) for each in strided) == [(1, True), (3, False)]


def test_a_flag_that_ends_a_loop_is_threaded_away() -> None:
    """`while j < n and found == 0`: who sets the flag jumps out, division and all, and the loop counts its iterations."""
    (routine,) = read_module(optimised(grow_segments.function, GCC_O2))
    known = Context(routine, GCC_O2)
    assert known.jump_threading.names
    inner, _ = known.flow.loops
    inside = [each for label in inner.blocks for each in known.flow.blocks[label].instructions]
    assert inner.header in known.counters.counted
    assert not any(each.is_division for each in inside)


def test_few_iterations_and_calls_keep_a_loop_from_being_counted(tmp_path: Path) -> None:
    """Three iterations are too few for a hardware loop; four are enough; a division by a variable calls the library."""
    text = "def f(a: i32[:], b: u32):\n    for i in range({0}):\n        a[i] = a[i] {1}\n"
    for iterations, rest, counted in (
        (3, "* a[i] ^ a[i] + 7", False),
        (4, "* a[i] ^ a[i] + 7", True),
        (9, "+ i32(b // u32(a[i]))", False),
    ):
        known = context(text.format(iterations, rest), tmp_path)
        assert {loop.header in known.counters.counted for loop in known.flow.loops} == {counted}


def test_counting_bits_is_one_operation(tmp_path: Path) -> None:
    """`while x: x &= x - 1` has no iterations on the Blackfin: ONES counts the bits."""
    kernel: Kernel = import_text(
        "@kernel\ndef f(x: u32) -> i32:\n    n = 0\n    while x != 0:\n        x = x & (x - 1)\n        n += 1\n    return n\n",
        tmp_path,
    ).f
    code = kernel.compile(GCC_O2)
    cost = {x: kernel.prepare(code, [], code.new_totals()).run(x).issue_cclk for x in (1, 0xFFFF, 0xFFFFFFFF)}
    assert len(set(cost.values())) == 1
    assert kernel(0xFFFF) == 16


@pytest.mark.parametrize(
    ("factor", "ops"),
    [
        (8, "shift"),
        (5, "add_shift"),
        (10, "add_shift shift"),
        (15, "shift alu"),
        (18, "shift add_shift"),
        (21, "add_shift shift alu"),
        (83, "add_shift shift alu shift alu"),
        (359, "add_shift shift alu shift alu"),
        (-1, "shift alu"),
        (-28, "shift alu shift"),
        (-20, "add_shift shift alu"),
    ],
)
def test_products_with_a_constant_are_shifts_and_sums(factor: int, ops: str) -> None:
    """As GCC 12.2 compiles `x * factor` for the Blackfin, moves apart."""
    assert " ".join(each.value for each in multiple(factor) or ()) == ops


@pytest.mark.parametrize("factor", [73, 74, 82, 134, 454, 0x12345, -100, -208])
def test_other_constants_are_multiplied_with(factor: int) -> None:
    """GCC loads these, and has `*=`."""
    assert multiple(factor) is None


def test_more_values_than_registers_are_reloaded(tmp_path: Path) -> None:
    """Sixteen sums in one loop do not fit in eight data registers; six do."""

    def moves(count: int) -> int:
        names = [f"s{each}" for each in range(count)]
        start = "".join(f"    {name} = {number}\n" for number, name in enumerate(names))
        iteration = "".join(f"        {name} = ({name} ^ x) * {name}\n" for name in names)
        ends = " ^ ".join(names)
        text = f"def f(a: i32[:]) -> i32:\n{start}    for i in range(len(a)):\n        x = a[i]\n{iteration}    return {ends}\n"
        found = lowered(text, tmp_path)
        return found[Op.LOAD32] + found[Op.STORE32]

    assert moves(6) == moves(3)
    assert moves(16) - moves(12) > 2 * 4


def test_an_independent_operation_hides_a_wait() -> None:
    """A value moved to a pointer register is awaited four cycles; each operation in between takes one off."""

    def banks(name: str) -> RegisterBank:
        return RegisterBank.POINTER if name.startswith("p") else RegisterBank.DATA

    move = MachineInstruction(Op.MOVE, 1, "p0", RegisterBank.POINTER, (("r0", RegisterBank.DATA),))
    other = MachineInstruction(Op.ALU, 2, "r5", RegisterBank.DATA, (("r6", RegisterBank.DATA),))
    load = MachineInstruction(Op.LOAD16, 3, "r1", RegisterBank.DATA, (("p0", RegisterBank.POINTER),))
    assert sum(each.stall_cclk for each in issues([move, load], banks, parallel=False)) == 4
    assert sum(each.stall_cclk for each in issues([move, load, other], banks, parallel=False)) == 3


def test_a_fitted_rule_can_be_left_out(tmp_path: Path) -> None:
    """Without the rule about differences, an absolute difference is one operation: what it is worth can be seen."""
    text = "def f(x: i32, y: i32) -> i32:\n    z = x - y\n    if z < 0:\n        z = -z\n    return z\n"
    without = dataclasses.replace(GCC_O2, without=(Rule.DIFFERENCE,))
    assert lowered(text, tmp_path, without)[Op.DSP_ALU] == 1
    assert lowered(text, tmp_path, GCC_O2)[Op.DSP_ALU] == 0


def test_a_kernel_has_a_size(tmp_path: Path) -> None:
    """Bytes of code per routine, callees by themselves; a library's are not counted."""
    module = import_text(
        "@kernel\ndef g(x: i32) -> i32:\n    return x ^ 5\n@kernel\ndef f(x: i32) -> i32:\n    return g(x) + g(x + 1)\n",
        tmp_path,
    )
    sizes = module.f.code_bytes(CALLING_VDSP)
    assert set(sizes) == {module.f.function.symbol, module.g.function.symbol}
    assert sizes[module.g.function.symbol] == sum(
        COSTS[op].nbytes for op in (Op.NOP, Op.NOP, Op.IMM, Op.ALU, Op.RETURN)
    )


def test_profiles_have_names() -> None:
    """An unknown one is told what there is."""
    assert profile_named("gcc-O2") is GCC_O2
    with pytest.raises(ConfigError, match="must be one of gcc-O0, gcc-O2, gcc, gcc-adi, vdsp-O2, not 'icc'"):
        profile_named("icc")
