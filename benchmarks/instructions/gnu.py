"""Random sequences under the GNU simulator: one program of all of them, which writes the registers behind each to its output."""

from __future__ import annotations

import struct
import subprocess
from collections.abc import Iterator
from collections.abc import Sequence as Several
from pathlib import Path

from benchmarks.instructions.sequences import (
    ACCUMULATORS,
    REGISTERS,
    SCRATCH,
    Registers,
    Sequence,
    scratch_bytes,
)

PLAIN = tuple(each for each in REGISTERS if each not in {*ACCUMULATORS, "ASTAT", "R0"})
SAVED = ("R0", *PLAIN, "A0.W", "A0.X", "A1.W", "A1.X", "ASTAT")
"""Registers in the order of the program's output, a word each. Those without a load of their own go through R0."""


def simulated(sequences: Several[Sequence], folder: Path) -> list[Registers]:
    """Return the registers behind sequences, as bfin-elf-run computes them. Files are left in a folder."""
    source, program = folder / "sequences.s", folder / "sequences"
    source.write_text("\n".join(_source(sequences)))
    _call("bfin-elf-as", "-o", f"{program}.o", str(source))
    _call(
        "bfin-elf-ld",
        f"--section-start=.scratch={SCRATCH:#x}",
        "-o",
        str(program),
        f"{program}.o",
        "-e",
        "_start",
    )
    output = _call("bfin-elf-run", str(program))
    words = [
        struct.unpack_from(f"<{len(SAVED)}I", output, 4 * len(SAVED) * each) for each in range(len(sequences))
    ]
    return [_registers(dict(zip(SAVED, each, strict=True))) for each in words]


def _registers(saved: Registers) -> Registers:
    for each in ACCUMULATORS:
        extension = saved[f"{each}.X"] & 0xFF
        saved[each] = (extension - (extension >> 7 << 8) << 32) + saved[f"{each}.W"]
    return {each: saved[each] for each in REGISTERS}


def _source(sequences: Several[Sequence]) -> Iterator[str]:
    """Return the assembler source: P5 points to where registers are loaded from and then stored to."""
    yield from (".text", ".global _start", "_start:")
    for number, each in enumerate(sequences):
        yield f"P5.L = before{number}; P5.H = before{number};"
        yield "R0 = [P5++]; ASTAT = R0;"
        yield from (f"R0 = [P5++]; {part} = R0;" for part in ("A0.W", "A0.X", "A1.W", "A1.X"))
        yield from (_load(register) for register in (*PLAIN, "R0"))
        halfwords = struct.unpack(f"<{len(each.code) // 2}H", each.code)
        yield ".short " + ", ".join(map(hex, halfwords))
        yield f"P5.L = behind{number}; P5.H = behind{number};"
        yield "[P5++] = R0;"
        yield from (_store(register) for register in SAVED[1:])
    yield "P0 = 5; R0.L = request; R0.H = request; EXCPT 0; P0 = 1; R0.L = success; R0.H = success; EXCPT 0;"
    yield from (
        ".data",
        ".align 4",
        f"request: .long 1, behind0, {4 * len(SAVED) * len(sequences)}",
        "success: .long 0, 0, 0",
    )
    for number, each in enumerate(sequences):
        yield f"before{number}: .long " + ", ".join(map(str, _words(each.before)))
    yield from (f"behind{number}: .space {4 * len(SAVED)}" for number in range(len(sequences)))
    yield '.section .scratch, "aw"'
    yield ".byte " + ", ".join(map(str, scratch_bytes()))


def _words(before: Registers) -> Iterator[int]:
    yield before["ASTAT"]
    for each in ACCUMULATORS:
        yield from (before[each] & 0xFFFFFFFF, before[each] >> 32 & 0xFF)
    yield from (before[each] for each in (*PLAIN, "R0"))


def _load(register: str) -> str:
    return f"{register} = [P5++];" if register[0] in "RP" else f"R0 = [P5++]; {register} = R0;"


def _store(register: str) -> str:
    return f"[P5++] = {register};" if register[0] in "RP" else f"R0 = {register}; [P5++] = R0;"


def _call(*command: str) -> bytes:
    return subprocess.run(command, check=True, capture_output=True).stdout
