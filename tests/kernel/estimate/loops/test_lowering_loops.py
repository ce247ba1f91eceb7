"""What a compiler for the Blackfin makes of loops: which are counted, what moves along with them, what becomes a call."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from bfsim.kernel import GCC_O2, VDSP_O2, keys
from bfsim.kernel.estimate.costing import optimised
from bfsim.kernel.estimate.prediction.predict import Likelihood
from bfsim.kernel.estimate.registers.phi_copies import _is_circular
from bfsim.kernel.ir.control_flow import COPIED, ControlFlow
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule
from tests.kernel.lowered import context, lowered
from tests.kernel.modules import kernel_of


def loops(body: str, head: str = "a: i32[:], n: i32", before: str = "s = 0") -> str:
    """Return a kernel that repeats `body` for i in range(n)."""
    rows = "\n        ".join(body.splitlines())
    return f"def f({head}) -> i32:\n    {before}\n    for i in range(n):\n        {rows}\n    return s\n"


@pytest.mark.parametrize(("start", "counted"), [("8", True), ("n", False)])
def test_a_loop_that_follows_from_a_constant_is_played_through(
    start: str, counted: bool, tmp_path: Path
) -> None:
    """8, 4, 2, 1: four iterations of a hardware loop; from a parameter nobody knows."""
    text = f"def f(b: u32, n: u32) -> u32:\n    k = u32({start})\n    while k > 0:\n        b = b ^ (b >> k)\n        k = k >> 1\n    return b\n"
    assert (Op.LOOP_SETUP in lowered(text, tmp_path)) is counted


@pytest.mark.parametrize(
    ("kind", "value", "called"),
    [("i32", "0", True), ("u16", "0", True), ("u8", "7", True), ("u8", "n", True), ("u16", "7", False), ("i32", "i", False)],
)  # fmt: skip
def test_filling_with_one_byte_is_a_call(kind: str, value: str, called: bool, tmp_path: Path) -> None:
    """memset fills with a byte; other patterns stay loops."""
    found = lowered(loops(f"a[i] = {value}", f"a: {kind}[:], n: i32"), tmp_path)
    assert (Op.CALL in found, Op.LOOP_SETUP in found) == (called, not called)


def test_a_short_fill_and_another_compiler_keep_the_loop(tmp_path: Path) -> None:
    """Fourteen bytes of zeros are stored one by one, and four of another byte; VisualDSP++ is not known to call."""
    text = "def f(a: {}[:], x: i32):\n    for i in range({}):\n        a[i] = {}\n"
    for kind, value, few, many in (("u8", "0", 14, 15), ("i16", "0", 7, 8), ("u8", "x", 4, 9)):
        assert not {Op.CALL, Op.TAIL_CALL} & lowered(text.format(kind, few, value), tmp_path).keys()
        assert Op.TAIL_CALL in lowered(text.format(kind, many, value), tmp_path)
    assert Op.CALL not in lowered(loops("a[i] = 0"), tmp_path, VDSP_O2)


@pytest.mark.parametrize(("order", "hardware"), [("p = 0\n    q = 0", False), ("q = 0\n    p = 0", True)])
def test_a_value_that_a_later_variable_takes_over_ends_a_hardware_loop(
    order: str, hardware: bool, tmp_path: Path
) -> None:
    """q = p; p = y: the copy of y must wait for that of p, unless q was declared, and is copied, first."""
    text = loops("y = a[i] + (p ^ q)\na[i] = y\nq = p\np = y", before=f"s = 0\n    {order}")
    assert (Op.LOOP_SETUP in lowered(text, tmp_path)) is hardware


def test_one_value_that_is_kept_for_the_next_iteration_needs_no_copy(tmp_path: Path) -> None:
    """The difference of neighbours: nothing but the load, a move of the old value, the sum and the store."""
    found = lowered(loops("y = a[i]\na[i] = y - p\np = y", before="s = 0\n    p = 0"), tmp_path)
    assert Op.LOOP_SETUP in found


def test_values_that_swap_places_take_a_third_register(tmp_path: Path) -> None:
    """a, b = b, a is three moves; one value that follows another is one."""
    text = "def f(a: i32, b: i32, out: i32[:]):\n    if a > b:\n        t = a\n        a = b\n        {}\n    out[0] = a\n    out[1] = b\n"
    assert lowered(text.format("b = t"), tmp_path)[Op.MOVE] == 3 + 1  # and the pointer
    assert _is_circular({"a": "b", "b": "c", "c": "a"})
    assert not _is_circular({"a": "b", "b": "c"})


@pytest.mark.parametrize(("stop", "counted"), [("n", True), ("n + 1", False)])
def test_a_loop_up_to_and_with_its_bound_may_be_endless(stop: str, counted: bool, tmp_path: Path) -> None:
    """`i <= n` always holds for the largest n: with another exit, no register counts."""
    text = f"def f(a: u8[:], n: i32) -> i32:\n    s = 0\n    for i in range({stop}):\n        if a[i] == 3:\n            break\n        s += a[i]\n    return s\n"
    assert (Op.LOOP_SETUP in lowered(text, tmp_path)) is counted


@pytest.mark.parametrize(("step", "counted"), [(1, True), (2, False)])
def test_a_stack_that_a_continue_skips_is_counted_down(step: int, counted: bool, tmp_path: Path) -> None:
    """GCC, and LLVM, make two loops of `while top: pop; if seen: continue; push; count`; the inner one counts by its first test."""
    found = context(
        "def f(stack: i32[:], seen: u8[:], top: i32) -> i32:\n    count = 0\n"
        f"    while top > 0:\n        top -= {step}\n        p = stack[top]\n"
        "        if seen[p] != 0:\n            continue\n        seen[p] = 1\n"
        "        if p > 5:\n            stack[top] = p - 1\n            top += 1\n        count += 1\n    return count\n",
        tmp_path,
    )
    (inner,) = (loop for loop in found.flow.loops if found.flow.is_split(loop))
    assert found.flow.ending(inner) == inner.header
    assert (inner.header in found.counters.counted) is counted
    assert found.likelihood.taken[
        inner.header, found.flow.blocks[inner.header].successors[0]
    ] == pytest.approx(0.89)


def test_the_least_element_goes_along_in_a_register(tmp_path: Path) -> None:
    """a[least] is loaded before the loop; one load an iteration is left, and the branch, since two values are chosen."""
    least, behind = "if a[i] < a[s]:\n    s = i\n", "    return s\n"
    wanted = loops(least).removesuffix(behind) + "    t = a[s]\n    a[s] = n\n    return t\n"
    assert Op.COND_MOVE not in lowered(wanted, tmp_path)
    alone = lowered(loops(least), tmp_path)
    assert alone[Op.COND_MOVE] == 1  # nothing behind the loop loads a[least], so it is not sure to be loaded
    stored = lowered(loops(least + "a[i] = n"), tmp_path)
    assert stored[Op.COND_MOVE] == 1  # the store may change a[least], which is loaded again


def test_a_flag_that_is_added_is_not_kept(tmp_path: Path) -> None:
    """same = 1 or 0, then hits += same: only where it is 1, something is added; a flag with other uses is set."""
    text = (
        "def f(a: u8[:], b: u8[:], n: i32, m: i32) -> i32:\n    s = 0\n    last = 0\n    for i in range(n):\n"
        "        same = 1\n        for j in range(m):\n            if a[i + j] != b[j]:\n                same = 0\n"
        "                break\n        s += same\n        {}\n    return s + last\n"
    )
    assert (
        lowered(text.format("last = 0"), tmp_path)[Op.IMM]
        < lowered(text.format("last += same * n"), tmp_path)[Op.IMM]
    )


def test_a_stepped_value_is_compared_behind_its_step(tmp_path: Path) -> None:
    """LLVM's `j > 0` before j - 1 is C's `j - 1 >= 0`; a value that is not stepped is compared as it is."""
    found = context(
        "def f(a: i32[:], n: i32, v: i32) -> i32:\n    j = n - 1\n    while j >= 0 and a[j] > v:\n"
        "        a[j + 1] = a[j]\n        j = j - 1\n    return j\n",
        tmp_path,
    )
    rows = [each for block in found.routine.blocks for each in block.instructions]
    phis = {name for each in rows if each.opcode == "phi" for name in each.operands}
    steps = {each.result for each in rows if each.opcode == "add"} & phis
    tests = [each.operands for each in rows if each.opcode == "icmp"]
    assert {right for left, right in tests if left in steps} == {"-1"}
    assert any(left not in steps for left, _ in tests)


def test_what_is_reloaded_for_a_product_is_not_copied_first(tmp_path: Path) -> None:
    """R *= R destroys an operand: one that comes from the stack may be; the others are moved."""
    names = [f"k{number}" for number in range(11)]
    head = ", ".join(("a: i32[:]", "n: i32", *(f"{name}: i32" for name in names)))
    body = "x = a[i]\na[i] = " + " ^ ".join(f"x * {name}" for name in names)
    few = lowered(loops("x = a[i]\na[i] = x * k0 ^ x * k1", "a: i32[:], n: i32, k0: i32, k1: i32"), tmp_path)
    many = lowered(loops(body, head), tmp_path)
    assert many[Op.MUL32] == 11
    assert many[Op.MOVE] < few[Op.MOVE] + 9  # nine products more, and not a move for each


@pytest.mark.parametrize(
    ("other", "operations"), [("elif x > 255:\n        x = 255", 2), ("elif x > 255:\n        x = y", 0)]
)
def test_cutting_to_a_range_is_a_minimum_and_a_maximum(other: str, operations: int, tmp_path: Path) -> None:
    """`if x < 0: x = 0`, `elif x > 255: x = 255` has no branch; with another value than the bound it has."""
    found = lowered(
        f"def f(x: i32, y: i32) -> i32:\n    if x < 0:\n        x = 0\n    {other}\n    return x\n", tmp_path
    )
    assert found[Op.DSP_ALU] == operations
    assert (Op.COMPARE in found) is (operations == 0)


@pytest.mark.parametrize(("first", "products"), [("rows[i] * n", 1), ("i * n", 0)])
def test_a_first_address_that_depends_on_data_is_computed(first: str, products: int, tmp_path: Path) -> None:
    """A counter of the loop around steps the address along; what is loaded has to be multiplied."""
    text = (
        "def f(a: u8[:], rows: u8[:], n: i32) -> i32:\n    s = 0\n    for i in range(n):\n"
        f"        row = {first}\n        for j in range(n):\n            s += a[row + j]\n    return s\n"
    )
    assert lowered(text, tmp_path)[Op.MUL32] == products


def test_the_cache_depends_on_the_lowering() -> None:
    """A rule of the lowering that changes must not meet kernels that were costed without it."""
    assert {"select.py", "keys.py"} <= {Path(path).name for path in keys.sources()}
    assert GCC_O2.library.fill is not None


@pytest.mark.parametrize(("behind", "counted"), [("return i", True), ("return a[i]", False)])
def test_a_counter_that_is_wanted_behind_its_loop_is_counted(
    behind: str, counted: bool, tmp_path: Path
) -> None:
    """Of half-words and with two exits a pointer would take its place, but for its value behind the loop."""
    text = (
        "def f(a: i16[:], start: i32, n: i32, x: i32) -> i32:\n    i = start\n"
        f"    while i < n and a[i] < x:\n        i += 1\n    {behind}\n"
    )
    assert (Op.LOOP_SETUP in lowered(text, tmp_path)) is counted


DIGITS = """def f(bits: u32, n: i32) -> i32:
    k = 0
    while k < n and {}:
        k += 1
    return k
"""


@pytest.mark.parametrize(("test", "copied"), [("(bits >> u32(k)) & 1 == 0", True), ("bits > 7", False)])
def test_both_tests_of_a_loop_come_to_its_end(test: str, copied: bool, tmp_path: Path) -> None:
    """`while a and b` ends with both [GCC: ch2], so that no hardware loop ends where its count does; one that never changes goes before it."""
    (routine,) = read_module(optimised(kernel_of(DIGITS.format(test), tmp_path).function, GCC_O2))
    assert any(block.label.endswith(COPIED) for block in routine.blocks) is copied


def test_a_copied_test_counts_as_the_source_says(tmp_path: Path) -> None:
    """The rotated loop is what runs, too: the lowest bit that is set, or the limit."""
    digits = kernel_of(DIGITS.format("(bits >> u32(k)) & 1 == 0"), tmp_path)
    for bits in (0, 1, 8, 0x8000_0000):
        expected = min(20, (bits & -bits).bit_length() - 1 if bits else 32)
        code = digits.compile(GCC_O2)
        assert digits.prepare(code, [], code.new_totals()).run(bits, 20).value == expected


@pytest.mark.parametrize(("first", "steps"), [("y * n", 0), ("0", 1)])
def test_a_counter_is_a_difference_to_what_is_prepared(first: str, steps: int, tmp_path: Path) -> None:
    """Of a row in a picture x is the pointer less the row's start, and nothing is left at the end of the loop [GCC: ivopts]; of an array x is kept."""
    text = (
        "def f(a: u8[:], y: i32, n: i32, least: i32) -> i32:\n    s = 0\n    for x in range(n):\n"
        f"        if a[{first} + x] >= least:\n            s = s ^ x\n    return s\n"
    )
    eliminated = context(text, tmp_path).counters.eliminated
    assert len(eliminated) == 1 - steps


def test_a_bound_that_something_exceeds_is_not_the_largest(tmp_path: Path) -> None:
    """`i <= n` ends where n is known to be below another number [GCC: simplify_using_initial_values]."""
    text = (
        "def f(a: u8[:], n: i32, w: i32) -> i32:\n    s = 0\n    if n < w:\n        for i in range(-n, n + 1):\n"
        "            if a[i + n] == 3:\n                break\n            s += a[i + n]\n    return s\n"
    )
    assert Op.LOOP_SETUP in lowered(text, tmp_path)


@pytest.mark.parametrize(("joined", "branches"), [("and", 2), ("or", 2)])
def test_each_part_of_a_test_is_a_branch(joined: str, branches: int, tmp_path: Path) -> None:
    """LLVM makes one test of `x < 0 and y < 0`; GCC does not, for a branch is cheap by its reckoning."""
    text = f"def f(a: i32[:], n: i32, x: i32, y: i32):\n    if x < n {joined} y > n + 7:\n        a[0] = 1\n"
    found = context(text, tmp_path)
    tests = [block for block in found.routine.blocks if len(set(block.successors)) == 2]
    assert len(tests) == branches
    assert not any(each.opcode in ("select", "and", "or") for block in tests for each in block.instructions)


TWO_WAYS_OUT = """def f(a: u8[:], n: i32, most: i32) -> i32:
    i = 0
    s = 0
    while i < n and {}:
        s += a[i]
        i += 1
    return s
"""


@pytest.mark.parametrize(("test", "hardware"), [("s < most", False), ("i < 40", True)])
def test_the_first_test_of_a_loop_counts_unless_constants_say_that_another_ends_it(
    test: str, hardware: bool, tmp_path: Path
) -> None:
    """A hardware loop ends where its count does [GCC: find_simple_exit]: with `s < most` the count is tested before the end."""
    found = lowered(TWO_WAYS_OUT.format(test), tmp_path)
    assert (Op.LOOP_SETUP in found) is hardware
    assert (Op.NOP in found) is False or hardware


SKIPPED = """def f(words: u32[:], labels: u8[:], n: i32, interest: u32) -> i32:
    corner = 0
    x = 0
    while x < n and words[x] & interest == 0:
        corner = labels[x]
        labels[x] = 0
        x = x + 1
    return corner
"""
"""GCC -O2: LSETUP, and in the loop a load, AND, CC = R0 == 0, IF !CC JUMP, a load and a store."""


@pytest.mark.parametrize("without", [(), (Rule.ROTATED_ONCE,)])
def test_a_loop_that_counts_at_its_end_is_not_rotated_again(
    without: tuple[Rule, ...], tmp_path: Path
) -> None:
    """LLVM would, because `corner` is wanted behind the loop alone; then another test than that of the count would be the last."""
    found = lowered(SKIPPED, tmp_path, replace(GCC_O2, without=without))
    assert (Op.LOOP_SETUP in found) is not bool(without)


@pytest.mark.parametrize(("bound", "likely"), [("n", 0.64), ("n - 1", 0.5)])
def test_a_counter_below_a_sum_written_in_the_loop_is_no_guess(
    bound: str, likely: float, tmp_path: Path
) -> None:
    """With the types of stdint.h the sum is none of a name for GCC [get_base_value]."""
    found = context(
        f"def f(a: u8[:], n: i32, k: i32):\n    for i in range(k, n):\n        if i + 3 < {bound}:\n            a[i] = a[i + 1] + 1\n",
        tmp_path,
    )
    (loop,) = found.flow.loops
    block = found.flow.blocks[loop.header]
    stores = next(each for each in block.successors if each != loop.latch)
    assert found.likelihood.taken[loop.header, stores] == pytest.approx(likely, abs=0.01)


def test_a_loop_behind_a_test_is_guessed_to_be_rare(tmp_path: Path) -> None:
    """Of a loop around it; a test of its own that decides whether it is entered is another matter [GCC: PRED_LOOP_GUARD]."""
    found = context(
        "def f(a: u8[:], b: u8[:], n: i32, m: i32):\n    for i in range(n):\n        if a[i] > b[i]:\n"
        "            for k in range(m):\n                b[k] = b[k] + a[i]\n        a[i] = 3\n",
        tmp_path,
    )
    inner, outer = found.flow.loops
    test = found.flow.blocks[outer.header]
    leads = next(
        each
        for each in test.successors
        if inner.header in found.flow.post_dominators[each] or each not in found.flow.dominators[outer.latch]
    )
    assert found.likelihood.taken[outer.header, leads] == pytest.approx(0.27, abs=0.01)


TWO_TESTS = """
define i32 @f(i32 %c) {{
first:
  %one = icmp {0} i32 %c, 8
  br i1 %one, label %{1}, label %{2}
second:
  %other = icmp {3} i32 %c, 9
  br i1 %other, label %inside, label %outside
inside:
  ret i32 1
outside:
  ret i32 0
}}
"""


@pytest.mark.parametrize("tests", [("eq", "inside", "second", "eq"), ("sge", "second", "outside", "sle")])
def test_two_tests_that_are_made_as_one_are_guessed_as_one(tests: tuple[str, ...]) -> None:
    """Evenly, whether either of them or both shall hold: nothing is said of a number within a range."""
    (routine,) = read_module(TWO_TESTS.format(*tests))
    taken = Likelihood(ControlFlow(routine), {"second": "inside"}).taken
    ways = taken.get(("first", "inside"), 0), taken["first", "second"] * taken["second", "inside"]
    assert sum(ways) == pytest.approx(0.5)
