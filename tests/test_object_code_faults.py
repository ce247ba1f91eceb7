"""Object code that goes wrong: it comes to what is missing, accesses where nothing is, spoils registers, or ends. Told with its line."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from bfsim.api import i32, kernel_from
from bfsim.errors import KernelError
from bfsim.loading.kernel_named import load_kernel
from tests.sums import DATA, ROW


def test_what_is_missing_is_told_when_the_code_comes_to_it() -> None:
    """Under its name in C; an object file that another build links must have all."""
    kernel = kernel_from(DATA / "missing.o", "missing", a=i32, result=i32)
    with pytest.raises(
        KernelError,
        match=r"but it comes to __divsi3, which missing.o does not define and missing calls at \S+; define it there, or give one",
    ):
        kernel(3)


def test_what_an_object_file_of_visualdsp_lacks_is_in_its_program(tmp_path: Path) -> None:
    """GCC, which it was told to be linked by, has no library of VisualDSP++."""
    shutil.copy(DATA / "missing.o", tmp_path / "missing.doj")
    with pytest.raises(KernelError, match=r"give the program that it was linked to \(\.dxe\)"):
        kernel_from(tmp_path / "missing.doj", "missing", a=i32, result=i32)(3)


@pytest.mark.toolchain
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
__attribute__((noinline)) static void drop(int *words, int n)
{
    words[2 * n] = n;
}
void (*volatile way)(int *, int) = drop;
int sends(int *words, int n)
{
    way(words, n);
    return words[0];
}
"""


@pytest.mark.toolchain
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
        (
            "sends",
            1 << 28,
            r"\(wild.c:34\) of drop, which sends may call by its address at wild.c:39, it accesses 0xA0",
        ),
        ("jumps", 0, r"\(wild.c:24\) it goes to 0x00000007, an address that"),
    ):
        kernel = kernel_from(tmp_path / "wild.o", name, words=i32[:], n=i32, result=i32)
        for _ in range(2):  # what the first one has left tells nothing of the second
            with pytest.raises(KernelError, match=what):
                kernel(np.full(4, 7, np.int32), n)


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


@pytest.mark.toolchain
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
        (
            "nothing",
            r"at 0xFFA00008( \(traps.s:[0-9]+\))? there is no instruction of the Blackfin, as behind a function that does not end with RTS",
        ),
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
def test_a_wild_access_of_a_python_kernel_s_code_is_told_by_its_address(tmp_path: Path) -> None:
    """That code is not held to be right as it runs, for the kernel itself is checked: it has no table of places."""
    (tmp_path / "fw_far.py").write_text(
        "from bfsim.api import i32, kernel, u8\n\n\n@kernel\ndef far(row: u8[:], at: i32) -> i32:\n    return row[at]\n"
    )
    kernel = load_kernel(f"{tmp_path}/fw_far.py:far", "tinyphoon")
    with pytest.raises(KernelError, match="but it accesses 0x30000000, where there is no memory"):
        kernel.cost(ROW, 1 << 28, profile="gcc")
