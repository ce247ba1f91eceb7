"""Object code that goes where no call or loop of a compiler goes: to addresses, labels, and from one function into the next."""

from __future__ import annotations

import numpy as np
import pytest

from bfsim.api import i32, kernel_from, u8
from bfsim.blackfin.elf.linking import link
from bfsim.blackfin.elf.objects import read_object
from bfsim.blackfin.execution.subroutines import LoadedImage
from bfsim.kernel import GCC_O2
from tests.sums import DATA, ROW


@pytest.mark.parametrize("file", ["callbacks.o", "callbacks.elf"])
def test_functions_are_called_by_their_addresses(file: str) -> None:
    """Those of a table, and those that are handed over; what they access is known, too."""
    which, values = np.array([0, 1, 0], np.int32), np.array([3, 5, 7], np.int32)
    from_table = kernel_from(DATA / file, "from_table", which=i32[:], values=i32[:], n=i32, result=i32)
    assert from_table(which, values, 3) == 1 + 3 - 5 + 7
    handed_over = kernel_from(DATA / file, "handed_over", values=i32[:], n=i32, result=i32)
    assert handed_over(values, 3) == (1 + 3 + 5 + 7) - 3 * 5 * 7
    assert {each.name for each in handed_over.compile(GCC_O2).functions} >= {"add", "multiply"}
    program = from_table.compile(GCC_O2, traced=True).program
    accessed = {
        (program.sites[each.site].line.routine, program.sites[each.site].array) for each in program.accesses
    }
    assert accessed >= {("_add", "values"), ("_subtract", "values")}


def test_a_hardware_loop_may_be_set_up_without_lsetup() -> None:
    """Code that wrote LB, LT and LC itself ran once through such a loop, without a word. Cycles: of the GNU simulator."""
    kernel = kernel_from(DATA / "labels.o", "turns", x=i32, result=i32)
    assert [kernel(each) for each in (1, 2, 5, 13)] == [4, 10, 40, 208]
    assert [kernel.cost(each, profile="gcc") for each in (1, 2, 5, 13)] == [16, 18, 24, 40]


def test_a_label_is_called_by_its_address() -> None:
    """Assembler need not say what is a function: such a call was refused, for nothing named the address."""
    kernel = kernel_from(DATA / "labels.o", "twice", x=i32, result=i32)
    assert kernel(21) == 42
    assert kernel.cost(21, profile="gcc") == 20


@pytest.mark.parametrize("file", ["labels.o", "labels.elf"])
def test_a_table_of_labels_may_stand_in_code(file: str) -> None:
    """A linked program has no relocations any more that say so: its jumps were refused."""
    kernel = kernel_from(DATA / file, "chosen", x=i32, result=i32)
    assert [kernel(each) for each in range(3)] == [10, 20, 30]


def test_a_function_may_go_on_in_the_next_one() -> None:
    """The block that both are in is of the first, its lines are of both; accesses are reported with their lines."""
    kernel = kernel_from(DATA / "falling.o", "before", row=u8[:], result=i32)
    assert kernel(ROW) == ROW[0]
    code = kernel.compile(GCC_O2, traced=True)
    assert code.subroutine.translated.entry
    assert {each.line.routine for each in code.program.sites} == {"_first"}


def test_code_behind_an_exception_is_another_function_s() -> None:
    """Nobody comes back from one to a function that is called."""
    image = LoadedImage(link(read_object((DATA / "falling.o").read_bytes(), "falling.o")))
    assert list(image.explored(image.image.symbols["_trap"]).blocks) == [image.image.symbols["_trap"]]
