"""Runs of the compiler's own code: what they see and leave is as estimated; their cycles are those of its instructions."""

from __future__ import annotations

import pickle
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bfsim.api import kernel as kernel_of_firmware
from bfsim.blackfin.elf.image import Use
from bfsim.blackfin.elf.objects import read_object
from bfsim.compiling.loaded_code import LoadedCode
from bfsim.compiling.object_code import _shipped_programs, object_code
from bfsim.errors import BfsimWarning
from bfsim.explain import explain_named
from bfsim.kernel import GCC_O2, CompilerProfile, Kernel
from bfsim.kernel.operations import COSTS, Op
from bfsim.kernel.profile import DEFAULT, GCC, GCC_ADI
from bfsim.loading.firmware import load_firmware
from bfsim.loading.kernel_named import load_kernel
from bfsim.loading.kernels import entries_of, kernels_of
from bfsim.machine.memories import Row
from bfsim.report.diff.result_side import result_side
from bfsim.report.results.result import result_of
from bfsim.report.what_ran.code import MODEL_ERROR_PERCENT, code_in_words
from bfsim.result import Run
from bfsim.run import simulate
from bfsim.running import building
from bfsim.running.building import build_for
from bfsim.seen import SeenFrame
from bfsim.shipped import FIRMWARE, accuracy_on
from bfsim.trace import StallReason
from bfsim.verifying import Sampler, verify
from tests.eyes import FIRMWARE as SMALL_FIRMWARE
from tests.kernel import cost_kernels
from tests.machine.owners import assert_owned
from tests.tiers import exhaustive

EXACT, CODE = DEFAULT.name, "GCC 12.2.0 -O2, timing adi"
FEW_CALLED = ("suppress_row", "gauss3_row", "clear_segments")
"""Kernels, each in several stages, of which every call is played once more."""

MAKERS = (
    "elftools",
    "bfsim.blackfin.instructions.decode",
    "bfsim.blackfin.translation.translate",
    "bfsim.kernel.language.language",
    "bfsim.kernel.c",
)
"""Of what is kept."""


@pytest.fixture(scope="module")
def exact() -> Run:
    """A frame of the built-in firmware by the compiler's own code."""
    return simulate(frames=1)


def test_what_is_inlined_is_of_the_line_that_calls_it() -> None:
    """Divisions that round down, and shifts, are functions of headers of the C: in the Python they are of the line that has them.

    They were of the line with the number of the instruction, which may be behind the kernel.
    """
    loaded = load_firmware(FIRMWARE[0])
    kernels, entries = kernels_of(loaded.own), entries_of(loaded.firmware)
    code = object_code(kernels | entries, entries, GCC_ADI, None)
    places = LoadedCode(code)._places
    signs: dict[str, set[str]] = {}
    for routine in places.image.routines:
        for address in range(routine.address, routine.end, 2) if routine.name in places.kernels else ():
            line = places.lines.at(address)
            if line and line.file == "operators.h":
                place = places.line_of(address)
                rows = places.function_called(place.routine).source.splitlines()
                assert 1 < place.line <= len(rows)
                signs.setdefault(places.kernels[routine.name].name, set()).add(rows[place.line - 1].strip())
    assert signs["slope"] == {"return (across << SLOPE_BITS) // along"}


def test_the_digest_of_code_is_of_what_runs() -> None:
    """A file of code names the folder in which it was compiled, another one each time: runs of the same firmware had other identities."""
    loaded = load_firmware(FIRMWARE[0])
    kernels, entries = kernels_of(loaded.own), entries_of(loaded.firmware)
    code = object_code(kernels | entries, entries, GCC_ADI, None)
    elsewhere = re.sub(rb"/tmp/tmp.{8}", b"/var/tmp/folder_", code.octets)
    assert elsewhere != code.octets
    at = next(each.offset for each in read_object(code.octets, "").sections if each.use is Use.CODE)
    changed = b"".join((code.octets[:at], bytes([code.octets[at] ^ 1]), code.octets[at + 1 :]))
    digest, same, other = (
        LoadedCode(replace(code, octets=each)).digest for each in (code.octets, elsewhere, changed)
    )
    assert digest == same != other


@pytest.mark.toolchain
def test_a_run_is_the_same_one_wherever_its_code_was_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On two machines, each with a cache of its own, and in two folders: what was recorded on one is played on the other."""
    identities = []
    for machine in ("one", "another"):
        folder = tmp_path / machine
        folder.mkdir()
        (folder / "eyes.py").write_text(SMALL_FIRMWARE)
        monkeypatch.setenv("BFSIM_CACHE_DIR", str(folder / "cache"))
        monkeypatch.chdir(folder)
        work = {"work" if identities else "record_work": tmp_path / "eyes.work"}
        identities.append(simulate(frames=1, firmware="eyes.py:eyes", **work).identity)
    assert identities[0] == identities[1]
    assert identities[0].code == CODE


@pytest.mark.exhaustive
def test_it_sees_and_publishes_what_the_estimated_run_does() -> None:
    """Bit for bit; only cycles differ."""
    seen: dict[str, list[SeenFrame]] = {EXACT: [], "vdsp-O2": []}
    runs = {name: simulate(frames=1, profile=name, on_seen=of.append) for name, of in seen.items()}
    assert pickle.dumps(seen[EXACT]) == pickle.dumps(seen["vdsp-O2"])
    exact, estimated = ([each.results for each in run.frames] for run in runs.values())
    assert exact == estimated
    calls = [
        {(each.core, each.stage, each.path[0]) for each in done.paths if each.calls} for done in runs.values()
    ]
    assert calls[0] == calls[1]
    assert runs[EXACT].frames[0].cores[0].end_cclk != runs["vdsp-O2"].frames[0].cores[0].end_cclk


@pytest.mark.exhaustive
def test_each_call_takes_the_cycles_that_verify_has() -> None:
    """Of every call of some kernels, those that they make included."""
    sampler = Sampler(1 << 20)

    def see(kernel: Kernel, arguments: tuple[Row | int, ...]) -> None:
        if kernel.name in FEW_CALLED:
            sampler.see(kernel, arguments)

    run = simulate(frames=1, profile="gcc", on_call=see)
    loaded = load_firmware(FIRMWARE[0])
    entries = entries_of(loaded.firmware)
    code = object_code(kernels_of(loaded.own) | entries, entries, GCC_O2, None)
    found = verify(sampler, 1, GCC_O2, code, None)
    assert {each.kernel for each in found.kernels} == set(FEW_CALLED)
    assert found.different == 0
    symbols = {each.name: each.function.symbol for each in sampler.of}
    for each in found.kernels:
        here = sum(path.issue_cclk for path in run.paths if path.path[0] == symbols[each.kernel])
        assert here == each.measured_cclk > 0


@pytest.mark.usefixtures("exact")
def test_a_second_start_reads_no_object_code() -> None:
    """All that is made of it is kept: neither the reader of ELF files nor the decoder, and no kernel's body, is needed again."""
    source = "import sys; from bfsim.run import simulate; simulate(frames=1); print(*sys.modules)"
    command = [sys.executable, "-c", source]
    again = subprocess.run(command, check=True, capture_output=True, text=True)
    assert not {*MAKERS} & {*again.stdout.split()}


@pytest.mark.parametrize("profile", [EXACT, *exhaustive("vdsp-O2")])
def test_every_cycle_has_an_owner(profile: str) -> None:
    """Issue, stall and idle cycles are the elapsed ones, by stages, kernels, lines, accesses and paths."""
    run = simulate(frames=1, profile=profile)
    assert_owned(run)
    for core in run.frames[0].cores:
        total = sum(each.issue_cclk + each.idle_cclk + sum(each.stall_cclk.values()) for each in core.stages)
        assert total == core.end_cclk - core.begin_cclk


def test_routines_of_the_library_are_told_in_the_lines_that_call_them(exact: Run) -> None:
    """Each has its cycles in a comparison, with the routine's name; they were told as kernels that nobody wrote."""
    side = result_side(result_of(exact, {}), {0})
    ran = {each.kernel for each in exact.kernels if each.kernel.startswith("__")}
    assert {"__divsi3", "__udivsi3"} <= ran
    assert not {each.name for each in side.owners} & ran
    assert sum(side.owners.values()) + sum(side.waits.values()) == sum(
        core.end_cclk - core.begin_cclk for core in exact.frames[0].cores
    )
    division_cclk = GCC_ADI.library.divide_unsigned.cclk + COSTS[Op.CALL].cclk
    divided = {
        line.text: line.operations["__udivsi3"]
        for owner, source in side.sources.items()
        for line in source.lines
        if owner.name == "angle8" and "__udivsi3" in line.operations
    }
    assert {each.strip() for each in divided} == {
        "angle = atan[i32((u32(ay) << 8) // u32(ax))]",
        "angle = 64 - atan[i32((u32(ax) << 8) // u32(ay))]",
    }
    assert all(cclk == times * division_cclk for times, cclk in divided.values())


def test_the_run_says_whose_code_and_for_how_much(exact: Run, tmp_path: Path) -> None:
    """In its identity, by kernel, and in words; an estimated run says nothing."""
    (tmp_path / "fw_eyes.py").write_text(SMALL_FIRMWARE)
    estimated = simulate(frames=1, firmware=f"{tmp_path}/fw_eyes.py:eyes", profile="vdsp-O2")
    assert (exact.identity.code, len(exact.identity.code_digest)) == (CODE, 64)
    assert (estimated.identity.code, estimated.identity.code_digest) == ("", "")
    assert all(0 <= each.object_cclk <= each.issue_cclk for each in exact.kernels)
    assert exact.object_share == 1
    assert estimated.object_share == 0
    assert code_in_words(exact) == CODE
    issue, of_objects = (
        sum(getattr(each, column) for run in (exact, estimated) for each in run.kernels)
        for column in ("issue_cclk", "object_cclk")
    )
    part = replace(exact, object_share=of_objects / issue)
    told = f"{100 * of_objects / issue:.2f} % of the issue cycles; all others are estimated"
    assert told in code_in_words(part)
    assert code_in_words(estimated) == ""
    lacking = replace(estimated, identity=replace(estimated.identity, code=building.NOTHING_AT_HAND))
    off = f"{MODEL_ERROR_PERCENT} %"
    assert code_in_words(lacking) == f"{building.NOTHING_AT_HAND}; a kernel is off by some {off}"
    told = "object code of files: 25.00 % of the issue cycles; all others are " + building.NOTHING_AT_HAND
    assert code_in_words(replace(lacking, object_share=0.25)) == told
    assert f"Expect {off}:" in accuracy_on("In short")
    assert f"{EXACT} ({CODE})" in " ".join(exact.report().split())


@pytest.fixture
def _nothing_at_hand(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("bfsim.files.store.shipped", lambda _package, _name: None)
    _shipped_programs.cache_clear()
    yield
    _shipped_programs.cache_clear()


@pytest.mark.usefixtures("_nothing_at_hand")
def test_without_code_and_compiler_all_is_estimated() -> None:
    """And is said to be."""
    build = build_for(load_firmware(FIRMWARE[0]), GCC)
    assert (build.objects, build.code) == ({}, building.NOTHING_AT_HAND)


def test_explain_shows_the_own_code() -> None:
    """Its operations are instructions, so that their cycles times their executions are those of the run."""
    done = simulate(frames=1, profile=EXACT)
    found = explain_named("sobel_row", FIRMWARE[0], EXACT, done)
    assert found.profile == CODE
    records = [each for each in done.kernels if each.kernel == "sobel_row"]
    assert found.calls == sum(each.calls for each in records) > 0
    text = range(found.first_line, found.first_line + len(records[0].text))
    assert {each.line for each in found.lines if each.operations} <= set(text)
    size = sum(each.nbytes for each in done.code)
    assert 0 < found.code_bytes < size


@pytest.mark.usefixtures("_nothing_at_hand")
def test_a_cost_without_a_compiler_is_an_estimate() -> None:
    """And is said to be."""
    kernel, rows = kernel_of_firmware(cost_kernels.copy_words.definition), np.zeros((2, 8), np.uint32)
    with pytest.warns(BfsimWarning, match="the cost of copy_words in gcc is an estimate: no code of GCC"):
        assert kernel.cost(*rows, profile="gcc") == kernel.cost(*rows, profile="gcc-O2")


def test_the_cost_of_a_built_in_kernel_is_that_of_its_code(
    exact: Run, recwarn: pytest.WarningsRecorder
) -> None:
    """Each call of `sobel_row` costs the same in a run, and as much by itself, without a compiler."""
    records = [each for each in exact.kernels if each.kernel == "sobel_row"]
    rows = [*np.zeros((3, 320), np.uint8), *np.zeros((2, 320), np.int16)]
    cost = load_kernel("sobel_row", FIRMWARE[0]).cost(*rows)
    cclk = sum(each.issue_cclk + each.stall_cclk[StallReason.INTERLOCK] for each in records)
    assert cost * sum(each.calls for each in records) == cclk
    assert not recwarn.list


@pytest.mark.toolchain
@pytest.mark.parametrize("profile", [GCC, GCC_ADI], ids=lambda each: each.name)
def test_the_cost_of_a_kernel_is_that_of_its_code_in_a_run(profile: CompilerProfile) -> None:
    """Compiled with its file alone, it takes the cycles that it takes compiled with the whole firmware."""
    build = build_for(load_firmware(FIRMWARE[0]), profile)
    line = np.arange(320, dtype=np.uint8)
    for name, arguments in (
        ("isqrt32", (1_000_000,)),
        ("mean_offset", (np.arange(400, dtype=np.uint16), 200, 1, 20, 2)),
        ("gauss3_row", (line, line, line, np.zeros(320, np.uint8))),
    ):
        kernel = load_kernel(name, FIRMWARE[0])
        code = build.compiled(kernel)
        arrays = [arguments[each] for each in kernel.array_positions]
        work = kernel.prepare(code, arrays, code.new_totals()).run(*arguments)
        assert kernel.cost(*arguments, profile=profile.name) == work.issue_cclk + work.stall_cclk > 0
