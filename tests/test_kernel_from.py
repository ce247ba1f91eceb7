"""Kernels from C, assembler and object code: what they compute, count and cost, and what is refused. `blackfin/data/make` makes files."""

from __future__ import annotations

import shutil
import subprocess
from mmap import mmap
from pathlib import Path

import numpy as np
import pytest

from bfsim.api import Kernel, f32, i32, kernel_from, u8
from bfsim.blackfin import lines, pointers
from bfsim.blackfin.address_space import AddressSpace
from bfsim.blackfin.linking import link
from bfsim.blackfin.objects import read_object
from bfsim.blackfin.subroutines import ARRAYS, LoadedImage, placed
from bfsim.chip.boards import CM_BF561
from bfsim.compiling import file_code
from bfsim.errors import ConfigError, KernelError
from bfsim.explain import explain
from bfsim.kernel import GCC_O2
from bfsim.kernel.objects import compiled
from bfsim.kernel.objects.sources import file_lines
from bfsim.loading import load_kernel
from bfsim.machine.memories import Memories
from tests.sums import DATA, SUMS, sums

ROW = np.arange(0, 96, 3, dtype=np.uint8)


def expected(row: np.ndarray) -> np.ndarray:
    """What it leaves in `out` from the element 2 on."""
    weights = (1, -2, 3, -4)
    return np.array(
        [
            sum(weights[(x + k) % 4] * int(row[x + k]) for k in range(4)) if 2 <= x <= len(row) - 4 else 0
            for x in range(len(row))
        ]
    )


def test_object_code_computes_on_arrays() -> None:
    """Five arguments, two of them on the stack; a static function of the file is called; the result comes back."""
    out = np.zeros(len(ROW), np.int32)
    assert sums()(ROW, out, len(ROW), 2) == expected(ROW).sum()
    assert (out == expected(ROW)).all()


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
    assert (out == expected(ROW)).all()
    space = code.subroutine.processor.space
    assert (space.at(space.window(memory) + 4096, len(ROW)) == ROW).all()


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


def test_variables_without_a_value_have_a_place() -> None:
    """They were told as missing."""
    put = kernel_from(DATA / "common.o", "put", value=i32, result=i32)
    assert [put(7), put(8)] == [107, 208]


def test_integers_of_any_kind_are_handed_over() -> None:
    """Those of numpy, and -1, which the C interface of Python returns for a mistake, too."""
    out = np.zeros(len(ROW), np.int32)
    assert sums()(ROW, out, np.int16(len(ROW)), np.uint8(2)) == expected(ROW).sum()
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
    assert call.run(ROW, out, len(ROW), 2).value == expected(ROW).sum()


def test_a_float_is_handed_over_as_the_bits_of_a_single() -> None:
    """What no single can hold is refused."""
    kernel = kernel_from(DATA / "sums.o", "sums", row=u8[:], out=i32[:], n=f32, first=i32, result=i32)
    out = np.zeros(len(ROW), np.int32)
    assert (
        kernel(ROW, out, len(ROW) * 2.0**-149, 2) == expected(ROW).sum()
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


def test_the_counters_add_up_to_the_cycles_of_a_call() -> None:
    """Each counter's events times its cycles; calls of both functions; the lines are those of `sums.c`."""
    kernel = sums()
    code = kernel.compile(GCC_O2)
    totals = code.new_totals()
    work = kernel.prepare(code, [ROW, np.zeros(32, np.int32)], totals).run(ROW, None, 32, 2)
    pairs = list(zip(totals.tolist(), code.counters, strict=True))
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


def test_a_file_has_a_path() -> None:
    """Anything else was told as what Python cannot divide."""
    with pytest.raises(KernelError, match="the file of sums must be a path, not None"):
        kernel_from(None, "sums")  # type: ignore[arg-type]


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
    np.testing.assert_array_equal(out, expected(ROW))
    out[:] = 0
    out.flags.writeable = False
    with pytest.raises(
        KernelError, match=r"out must be writeable, because the kernel stores into it \(out of sums"
    ):
        kernel(row, out, 32, 2)
    with pytest.raises(KernelError, match="out must be writeable"):
        kernel.cost(row, out, 32, 2)
    assert not out.any()


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


def test_a_source_needs_a_compiler_or_kept_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What would be compiled by what, and how one gets it."""
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(file_code, "blackfin_compiler", lambda: None)
    (tmp_path / "sums.c").write_text("int sums(void) { return 1; }")
    with pytest.raises(
        ConfigError,
        match="bfin-elf-gcc must be on the PATH to compile sums.c, of which no code of GCC 12.2.0 is kept",
    ):
        sums(tmp_path, "sums.c")


def test_what_is_missing_is_told_when_the_code_comes_to_it() -> None:
    """Under its name in C; an object file that another build links must have all."""
    kernel = kernel_from(DATA / "missing.o", "missing", a=i32, result=i32)
    with pytest.raises(
        KernelError,
        match=r"but it comes to __divsi3, which missing.o does not define and missing calls at \S+; define it there, or give one",
    ):
        kernel(3)


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_parts_of_a_file_that_do_not_run_need_nothing(tmp_path: Path) -> None:
    """As functions of a library that want a heap, an assert that holds, and what another file has."""
    (tmp_path / "library.c").write_text(
        """
        #include <assert.h>
        #include <stdlib.h>
        extern int elsewhere(int), table[];
        void *fresh(int n) { return malloc(n); }
        int twice(int n) { assert(n < 100); return 2 * n; }
        int reads(int n) { return table[n]; }
        int calls(int n) { return elsewhere(n) + 1; }
        int points(int n) { int (*volatile f)(int) = elsewhere; return f(n) + 1; }
        """
    )
    kernels = {
        name: kernel_from(tmp_path / "library.c", name, n=i32, result=i32)
        for name in ("twice", "reads", "calls", "points", "fresh")
    }
    assert kernels["twice"](21) == 42
    for name, missing, user in (
        ("reads", "table", "reads uses at library.c:7"),
        ("calls", "elsewhere", "calls calls at library.c:8"),
        ("points", "elsewhere", "points calls at library.c:9"),
        ("fresh", "_sbrk", ".*, which fresh calls at library.c:5"),
    ):
        told = f"it comes to {missing}, which library.c does not define and {user}; "
        with pytest.raises(KernelError, match=told):
            kernels[name](1)


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_what_c_s_library_asks_an_operating_system_for_is_told_so(tmp_path: Path) -> None:
    """To link it with what has it was the advice, which is nowhere; the C that calls it was not named."""
    (tmp_path / "ends.c").write_text(
        "#include <stdlib.h>\nint ends(int n)\n{\n    if (n < 0)\n        exit(1);\n    return n;\n}\n"
    )
    kernel = kernel_from(tmp_path / "ends.c", "ends", n=i32, result=i32)
    assert kernel(3) == 3
    with pytest.raises(KernelError) as told:
        kernel(-1)
    assert "it comes to _exit, which ends.c does not define" in str(told.value)
    assert "which ends calls at ends.c:5" in str(told.value)
    assert "a kernel has none: do without what leads there, or define _exit in ends.c" in str(told.value)
    (tmp_path / "ends.c").write_text((tmp_path / "ends.c").read_text() + "void _exit(int n) { for (;;); }\n")
    assert kernel_from(tmp_path / "ends.c", "ends", n=i32, result=i32)(3) == 3


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_a_register_in_memory_is_no_missing_function(tmp_path: Path) -> None:
    """What a file does not define stood for addresses of the first of them: of the PLL."""
    (tmp_path / "pll.c").write_text(
        "extern int other(int);\nint pll(int at)\n{\n    return *(volatile short *)at;\n}\nint uses(int n) { return other(n); }\n"
    )
    kernel = kernel_from(tmp_path / "pll.c", "pll", at=i32, result=i32)
    for at in (0xFFC00000, 0xFFC00014, 0xFFE02000):
        with pytest.raises(
            KernelError, match=rf"\(pll.c:4\) it accesses 0x{at:08X}, a register of the Blackfin"
        ):
            kernel(at - 2**32)


WILD = """
#include <string.h>
static int sum(const int *words, int n)
{
    int total = 0;
    while (n-- > 0)
        total += *words++;
    return total;
}
__attribute__((noinline)) static void put(int *words, int n)
{
    words[n] = n;
}
int reads(int *words, int n) { return sum(words, n) ^ n; }
int stores(int *words, int n) { put(words, n); return words[0]; }
int copies(int *words, int n)
{
    memcpy(words, words + n, n);
    return words[0];
}
int jumps(int *words, int n)
{
    int (*there)(int) = (int (*)(int))words[0];
    return there(n) + 1;
}
int clears(int *words, int n)
{
    for (int k = 0; k < n; k++)
        words[k] = 0;
    return n;
}
"""


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
@pytest.mark.parametrize("option", ["-O0", "-O1", "-O2", "-O3", "-Os"])
def test_the_line_of_a_wild_access_is_told(tmp_path: Path, option: str) -> None:
    """Registers are lost at a fault: only the address that was accessed was told. In a function of a library, who calls that."""
    (tmp_path / "wild.c").write_text(WILD)
    whole = f"-mcpu=bf561 {option} -g -r -nostdlib -o wild.o wild.c -lc -lgcc".split()
    subprocess.run(["bfin-elf-gcc", *whole], cwd=tmp_path, check=True)
    at = r"at 0xFFA[0-9A-F]{5} \(\S+\)"
    for name, n, what in (
        ("reads", 1 << 29, r"at .*\bwild.c:[67]\b.* it accesses 0x"),
        ("stores", 1 << 28, r"\(wild.c:12\) of put, which stores calls at wild.c:15, it accesses 0x60"),
        ("copies", 1 << 28, rf"{at} of memcpy, which copies calls at wild.c:18, it accesses 0x60"),
        ("clears", 1 << 29, r"at .*\bwild.c:29\b.* it accesses 0x24000000"),
        ("jumps", 0, r"\(wild.c:24\) it goes to 0x00000007, an address that"),
    ):
        kernel = kernel_from(tmp_path / "wild.o", name, words=i32[:], n=i32, result=i32)
        for _ in range(2):  # what the first one has left tells nothing of the second
            with pytest.raises(KernelError, match=what):
                kernel(np.full(4, 7, np.int32), n)


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_several_files_are_one_object_file(tmp_path: Path) -> None:
    """By the command of docs/how-to/c-and-assembler.md; what either lacks by itself is told with its line."""
    (tmp_path / "drive.c").write_text("int steered(int a)\n{\n    return a / 3;\n}\n")
    (tmp_path / "ball.c").write_text("int steered(int);\nint ball(int a)\n{\n    return steered(a) + 1;\n}\n")
    command = "bfin-elf-gcc -O2 -g -r -nostdlib -o robot.o drive.c ball.c -lm -lc -lgcc"
    subprocess.run(command.split(), cwd=tmp_path, check=True)
    kernel = kernel_from(tmp_path / "robot.o", "ball", a=i32, result=i32)
    assert kernel(42) == 42 // 3 + 1
    sources = {each.name: each.file for each in kernel.compile(GCC_O2).functions}
    assert sources.items() >= {"ball": f"{tmp_path}/ball.c", "steered": f"{tmp_path}/drive.c"}.items()
    alone = kernel_from(tmp_path / "ball.c", "ball", a=i32, result=i32)
    with pytest.raises(KernelError, match="steered, which ball.c does not define and ball calls at ball.c:4"):
        alone(42)


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_c_is_compiled_with_what_it_includes(tmp_path: Path) -> None:
    """A changed header is another code, a float comes back as one, and a library's function is shown beside the own ones."""
    (tmp_path / "half.c").write_text('#include "part.h"\nfloat half(float a) { return PART * a; }\n')
    for part in (0.5, 0.25):
        (tmp_path / "part.h").write_text(f"#define PART {part}f\n")
        kernel = kernel_from(tmp_path / "half.c", "half", a=f32, result=f32)
        assert kernel(6.0) == 6 * part
    assert {"half", "__mulsf3"} <= {each.name for each in kernel.compile(GCC_O2).functions}


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_what_is_included_may_be_in_other_folders(tmp_path: Path) -> None:
    """Above and below the file; its lines are shown, but not those of one of two files with one name."""
    for file, text in {
        "own/third.c": '#include "../all/deep/part.h"\n#include "part.h"\nint third(int a) { return deep(a) + part(a); }\n',
        "own/part.h": "static __attribute__((noinline)) int part(int a) { return a * a; }\n",
        "all/deep/part.h": '#include "../base.h"\nstatic int deep(int a) { return base(a) + 1; }\n',
        "all/base.h": "static __attribute__((noinline)) int base(int a) { return 3 * a; }\n",
    }.items():
        (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / file).write_text(text)
    kernel = kernel_from(tmp_path / "own/third.c", "third", a=i32, result=i32)
    assert kernel(4) == 3 * 4 + 1 + 4 * 4
    sources = {each.name: each.source for each in kernel.compile(GCC_O2).functions}
    assert "return 3 * a" in sources["base"]
    assert "a * a" not in sources["part"]
    assert "R0" in sources["part"]


INCLUDING = {
    "file.c": '#include "{there}/part.h"\nint part(int a) {{ return PART * a; }}\n',
    "marked.c": '\ufeff#include "part.h"\nint part(int a) {{ return PART * a; }}\n',
    "file.s": '.include "part.inc"\n.global _part\n.type _part, STT_FUNC\n_part:\n times_part;\nRTS;\n.size _part, .-_part\n',
}


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
@pytest.mark.parametrize("file", INCLUDING)
def test_what_is_included_is_a_part_of_the_code_however_it_is_named(file: str, tmp_path: Path) -> None:
    """By the name of a place, whose changes were not seen; behind a byte order mark, and by the assembler, which found nothing."""
    (tmp_path / file).write_text(INCLUDING[file].format(there=tmp_path), encoding="utf-8")
    for part, code in ((2, "R0 = R0 + R0"), (3, "R1 = R0 << 1; R0 = R0 + R1")):
        (tmp_path / "part.h").write_text(f"#define PART {part}\n")
        (tmp_path / "part.inc").write_text(f".macro times_part\n{code};\n.endm\n")
        assert kernel_from(tmp_path / file, "part", a=i32, result=i32)(7) == 7 * part
        assert (tmp_path / "part.h").read_text() == f"#define PART {part}\n"


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_a_compiler_sees_the_bytes_of_the_file(tmp_path: Path) -> None:
    """Old C is in Latin-1: a letter beyond ASCII had three bytes, and others than in the file."""
    text = 'static const unsigned char name[] = "\xfc";\nint letter(int a) { return 1000 * sizeof name + name[a]; }\n'
    (tmp_path / "old.c").write_bytes(text.encode("latin-1"))
    assert kernel_from(tmp_path / "old.c", "letter", a=i32, result=i32)(0) == 2000 + 0xFC


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


def test_explain_shows_the_lines_of_c() -> None:
    """Each line with its operations; the text is the file's."""
    shown = explain(sums(), GCC_O2)
    assert shown.kernel == "sums"
    assert shown.file.endswith("sums.c")
    assert shown.lines[0].text.startswith("int32_t sums(")
    assert {each.line for each in shown.lines if each.operations} >= {17, 18, 21}


def test_a_hardware_loop_may_be_set_up_without_lsetup() -> None:
    """Code that wrote LB, LT and LC itself ran once through such a loop, without a word. Cycles: of the GNU simulator."""
    kernel = kernel_from(DATA / "labels.o", "turns", x=i32, result=i32)
    assert [kernel(each) for each in (1, 2, 5, 13)] == [4, 10, 40, 208]
    assert [kernel.cost(each, profile="gcc") for each in (1, 2, 5, 13)] == [16, 18, 24, 40]


@pytest.mark.parametrize(
    ("name", "why"),
    [
        (
            "spoils",
            r"_spoils must run and return to its caller, but it changes R7, P5; R4 to R7, P3 to P5, FP and SP must be",
        ),
        (
            "leaves",
            r"_leaves must run and return to its caller, but it changes SP; R4 to R7, .*: push them first, and pop",
        ),
    ],
)
def test_registers_of_a_caller_are_kept(name: str, why: str) -> None:
    """A function that changes them returned without a word; on the robot its caller would go wrong. The next one runs."""
    kernel = kernel_from(DATA / "spoiling.o", name, x=i32, result=i32)
    for _ in range(2):
        with pytest.raises(KernelError, match=why):
            kernel(21)
    keeps = kernel_from(DATA / "spoiling.o", "keeps", x=i32, result=i32)
    assert [keeps(each) for each in (21, -4)] == [42, -8]


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


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_a_stack_is_as_large_as_the_scratchpad(tmp_path: Path) -> None:
    """Who has too many local variables is told so."""
    (tmp_path / "large.c").write_text("int large(int n) { volatile char a[9000]; a[n] = n; return a[n]; }\n")
    kernel = kernel_from(tmp_path / "large.c", "large", n=i32, result=i32)
    assert kernel(8999) == 8999 % 256
    with pytest.raises(KernelError, match="its stack must fit into the 4,096 bytes of the scratchpad"):
        kernel(0)


def test_a_word_lies_at_a_multiple_of_its_bytes() -> None:
    """The Blackfin raises an exception where it does not; code that aligns its addresses may have any."""
    kernel = kernel_from(DATA / "wild.o", "wild", at=i32)
    with pytest.raises(
        KernelError, match=r"_wild must run .* accesses an address that is no multiple of the 2 or 4 bytes"
    ):
        kernel(0x20000002)


def test_the_line_of_an_access_that_is_not_aligned_is_told() -> None:
    """In C nobody knows the addresses of instructions."""
    kernel = kernel_from(DATA / "prototypes.o", "state_of", state=i32, result=i32)
    with pytest.raises(KernelError, match=r"at 0xFFA[0-9A-F]{5} \(prototypes.c:35\) it accesses an address"):
        kernel(0x20000002)


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("trap", r"at 0xFFA00000 \(traps.s:6\) there is an exception \(EXCPT\), which nothing handles"),
        ("idle", r"at 0xFFA00004 \(traps.s:13\) there is an instruction for the system, such as IDLE"),
        ("nothing", r"at 0xFFA00008( \(traps.s:[0-9]+\))? there is no instruction of the Blackfin"),
        (
            "halt",
            r"at 0xFFA0000C \(traps.s:25\) there is an instruction for simulators \(OUTC, HLT or ABORT\)",
        ),
    ],
)
def test_what_ends_code_is_told_in_words(name: str, what: str) -> None:
    """With its line, for in C nobody knows the addresses of instructions."""
    with pytest.raises(KernelError, match=f"_{name} must run and return to its caller, but {what}"):
        kernel_from(DATA / "traps.o", name)()


def test_a_wild_access_is_refused() -> None:
    """It is no access of the process, and the kernel can be called again."""
    kernel = kernel_from(DATA / "wild.o", "wild", at=i32)
    with pytest.raises(KernelError, match=r"_wild must .* but at 0xFFA00002 it accesses 0x40000000, where"):
        kernel(0x40000000)
    assert kernel.cost(0x20000000, profile="gcc-O2") == 7
    assert (
        kernel.cost(0x20000000) == 7 + 4
    )  # the address waits for its register, which the default profile counts


@pytest.mark.toolchain
@pytest.mark.skipif(shutil.which("bfin-elf-gcc") is None, reason="no bfin-elf toolchain on PATH")
def test_a_wild_access_of_a_python_kernel_s_code_is_told_by_its_address(tmp_path: Path) -> None:
    """That code is not held to be right as it runs, for the kernel itself is checked: it has no table of places."""
    (tmp_path / "fw_far.py").write_text(
        "from bfsim.api import i32, kernel, u8\n\n\n@kernel\ndef far(row: u8[:], at: i32) -> i32:\n    return row[at]\n"
    )
    kernel = load_kernel(f"{tmp_path}/fw_far.py:far", "tinyphoon")
    with pytest.raises(KernelError, match="but it accesses 0x30000000, where there is no memory"):
        kernel.cost(ROW, 1 << 28, profile="gcc")


def lines_of_costs(folder: Path) -> set[int]:
    """The lines that `sums` in a folder has cycles for, as a process finds that has just started."""
    compiled._READ.clear()  # what another process does not have
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


def test_lines_of_a_source_are_counted_as_a_compiler_counts_them(tmp_path: Path) -> None:
    """Sources of GNU have form feeds between their parts, which end no line for a compiler."""
    (tmp_path / "parts.c").write_bytes(b"int a;\n\f\nint b; /* \x85 \v */\r\nint c;\n")
    assert file_lines(tmp_path / "parts.c") == [
        "int a;",
        "\f",
        "int b; /* \N{REPLACEMENT CHARACTER} \v */",
        "int c;",
    ]
