"""The -O0 cost model against code of GCC 12.2 for the Blackfin, written beside each kernel as GCC wrote it."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings

from bfsim.kernel import Kernel
from bfsim.kernel.costs.charges import BlockCost, Charge
from bfsim.kernel.estimate.costing import optimised
from bfsim.kernel.estimate.unoptimised.lowering import lower
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import Routine
from bfsim.kernel.operations import Op
from bfsim.kernel.profile import GCC_O0
from tests.kernel.conftest import ImportText
from tests.kernel.programs import programs

TAKEN_CCLK, NOT_TAKEN_CCLK, CALL_CCLK, DIVISION_CCLK = 9, 1, 5, 196
ENTRY, EXIT = [Op.LINK, Op.STORE32, Op.STORE32, Op.STORE32], [Op.IMM, Op.UNLINK, Op.RETURN]
HEAD = """
@kernel
def callee(x: i32) -> i32:
    return x

@kernel
def f(a: u8[:], h: i16[:], c: u16[:], w: i32[:], x: i32, y: i32, z: i32, u: u32) -> i32:
"""


def routine_of(kernel: Kernel) -> Routine:
    """Return the plain IR of a kernel, without its callees."""
    found = read_module(optimised(kernel.function, GCC_O0))
    return next(each for each in found if each.symbol == kernel.function.symbol)


def costs_of(import_kernels: ImportText, body: str) -> dict[str, BlockCost]:
    """Lower a kernel of several parameters with this body; it returns 0."""
    lines = [f"    {line}\n" for line in [*body.splitlines(), "return 0"]]
    return lower(routine_of(import_kernels(HEAD + "".join(lines)).f), GCC_O0)


def cclk_of(charges: list[Charge] | tuple[Charge, ...]) -> int:
    """Sum up charges."""
    return sum(each.times * each.issue_cclk for each in charges)


STATEMENTS = {
    "x = y + z": "R1 = [FP]; R0 = [FP]; R0 = R1 + R0; [FP] = R0",
    "x = x + y + z": "R1 = [FP]; R0 = [FP]; R0 = R1 + R0; P2 = R0; R0 = [FP]; R1 = P2; R0 = R0 + R1; [FP] = R0",
    "z = (y - 1) * x": "R0 = [FP]; R0 += -1; R1 = [FP]; R0 *= R1; [FP] = R0",
    "z = h[x]": "R0 = [FP]; R0 <<= 1; R1 = [FP]; R1 = R1 + R0; P2 = R1; R0 = W [P2] (X); R0 = R0.L (X); [FP] = R0",
    "a[x] = y": "R0 = [FP]; R1 = [FP]; R1 = R1 + R0; P2 = R1; R0 = [FP]; B [P2] = R0",
    "z = a[x + 2]": "R0 = [FP]; P2 = R0; P2 += 2; R0 = [FP]; P1 = R0; P2 = P1 + P2; R0 = B [P2] (X); "
    "R0 = R0.B (Z); [FP] = R0",
    "z = w[x - 1]": "R0 = [FP]; P2.H = 16383; P2.L = 65535; R1 = P2; R0 = R0 + R1; R0 <<= 2; R1 = [FP]; "
    "R1 = R1 + R0; P2 = R1; R0 = [P2]; [FP] = R0",
    "z = c[x]\nc[x] = c[x] + 1": "R0 = [FP]; R0 <<= 1; R1 = [FP]; R1 = R1 + R0; P2 = R1; R0 = W [P2] (X); "
    "R0 = R0.L (Z); [FP] = R0; "
    "R0 = [FP]; R0 <<= 1; R1 = [FP]; R1 = R1 + R0; P2 = R1; R0 = W [P2] (X); "
    "R1 = [FP]; R1 <<= 1; R2 = [FP]; R2 = R2 + R1; P2 = R2; R0 += 1; W [P2] = R0",
    "h[x] = y - z": "R0 = [FP]; R1 = R0; R0 = [FP]; R0 = R1 - R0; R2 = R0; R0 = [FP]; R0 <<= 1; R1 = [FP]; "
    "R1 = R1 + R0; P2 = R1; R0 = R2; W [P2] = R0",
    "x = x * 10": "R1 = [FP]; R0 = R1; R0 <<= 2; R0 = R0 + R1; R0 <<= 1; [FP] = R0",
    "x = x * 171": "R1 = [FP]; R0 = 171 (X); R0 *= R1; [FP] = R0",
    "x = 100000": "R0 = 3125 (X); R0 <<= 5; [FP] = R0",
    "x = min(y, z)": "R1 = [FP]; R0 = [FP]; R0 = min(R1, R0); [FP] = R0",
    "x = y if y < z else z": "R1 = [FP]; R0 = [FP]; R0 = min(R1, R0); [FP] = R0",
    "u = u // 10": "R1 = [FP]; R0.H = 52428; R0.L = 52429; A1 = R1.L * R0.L; A1 = A1 >> 16; "
    "A0 = R1.H * R0.H, A1 += R1.H * R0.L; A1 += R0.H * R1.L; A1 = A1 >> 16; A0 += A1; R0 = A0; R0 >>= 3; [FP] = R0",
}
CLASSES = {
    r"^\[": "store32", r"^W \[": "store16", r"^B \[": "store8", r"= \[": "load32", r"= W \[": "load16", r"= B \[": "load8",
    r"A[01]": "mac", r"min|max": "dsp_alu", r"\*=": "mul32", r"<<=|>>=": "shift", r"\.[LB] \([XZ]\)": "extend",
    r"^\w\d(\.[HL])? = \d": "imm", r"^[RP]\d = [RP]\d$": "move", r"": "alu",
}  # fmt: skip


def classes_of(assembly: str) -> list[str]:
    """Classes of the operations of an assembler text."""
    return [
        next(name for pattern, name in CLASSES.items() if re.search(pattern, each))
        for each in assembly.split("; ")
    ]


def test_a_sum_of_constants_is_stored_in_bytes(import_kernels: ImportText) -> None:
    """It costs no less than one of them, on its own or as a part of what is stored."""
    (one, both, part) = (
        sum(cclk_of(each.charges) for each in costs_of(import_kernels, f"a[0] = {value}").values())
        for value in ("i32(255)", "i32(255) + i32(0)", "y + (i32(255) + i32(0))")
    )
    assert one <= both <= part


@pytest.mark.parametrize("statement", STATEMENTS)
def test_a_statement_costs_the_operations_that_gcc_writes(import_kernels: ImportText, statement: str) -> None:
    """Loads of variables, moves between register files, narrow arithmetic, and constants are GCC's."""
    costs = costs_of(import_kernels, statement)
    charges = [each for label in costs for each in costs[label].charges][len(ENTRY) : -len(EXIT)]
    assert sorted(each.op.value for each in charges) == sorted(classes_of(STATEMENTS[statement]))


def test_entry_and_exit_cost_the_frame(import_kernels: ImportText) -> None:
    """LINK, three stores of register arguments (the others are on the stack already), R0 = 0, UNLINK, RTS."""
    charges = costs_of(import_kernels, "x = y")["entry"].charges
    ops = [each.op for each in charges]
    assert (ops[: len(ENTRY)], ops[-len(EXIT) :]) == (ENTRY, EXIT)


def test_a_division_is_a_call_of_the_library_without_rounding_down(import_kernels: ImportText) -> None:
    """R1 = [z]; R0 = [y]; CALL ___divsi3; [x] = R0."""
    plain = cclk_of(costs_of(import_kernels, "x = y")["entry"].charges)
    divided = cclk_of(costs_of(import_kernels, "x = y // z")["entry"].charges)
    assert divided - plain == 1 + CALL_CCLK + DIVISION_CCLK


@pytest.mark.parametrize(
    ("statement", "cclk"),
    [
        ("x = quotient(y, 2)", 3),  # R1 = R0 >> 31; R0 = R1 + R0; R0 >>>= 1
        ("x = quotient(y, 8)", 1 + TAKEN_CCLK + 1),  # CC = R0 < 0; IF !CC JUMP over; R0 >>>= 3
        (
            "x = remainder(y, 8)",
            4 + TAKEN_CCLK,
        ),  # R0 = 7; BITSET (R0, 31); R0 = R1 & R0; CC = R0 < 0; IF !CC JUMP over
        ("x = quotient(y, 10)", 1 + CALL_CCLK + DIVISION_CCLK),  # R1 = 10; CALL ___divsi3
    ],
)
def test_dividing_towards_zero_by_a_power_of_two_is_no_call(
    import_kernels: ImportText, statement: str, cclk: int
) -> None:
    """The branch skips what mends a negative dividend."""
    plain = cclk_of(costs_of(import_kernels, "x = y")["entry"].charges)
    assert cclk_of(costs_of(import_kernels, statement)["entry"].charges) - plain == cclk


def test_an_if_branches_round_its_body_without_prediction(import_kernels: ImportText) -> None:
    """R0 = [x]; CC = R0 <= 3; IF CC JUMP else; ...; JUMP after."""
    costs = costs_of(import_kernels, "if x > 3:\n    y = 1\nelse:\n    y = 2")
    (test,) = costs["entry"].tests
    assert costs["entry"].charges[-1].issue_cclk == TAKEN_CCLK
    assert cclk_of(test.charges) == NOT_TAKEN_CCLK - TAKEN_CCLK
    assert [each.op for each in costs["then"].charges] == [Op.IMM, Op.STORE32, Op.JUMP]
    assert [each.op for each in costs["else"].charges] == [Op.IMM, Op.STORE32]


def test_a_loop_is_tested_at_the_bottom_with_its_bound_computed_again(import_kernels: ImportText) -> None:
    """JUMP test; body; i += 1; test: R0 = [x]; R0 += -1; R1 = [i]; CC = R1 < R0; IF CC JUMP body."""
    costs = costs_of(import_kernels, "for i in range(x - 1):\n    y = i")
    assert costs["entry"].charges[-1].op is Op.JUMP
    assert [each.op.value for each in costs["body"].charges] == ["load32", "store32"]
    assert [each.op.value for each in costs["step"].charges] == ["load32", "alu", "store32"]
    header = [each.op.value for each in costs["for"].charges]
    assert sorted(header) == ["alu", "branch_not_taken", "compare", "load32", "load32"]
    assert cclk_of(costs["for"].tests[0].charges) == TAKEN_CCLK - NOT_TAKEN_CCLK


def test_each_side_of_an_and_jumps_to_where_the_whole_leads(import_kernels: ImportText) -> None:
    """The first false side jumps past the body; no truth value is stored."""
    costs = costs_of(import_kernels, "if x > 0 and y > 0:\n    z = 1")
    for label in ("entry", "and"):
        assert costs[label].charges[-1].op is Op.BRANCH_TAKEN
        assert [each.op.value for each in costs[label].charges[-3:]] == ["load32", "compare", "branch_taken"]
    assert not costs["decided"].charges


def test_a_lone_break_lands_on_a_nop_that_the_end_of_the_loop_jumps_over(import_kernels: ImportText) -> None:
    """IF CC JUMP .L8; ...; IF !CC JUMP body; JUMP after; .L8: NOP; after."""
    costs = costs_of(import_kernels, "while x > 0:\n    if x == y:\n        break\n    x = x - 1\nz = 1")
    assert cclk_of(costs["body"].tests[0].charges) == TAKEN_CCLK - NOT_TAKEN_CCLK
    assert cclk_of(costs["then"].charges) == 1
    assert [each.op for each in costs["test"].charges[-2:]] == [Op.BRANCH_NOT_TAKEN, Op.JUMP]


def test_a_value_that_waits_for_a_call_is_saved_by_the_function(import_kernels: ImportText) -> None:
    """[--SP] = (P5:5) costs what the profile says: 14 cycles, or one per register."""
    kernel = import_kernels(HEAD + "    return callee(x) + callee(y)\n").f
    assert cclk_of(lower(routine_of(kernel), GCC_O0)["entry"].charges[:1]) == GCC_O0.push_multiple_cclk
    by_register = replace(GCC_O0, push_multiple_cclk=None, pop_multiple_cclk=None)
    assert cclk_of(lower(routine_of(kernel), by_register)["entry"].charges[:1]) == 1


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=programs())
def test_every_block_of_any_program_has_a_cost(import_kernels: ImportText, text: str) -> None:
    """No program is refused, no block is free to be forgotten, and no side of a branch costs less than nothing."""
    kernel = import_kernels(text).program
    routine = routine_of(kernel)
    costs = lower(routine, GCC_O0)
    assert set(costs) == {block.label for block in routine.blocks}
    for each in costs.values():
        assert each.nbytes >= 0
        assert cclk_of(each.charges) + min(0, *(cclk_of(test.charges) for test in each.tests), 0) >= 0
