"""Kernels from C, assembler and object code: what they compute, count and cost, and what is no kernel. `blackfin/data/make` makes files."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from bfsim.api import Kernel, i32, kernel_from, u8
from bfsim.blackfin.control_flow import pointers
from bfsim.blackfin.elf import lines
from bfsim.blackfin.translation import room
from bfsim.errors import KernelError
from bfsim.explain import explain
from bfsim.kernel import GCC_O2
from bfsim.kernel.costs.run_tables import tables_of
from bfsim.kernel.objects import compiled
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.loading.kernel_named import load_kernel
from tests.sums import DATA, ROW, SUMS, expected_sums, sums


def test_object_code_computes_on_arrays() -> None:
    """Five arguments, two of them on the stack; a static function of the file is called; the result comes back."""
    out = np.zeros(len(ROW), np.int32)
    assert sums()(ROW, out, len(ROW), 2) == expected_sums(ROW).sum()
    assert (out == expected_sums(ROW)).all()


def test_functions_of_a_file_share_its_static_variables(tmp_path: Path) -> None:
    """They keep them from call to call, and another file of the same contents has its own."""
    shutil.copy(DATA / "keeping.o", tmp_path)

    def both(folder: Path) -> tuple[Kernel, Kernel]:
        file = folder / "keeping.o"
        return kernel_from(file, "begin", value=i32), kernel_from(file, "add", value=i32, result=i32)

    (begin, add), (_, add_elsewhere) = both(DATA), both(tmp_path)
    begin(5)
    assert [add(1), add(2)] == [6, 8]
    assert add_elsewhere(1) == 101
    (_, add_again) = both(DATA)  # as by another test
    assert [add_again(1), add(1)] == [101, 9]


def test_the_cycle_counter_counts_in_every_call() -> None:
    """A program's start has switched it on; code that measured itself found 0. CYCLES is read once and LSETUP issued, then the turns."""
    clocked = kernel_from(DATA / "clocked.o", "clocked", turns=i32, result=i32)
    assert [clocked(turns) for turns in (10, 100, 10)] == [2 * turns + 2 for turns in (10, 100, 10)]


def test_large_arrays_have_a_place() -> None:
    """3 MB: they lay over the code, and the file was refused."""
    store = kernel_from(DATA / "large.o", "store", place=i32, value=i32, result=i32)
    assert [store(place, 200) for place in ((3 << 20) - 2, (3 << 20) - 1)] == [200, 400]


def test_variables_without_a_value_have_a_place() -> None:
    """They were told as missing."""
    put = kernel_from(DATA / "common.o", "put", value=i32, result=i32)
    assert [put(7), put(8)] == [107, 208]


def test_the_counters_add_up_to_the_cycles_of_a_call() -> None:
    """Each counter's events times its cycles; calls of both functions; the lines are those of `sums.c`."""
    kernel = sums()
    code = kernel.compile(GCC_O2)
    totals = code.new_totals()
    work = kernel.prepare(code, [ROW, np.zeros(32, np.int32)], totals).run(ROW, None, 32, 2)
    pairs = list(zip(totals[: -room.SUMS].tolist(), code.counters, strict=True))
    assert sum(events * each.issue_cclk for events, each in pairs) == work.issue_cclk
    calls = {one.symbol: events for events, each in pairs for one in each.enters}
    assert calls == {"sums_o_sums": 1, "_weighted": 27}
    source = (DATA / "sums.c").read_text().splitlines()
    for each in code.functions:
        text = each.source.splitlines()
        assert text == source[each.first_line - 1 : each.first_line - 1 + len(text)]
        lines = {
            line.line for one in code.counters for line, _, _ in one.line_cclk if line.routine == each.symbol
        }
        assert lines <= set(range(1, len(text) + 1))


def test_a_kernel_without_lines_is_shown_by_its_instructions() -> None:
    """`reaching.o` has no debugging information: its source is what objdump prints."""
    kernel = kernel_from(DATA / "reaching.o", "near")
    assert kernel.function.source.split("\n") == ["ffa0001a  NOP", "ffa0001c  RTS"]
    assert kernel.cost() == 6


def test_code_without_a_name_is_refused() -> None:
    """With the functions that there are."""
    with pytest.raises(KernelError, match="sums.o must define _nothing, but has only _weighted, _sums"):
        kernel_from(DATA / "sums.o", "nothing")


@pytest.mark.parametrize(
    ("file", "what", "why"),
    [
        ("sums.txt", {}, r"must come from a file .c, .s, .S, .o, .elf, .doj, .dxe, not from sums.txt"),
        (
            "lib.a",
            {},
            r"not from lib.a; bfin-elf-gcc -r .* -Wl,--whole-archive lib.a .* makes an object file of it",
        ),
        ("nowhere.o", {}, r"nowhere.o must be a file that can be read \(No such file or directory\)"),
        ("sums.o", {"row": "u8"}, r"row of sums must have a type such as i32 or u8\[:\], not 'u8'"),
        ("sums.o", {"row": int}, r"row of sums must have a type such as i32 or u8\[:\], not int$"),
        ("sums.o", {"result": u8[:]}, r"the result of sums must have a type such as i32, not u8\[:\]$"),
        ("undefined.o", {}, r"at 0x[0-9A-F]+ of .text R9, which is nowhere defined, is out of reach"),
        ("traps.o", {}, r"traps.o must define _sums, but has only _trap, _idle"),
    ],
)
def test_what_is_no_kernel_is_refused(file: str, what: dict, why: str) -> None:
    """Other files, files that are not there, types that are none."""
    with pytest.raises(KernelError, match=why):
        kernel_from(DATA / file, "sums", **what)


def test_data_is_no_kernel() -> None:
    """Nor is what the assembler of GNU takes for notes, as by VisualDSP++'s `.section program`: it was no instruction at 0."""
    with pytest.raises(
        KernelError, match=r"table of returning.o must be code, but is none: code is in .text"
    ):
        kernel_from(DATA / "returning.o", "table")


def test_a_file_has_a_path() -> None:
    """Anything else was told as what Python cannot divide."""
    with pytest.raises(KernelError, match="the file of sums must be a path, not None"):
        kernel_from(None, "sums")  # type: ignore[arg-type]


def test_a_kernel_in_python_cannot_call_it(tmp_path: Path) -> None:
    """Its code is its own: the call is refused when the kernel is read. It was taken for Python, with a traceback in a run."""
    (tmp_path / "fw_calls.py").write_text(
        f"""from bfsim.api import i32, kernel, u8
{SUMS}

@kernel
def calls(row: u8[:], out: i32[:]) -> i32:
    return sums(row, out, len(row), 2)
"""
    )
    with pytest.raises(
        KernelError,
        match="a kernel cannot call sums, which is not written in Python; call it from the main loop",
    ):
        load_kernel("fw_calls:calls", f"{tmp_path}/fw_calls.py:firmware")


def test_a_kernel_is_found_by_the_name_that_a_profile_has(tmp_path: Path) -> None:
    """By that of the function, too, where Python calls it otherwise: "sums must name one kernel, but names none; the nearest is sums"."""
    text = SUMS.replace("sums =", "windows =")
    (tmp_path / "fw_windows.py").write_text(f"from bfsim.api import u8\n{text}")
    for name in ("windows", "sums"):
        assert load_kernel(f"{tmp_path}/fw_windows.py:{name}", "tinyphoon").name == "sums"


def test_explain_shows_the_lines_of_c() -> None:
    """Each line with its operations; the text is the file's."""
    shown = explain(sums(), GCC_O2)
    assert shown.kernel == "sums"
    assert shown.file.endswith("sums.c")
    assert shown.lines[0].text.startswith("int32_t sums(")
    assert {each.line for each in shown.lines if each.operations} >= {17, 18, 21}


def forget() -> None:
    """Forget what another process does not have."""
    compiled._COUNTED.clear()
    compiled._PROGRAMS.clear()


def test_a_run_has_the_tables_of_the_costs_and_not_these(monkeypatch: pytest.MonkeyPatch) -> None:
    """Found in the cache they are those of the program, which is read when somebody asks for it."""

    def code() -> CompiledObject:
        found = sums().object_code
        assert found
        return found.compiled(GCC_O2, traced=True)

    code()
    forget()
    with monkeypatch.context() as without:
        without.setattr(compiled, "kept_costs", None)
        found = code()
        assert len(room.new_counts(found.tables.counters)) == len(found.new_totals())
    made = tables_of(found.program)
    assert found.tables == made
    assert all(map(np.array_equal, found.tables.costs, made.costs))
    assert found.tables.accesses == found.program.accesses


def lines_of_costs(folder: Path) -> set[int]:
    """The lines that `sums` in a folder has cycles for, as a process finds that has just started."""
    forget()
    found = explain(sums(folder), GCC_O2)
    return {each.line for each in found.lines if each.operations}


def test_what_object_code_costs_is_worked_out_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another start finds it in the cache, and works it out anew once a source file is another one."""
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))
    for name in ("sums.o", "sums.c"):
        shutil.copy(DATA / name, tmp_path)
    before = lines_of_costs(tmp_path)
    with monkeypatch.context() as without:
        without.setattr(lines, "lines_of", None)
        without.setattr(pointers, "arrays_accessed", None)
        assert lines_of_costs(tmp_path) == before
    (tmp_path / "sums.c").unlink()  # now its instructions are its lines
    assert lines_of_costs(tmp_path) != before
