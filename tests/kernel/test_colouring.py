"""Registers as GCC's allocator gives them: C beside what `bfin-elf-gcc -O2` makes of it."""

from __future__ import annotations

from collections import Counter as Tally
from dataclasses import replace
from pathlib import Path

from bfsim.kernel import GCC_O2, VDSP_O2
from bfsim.kernel.isa import LONG_FORM_BYTES, Op
from bfsim.kernel.lowering.colouring import REGISTERS, SAVED
from bfsim.kernel.lowering.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.lowering.schedule import issues
from bfsim.kernel.lowering.shared_indices import continued, row_of
from bfsim.kernel.rules import Rule
from tests.kernel.test_lowering import context, lowered

DATA, POINTER = RegisterBank.DATA, RegisterBank.POINTER
IN_A_ROW = """
def f(picture: u8[:], xs: i32[:], ys: i32[:], w: i32, n: i32) -> i32:
    total = 0
    for i in range(n):
        total += picture[ys[i] * w + xs[i]]
    return total
"""
THREE_TABLES = """
def f(order: u16[:], a: i16[:], b: i16[:], c: i16[:], n: i32) -> i32:
    total = 0
    for i in range(n):
        k = order[i]
        total += a[k] ^ b[k] ^ c[k]
    return total
"""
FIVE_SUMS = """
def f(a: i16[:], b: i16[:], n: i32) -> i32:
    s = 0
    t = 0
    u = 0
    v = 0
    w = 0
    for i in range(n):
        x = a[i]
        y = b[i]
        z = x - y
        s += x * x
        t += x * y
        u += y * y
        v += x * z * y
        w += y * z * x
    return s ^ t ^ u ^ v ^ w
"""


def operations(text: str, folder: Path, *without: Rule) -> Tally[Op]:
    """Count the operations of a kernel `f`, once each."""
    return lowered(text.strip() + "\n", folder, replace(GCC_O2, without=without))


def test_registers_are_those_of_the_blackfin() -> None:
    """Eight for data, eight but SP for addresses, and twelve in which nothing is computed; half of the first two are saved."""
    assert Tally(REGISTERS.values()) == {
        DATA: 8,
        POINTER: 7,
        RegisterBank.INDEX: 4,
        RegisterBank.MODIFY: 4,
        RegisterBank.BASE: 4,
    }
    assert Tally(REGISTERS[each] for each in SAVED) == {DATA: 4, POINTER: 4}


def test_what_does_not_fit_goes_to_other_registers_before_the_stack(tmp_path: Path) -> None:
    """GCC keeps values in I, M and B registers, a move away: the loop has no load of a word."""
    found = operations(FIVE_SUMS, tmp_path)
    assert found[Op.LOAD32] + found[Op.STORE32] <= 1  # the argument


def test_the_place_in_a_row_is_added_up_before_the_address(tmp_path: Path) -> None:
    """`R0 = R1 + R2; P2 = R0; P2 = P5 + P2`: the address of the row, which LLVM computes first, is none of its own."""
    found = context(IN_A_ROW, tmp_path)
    addresses = [
        each
        for block in found.flow.routine.blocks
        for each in block.instructions
        if each.opcode == "getelementptr"
    ]
    rows = [row for each in addresses if (row := row_of(found, each)) is not None]
    assert len(rows) == 1
    assert continued(found, rows[0]) in addresses


def test_an_index_of_several_addresses_is_scaled_once(tmp_path: Path) -> None:
    """`P2 = P1 + P1`, then three additions; alone, an address takes one instruction that shifts and adds."""
    found, apart = (operations(THREE_TABLES, tmp_path, *without) for without in ((), (Rule.SCALED_INDICES,)))
    assert (found[Op.ADD_SHIFT], apart[Op.ADD_SHIFT]) == (0, 3)
    assert found[Op.ALU] - apart[Op.ALU] == 3


def test_a_minimum_takes_the_next_load_along() -> None:
    """`R0 = min(R0,R1) || R1 = W [P2] || nop`: what it reads may be written in the same cycle, but no access of 32 bits goes along."""
    banks, registers = {"p": POINTER}, {"a": "R0", "b": "R1", "low": "R0", "c": "R1", "p": "P2"}
    least = MachineInstruction(Op.DSP_ALU, 1, "low", DATA, (("a", DATA), ("b", DATA)))
    load = MachineInstruction(Op.LOAD16, 2, "c", DATA, (("p", POINTER),))

    def paired(*code: MachineInstruction) -> list[bool]:
        found = issues(code, banks.get, parallel=True, register_of=registers.get)
        return [each.paired for each in found]

    assert paired(least, load) == [False, True]
    assert paired(least, replace(load, nbytes=LONG_FORM_BYTES)) == [False, False]
    assert paired(load, replace(least, uses=(("a", DATA), ("c", DATA)))) == [False, False]


def test_another_compiler_need_not_do_so() -> None:
    """`vdsp-O2` is costed without what follows from GCC's allocator alone."""
    assert not any(
        VDSP_O2.applies(each)
        for each in (Rule.COLOURING, Rule.BUNDLES, Rule.ROW_INDICES, Rule.SCALED_INDICES)
    )
