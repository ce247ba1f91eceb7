"""A kernel's instructions: their cycles are those of calls, their loops and what bounds these are known by hand."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from bfsim.api import Kernel, i32, kernel, kernel_from, u8
from bfsim.assembly import Counting, KernelCode, find_code, listed
from bfsim.cli.main import main
from bfsim.errors import ConfigError
from bfsim.kernel import GCC_O2
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernel_named import load_kernel
from bfsim.machine.memories import Row
from bfsim.trace.assembly import Assembly
from tests.eyes import FIRMWARE
from tests.sums import DATA, SUMS

CALLS = 3


@kernel
def _alone(value: i32) -> i32:
    """A kernel whose code nobody has kept."""
    return 12345 * value + 77


def sums() -> Kernel:
    """The function of `sums.c`: a loop that calls another function."""
    return kernel_from(DATA / "sums.o", "sums", row=u8[:], out=i32[:], n=i32, first=i32, result=i32)


def rows(*arrays: np.ndarray) -> list[Row]:
    """Arrays as a run hands them to kernels."""
    return [Row("row", "COREA_L1", 0, 0, each) for each in arrays]


def counted(code: KernelCode, length: int = 32) -> Assembly:
    """The code after some calls on rows of zeros."""
    counting = Counting(code)
    for _ in range(CALLS):
        row, out = rows(np.zeros(length, np.uint8), np.zeros(length, np.int32))
        counting.see(code.kernel, [row, out, length, 2])
    return listed(code, counting.events())


@pytest.fixture(scope="module")
def code() -> KernelCode:
    """The code of `sums`."""
    return find_code(sums(), load_firmware("tinyphoon"), GCC_O2, None)


@cache
def of(name: str) -> KernelCode:
    """The kept code of a kernel of the built-in firmware."""
    return find_code(load_kernel(name, "tinyphoon"), load_firmware("tinyphoon"), GCC_O2, None)


def test_every_instruction_of_the_function_is_there_once(code: KernelCode) -> None:
    """In the order of their addresses, one behind the other, and none of the function that it calls."""
    shown = listed(code)
    assert shown.instructions[0].address == 0xFFA00034
    assert shown.instructions[0].text == ("[--SP] = (R7:6, P5:3)",)
    for one, other in zip(shown.instructions, shown.instructions[1:], strict=False):
        assert one.address + one.nbytes == other.address
    assert shown.code_bytes == sum(each.nbytes for each in shown.instructions) == 0x78 - 0x34
    assert shown.callees == ("weighted",)


def test_an_instruction_stands_below_its_line(code: KernelCode) -> None:
    """The line is that of the file, with its number there."""
    text = (DATA / "sums.c").read_text().splitlines()
    sources = [each.source for each in listed(code).instructions]
    assert {each.text for each in sources if each} >= {"        total += out[x];"}
    assert all(text[each.line - 1] == each.text for each in sources if each)


def test_the_cycles_of_calls_are_those_of_the_instructions(code: KernelCode) -> None:
    """The function's own and those of its callee, which takes 14 + 9 + 4 * 8 + 1 + 11 + 5 cycles a call, add up to a call's."""
    shown = counted(code)
    each_call = code.kernel.cost(np.zeros(32, np.uint8), np.zeros(32, np.int32), 32, 2, profile="gcc-O2")
    turns = 32 - 4 - 2 + 1
    assert shown.calls == CALLS
    assert shown.total_cclk == CALLS * (each_call - turns * (14 + 10 + 4 * 8 + 1 + 11 + 5))
    [loop] = shown.loops
    assert loop.turns == CALLS * turns


def test_a_loop_with_a_call_and_a_branch(code: KernelCode) -> None:
    """Eight instructions; the call takes four cycles beyond its first, the branch that is predicted taken, too."""
    [loop] = listed(code).loops
    assert (loop.instructions, loop.is_hardware, loop.depth) == (8, False, 1)
    assert (loop.issue_cclk, loop.jump_cclk, loop.stall_cclk) == (8, 4 + 4, 0)
    assert (loop.least_cclk, loop.most_cclk) == (16, 16)
    assert loop.calls == ("weighted",)


def test_a_branch_has_both_its_costs(code: KernelCode) -> None:
    """Not predicted: 1 if it is not taken and 9 if it is; the loop's is predicted: 9 and 5."""
    branches = [each for each in counted(code).instructions if each.taken_cclk is not None]
    assert [(each.cclk, each.taken_cclk) for each in branches] == [(1, 9), (9, 5)]
    assert [each.taken for each in branches] == [0, CALLS * 26]
    assert [each.total_cclk for each in branches] == [CALLS, CALLS * (26 * 5 + 9)]


def test_a_hardware_loop_with_a_branch_in_it() -> None:
    """`isqrt32`: the way past the body takes 5 instructions and 4 cycles to jump, that through it 7 and 8 mispredicted."""
    [loop] = listed(of("isqrt32")).loops
    assert loop.is_hardware
    assert (loop.least_cclk, loop.most_cclk) == (5 + 4, 7 + 8)
    assert loop.bound == "branches"


def test_a_switch_is_no_loop_and_no_way_into_its_function() -> None:
    """Its jump was taken to lead to the function's start, too: that was a loop, and a state machine had -638 calls."""
    switched = kernel_from(DATA / "switched.o", "switched", x=i32, result=i32)
    counting = Counting(find_code(switched, load_firmware("tinyphoon"), GCC_O2, None))
    for x in (0, 2, 2):
        counting.see(switched, [x])
    shown = listed(counting.code, counting.events())
    assert shown.loops == ()
    assert shown.calls == 3
    returns = [each.executions for each in shown.instructions if each.text == ("RTS",)]
    assert returns == [1, 0, 2]


def test_instructions_that_are_issued_slot_by_slot_bound_a_loop() -> None:
    """`sobel_row`: 35 instructions a turn and nothing else; the pointers that step on are its chain."""
    [loop] = listed(of("sobel_row")).loops
    assert (loop.issue_cclk, loop.most_cclk, loop.chain_cclk, loop.bound) == (35, 35, 1, "issue slots")


def test_a_kernel_that_was_inlined_is_told() -> None:
    """Its instructions stand where it is called, which the message names."""
    with pytest.raises(
        ConfigError,
        match=r"try_triple must be a function in its code, but the compiler has put it into those that call it; --asm shows it there: \w+",
    ):
        of("try_triple")


def bfsim(*arguments: str) -> Result:
    """Call the command line."""
    return CliRunner().invoke(main, arguments, prog_name="bfsim", env={"COLUMNS": "80"})


def test_the_command_prints_what_fits_the_terminal() -> None:
    """Instructions, loops marked beside them, no line beyond 80 columns."""
    shown = bfsim("explain", "isqrt32", "--asm").stdout
    assert "ffa0000e      1  ┌ R2 = R0 + R1\n" in shown
    assert "ffa00014    9/5  │ IF CC JUMP 0xffa0001a (BP)\n" in shown
    assert "ffa0001a      1  └ R1 >>= 0x2\n" in shown
    assert max(map(len, shown.splitlines())) <= 80


def test_code_is_timed_as_the_default_profile_says() -> None:
    """With the waits that Analog Devices documents; `gcc` leaves them out, as the GNU simulator does."""
    assert "\nCycles (adi): " in bfsim("explain", "isqrt32", "--asm").stdout
    assert "\nCycles (gnu): " in bfsim("explain", "isqrt32", "--asm", "--profile", "gcc").stdout


def test_code_that_nobody_has_is_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What would be compiled, and how one gets a compiler."""
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path))
    with pytest.raises(
        ConfigError,
        match=r"bfin-elf-gcc must be on the PATH to compile test_assembly.c, .*; CONTRIBUTING.md says how",
    ):
        find_code(_alone, load_firmware("tinyphoon"), GCC_O2, None)


def test_a_kernel_beside_object_code_is_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels of the same firmware that are object code are not compiled with it."""
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path))
    (tmp_path / "fw_beside.py").write_text(f"{FIRMWARE}\n{SUMS}")
    name = f"{tmp_path}/fw_beside.py:eyes"
    with pytest.raises(ConfigError, match=r"bfin-elf-gcc must be on the PATH"):
        find_code(load_kernel("fw_beside:threshold", name), load_firmware(name), GCC_O2, None)


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (
            ("--asm", "--profile", "vdsp-O2"),
            "the profile must be one of gcc-O2, gcc-O0, gcc, gcc-adi for there to be real code",
        ),
        (("--toolchain", "."), "bfin-elf-gcc must be in ., but is not"),
    ],
)
def test_options_that_cannot_be_are_told(options: tuple[str, ...], what: str) -> None:
    """One paragraph, exit code 2."""
    done = bfsim("explain", "sobel_row", *options)
    assert (done.exit_code, what in done.stderr) == (2, True)


def test_kernels_that_never_come_to_it_are_not_translated(monkeypatch: pytest.MonkeyPatch) -> None:
    """A firmware has a hundred, and each would take as long as the one that is counted."""
    counting, looked_up = Counting(of("isqrt32")), []
    monkeypatch.setattr(KernelCode, "compiled_of", lambda _, kernel: looked_up.append(kernel))
    called, caller, other = (
        load_kernel(name, "tinyphoon") for name in ("isqrt32", "fit_circle", "sobel_row")
    )
    for each in (called, caller, other):
        counting.see(each, [])
    assert looked_up == [called, caller]


def test_counts_of_a_run_stand_beside_the_instructions() -> None:
    """One frame, as JSON: 240 rows of each of two cameras. A turn takes its 35 instructions, and 10 waits for pointers."""
    plain = json.loads(bfsim("explain", "sobel_row", "--asm", "--json", "--run", "--frames", "1").stdout)
    assert plain["schema"] == "bfsim.assembly/1"
    assert plain["calls"] == 2 * 240
    [loop] = plain["loops"]
    assert loop["turns"] == 2 * 240 * 318
    assert (loop["issue_cclk"], loop["stall_cclk"]) == (35, 10)
    assert loop["total_cclk"] == (35 + 10) * loop["turns"]
