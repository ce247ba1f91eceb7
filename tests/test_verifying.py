"""`bfsim verify`: estimates beside the compiler's code, and the sample of calls that both play."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from bfsim.cli.main import main
from bfsim.compiling.object_code import object_code
from bfsim.compiling.toolchain import GCC, Toolchain, blackfin_toolchain
from bfsim.errors import ConfigError
from bfsim.kernel import GCC_O0, GCC_O2, VDSP_O2, Kernel
from bfsim.report.kernels.verification import verdict
from bfsim.run import simulate
from bfsim.trace.verification import Verification, VerifiedKernel
from bfsim.verifying import Sampler, verify
from bfsim.verifying.played import Calls, simulated
from bfsim.verifying.player import FACTOR, checksum
from bfsim.verifying.sample import Sample
from bfsim.verifying.verify import compared
from tests.eyes import FIRMWARE, record
from tests.kernel import c_kernels
from tests.kernel.c.test_c import drawn
from tests.kernel.host_c import COMPILER, needs_compiler
from tests.sums import SUMS, sums

WITHOUT_OVERFLOW = ("last_of_loop", "moving_stop", "left_first", "sometimes", "floats", "choices", "unsigned")
SANITIZED = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


def sampled(*kernels: Kernel) -> Sampler:
    """A sample of calls with arguments at random."""
    random = np.random.default_rng(3)
    sampler = Sampler(20)
    for each in kernels:
        sampler.of[each] = Sample(40, 2, [tuple(drawn(each, random)) for _ in range(20)])
    return sampler


def played(sampler: Sampler, tools: Toolchain) -> Calls:
    """The calls of a sample as the program plays them that `tools` make, for whatever machine."""
    return simulated(sampler, object_code(sampler.of, sampler.of, GCC_O2, tools), tools)


def test_a_sample_is_spread_evenly_and_bounded() -> None:
    """Of 100 calls every sixteenth is kept, since every eighth would be more than seven."""
    sampler = Sampler(7)
    for number in range(100):
        sampler.see(c_kernels.take, (number,))
    (sample,) = sampler.of.values()
    assert sample.seen == 100
    assert [number for (number,) in sample.kept] == list(range(0, 100, 16))


def test_object_code_is_not_sampled() -> None:
    """It has no estimate, and is not written as C."""
    sampler = Sampler(7)
    sampler.see(sums(), ())
    assert not sampler.of


def test_a_sample_is_taken_before_the_call() -> None:
    """What a run sees of a kernel are its arguments as they were, and a single frame has as many calls as it counts."""
    sampler = Sampler(4)
    done = simulate(frames=1, on_call=sampler.see)
    (rows,) = (sample for kernel, sample in sampler.of.items() if kernel.name == "gauss3_row")
    assert rows.seen == sum(each.calls for each in done.kernels if each.kernel == "gauss3_row")
    assert len(rows.kept) <= 4
    assert not rows.kept[0][3].any()  # the row that the first call is to fill


@needs_compiler
def test_the_program_leaves_the_same_bits_under_sanitizers() -> None:
    """Played by this machine's compiler, no call leaves other bits, leaves an array or does what C leaves open."""
    kernels = [getattr(c_kernels, each) for each in WITHOUT_OVERFLOW]
    sampler = sampled(*kernels)
    calls = played(sampler, Toolchain((COMPILER or "", *SANITIZED)))
    found = compared(sampler, 1, GCC_O2, "", calls, None)
    assert (found.different, len(found.kernels)) == (0, len(kernels))
    assert all(each.calls == 40 and each.played == 20 and each.estimated_cclk > 0 for each in found.kernels)


@needs_compiler
def test_a_kernel_may_be_called_as_the_program_calls_its_own_or_as_the_c_library_does() -> None:
    sampler = sampled(c_kernels.take, c_kernels.free)
    found = compared(sampler, 1, GCC_O2, "", played(sampler, Toolchain((COMPILER or "",))), None)
    assert (found.different, len(found.kernels)) == (0, 2)


@needs_compiler
def test_other_bits_are_told() -> None:
    """A program that leaves something else is found out: here it tells 0 of each call."""
    liar = Toolchain((COMPILER or "",), ("sh", "-c", '"$0" | sed "s/ .*/ 0/"'))
    sampler = sampled(c_kernels.narrowed)
    found = compared(
        sampler, 1, GCC_O2, "", played(sampler, Toolchain((COMPILER or "",))), played(sampler, liar)
    )
    assert found.different == 20
    assert "20 calls leave OTHER BITS, of narrowed." in verdict(found)


def test_the_checksum_is_a_polynomial_of_the_words() -> None:
    """Words of the arrays in turn, the last one filled up with zeros, then the result."""
    arrays = [np.array([1, 2, 3, 4, 5], np.uint8), np.array([-1], np.int32)]
    value = 0
    for word in (0x04030201, 5, 0xFFFFFFFF, 7):
        value = (value * FACTOR + word) % 2**32
    assert checksum([*arrays, 12], 7) == value


@pytest.mark.toolchain
@pytest.mark.skipif(COMPILER is None, reason="no C compiler on PATH")
@pytest.mark.parametrize("profile", [GCC_O2, GCC_O0])
def test_gcc_s_code_leaves_the_same_bits(profile: Any) -> None:
    """Played by GCC's code for the Blackfin. Its translation takes the simulator's cycles; the estimate is within a third of them."""
    try:
        tools = blackfin_toolchain()
    except ConfigError:
        pytest.skip("no bfin-elf toolchain on PATH")
    names = [each for each in WITHOUT_OVERFLOW if each != "floats" or profile.floats]
    kernels = [getattr(c_kernels, each) for each in names]
    sampler = sampled(*kernels)
    found = verify(sampler, 1, profile, object_code(kernels, kernels, profile, tools), tools)
    assert (found.different, found.unequal, found.is_judged) == (0, 0, True)
    assert abs(found.signed_error) < 1 / 3


def test_errors_are_signed_and_by_share() -> None:
    """+10 % of 100 cycles and -10 % of 300 are -5 % together, 10 % by share."""
    rows = [
        VerifiedKernel("a", "a.py", 1, 1, 1, 110, 100, 0, 0),
        VerifiedKernel("b", "b.py", 1, 1, 1, 270, 300, 0, 3),
    ]
    found = Verification("gcc-O2", "12.2.0", 1, True, tuple(rows))  # noqa: FBT003
    assert found.signed_error == pytest.approx(-0.05)
    assert found.error_by_share == pytest.approx(0.1)
    assert "-5.0 %" in verdict(found)
    assert "10.0 %" in verdict(found)
    assert "OTHER CYCLES than under the GNU simulator in 3 calls, of b." in verdict(found)


def test_a_profile_without_a_compiler_is_refused() -> None:
    """Nobody here has VisualDSP++."""
    with pytest.raises(ConfigError, match="one of gcc-O2, gcc-O0, gcc, gcc-adi for"):
        object_code([], [], VDSP_O2, None)


def test_a_run_without_kernels_is_refused() -> None:
    """There is nothing to compare."""
    with pytest.raises(ConfigError, match="must call a kernel"):
        object_code([], [], GCC_O2, None)


@pytest.mark.parametrize("command", ["verify", "run", "profile", "check"])
def test_a_missing_toolchain_is_told_before_the_run(command: str, tmp_path: Path) -> None:
    """The command says what is missing, where, and how one is built."""
    result = CliRunner().invoke(main, [command, "--toolchain", str(tmp_path)])
    assert result.exit_code == 2
    assert f"{GCC} must be in {tmp_path}" in " ".join(result.output.split())


@needs_compiler
def test_the_command_compares_the_kernels_of_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a firmware of one kernel, and one that is object code; this machine's compiler stands in for the Blackfin's, and takes no cycles."""
    tools = Toolchain((COMPILER or "",))
    monkeypatch.setattr("bfsim.compiling.toolchain.blackfin_compiler", lambda: tools)
    module = importlib.import_module("bfsim.verifying.verify")
    monkeypatch.setattr(module, "translated", lambda sampler, code: simulated(sampler, code, tools))
    (tmp_path / "fw_eyes.py").write_text(f"{FIRMWARE}\n{SUMS}")
    what = ["verify", str(record(tmp_path / "drive.mcap", 2)), "--firmware", f"{tmp_path}/fw_eyes.py:eyes"]
    result = CliRunner().invoke(main, [*what, "--calls", "5", "--json", str(tmp_path / "found.json")])
    assert result.exit_code == 0, result.output
    found = json.loads((tmp_path / "found.json").read_text())
    assert (found["schema"], found["different"]) == ("bfsim.verify/1", 0)
    assert [(each["kernel"], each["calls"], each["played"]) for each in found["kernels"]] == [
        ("threshold", 32, 4)
    ]


@pytest.mark.exhaustive
def test_the_command_needs_no_toolchain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The code of the built-in firmware comes with bfsim and is translated: the JSON has every kernel, no bit is different."""
    monkeypatch.setenv("PATH", str(tmp_path))
    what = ["verify", "--frames", "1", "--calls", "1"]
    result = CliRunner().invoke(main, [*what, "--json", str(tmp_path / "found.json")])
    assert result.exit_code == 0, result.output
    told = " ".join(result.output.split())
    assert "GCC 12.2.0's code takes" in told
    assert "there was no GNU simulator to compare with" in told
    found = json.loads((tmp_path / "found.json").read_text())
    assert (found["schema"], found["different"], found["is_judged"]) == ("bfsim.verify/1", 0, False)
    assert {"kernel", "estimated_cclk", "measured_cclk"} <= set(found["kernels"][0])
