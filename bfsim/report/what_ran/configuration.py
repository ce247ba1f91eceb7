"""What ran on what, in words, and the digests of it."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.report.budget.times import milliseconds
from bfsim.report.what_ran.code import code_in_words
from bfsim.report.what_ran.digest import cycle_digest, identity_digest
from bfsim.report.wording.units import mhz
from bfsim.trace import CodeRecord, RunRecord


def configuration_of(run: RunRecord) -> Iterator[tuple[str, str]]:
    """Yield each part of what ran with its name, and the digests of it and of its cycles."""
    identity = run.identity
    yield "Recording", f"{identity.recording}, {identity.width_px}x{identity.height_px} px"
    if run.geometry:
        yield "Geometry", run.geometry
    yield "Firmware", _firmware(run)
    yield "Board", f"{identity.board}, CCLK {mhz(identity.cclk_hz)}, SCLK {mhz(identity.sclk_hz)}"
    yield "LDF", f"{identity.ldf} ({run.ldf_place})"
    yield "Compiler", f"{identity.compiler}, LLVM {identity.llvm_version}"
    if code := code_in_words(run):
        yield "Code", code
    for each in run.code:
        yield f"Code of {each.core}", _code(each)
    yield "Feed", identity.feed
    yield "Fidelity", identity.fidelity
    for peripheral in dict.fromkeys(each.over for each in run.messages):
        yield f"{peripheral} messages", _messages(run, peripheral)
    if run.interrupts:
        yield "Interrupts", ", ".join(f"{source} {count:,}" for source, count in run.interrupts.items())
    yield "bfsim", f"{identity.bfsim_version}, {run.events:,} events simulated"
    yield "Identity", identity_digest(identity)
    yield "Cycles", cycle_digest(run.frames)


def _firmware(run: RunRecord) -> str:
    """Say which files ran."""
    files = len(run.identity.firmware_files)
    return f"{run.identity.firmware} ({run.firmware_place}, {files} {'file' if files == 1 else 'files'})"


def _messages(run: RunRecord, over: str) -> str:
    """Say what a peripheral transferred in each direction, and how long the longest message took."""
    parts = []
    for direction in ("out", "in"):
        mine = [each for each in run.messages if (each.over, each.direction) == (over, direction)]
        if mine:
            longest = max(each.end_cclk - each.begin_cclk for each in mine)
            nbytes = sum(each.nbytes for each in mine)
            microseconds = 1000 * milliseconds(longest, run.identity.cclk_hz)
            parts.append(f"{len(mine):,} {direction} ({nbytes:,} bytes, at most {microseconds:.1f} µs each)")
    return "; ".join(parts)


def _code(code: CodeRecord) -> str:
    outside = "" if code.in_l1 else "; outside L1"
    return (
        f"{code.kernels} kernels, {code.nbytes:,} bytes in {code.segment}, {code.free_bytes:,} free{outside}"
    )
