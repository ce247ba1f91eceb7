"""Measure the C twins of the firmware's kernels on the BF561: compile them, run the recorded calls, write `measured.json`.

    python -m benchmarks.firmware_twins.measure            all kernels
    python -m benchmarks.firmware_twins.measure NAME ...   only these

Needs a bfin-elf toolchain on PATH (`benchmarks/toolchain/`). Each kernel is measured at -O2 in three variants and at -O0
with calls; `c/twin.h` says what the variants are. The simulator charges cycles without memory, cache or interlocks.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.firmware_twins.harness import block, driver, entry
from benchmarks.firmware_twins.measured import MEASURED
from benchmarks.firmware_twins.recorded import recorded
from benchmarks.firmware_twins.twins import TWINS
from bfsim.api import Kernel

HERE = Path(__file__).parent
SOURCES = HERE / "c"
TOOLS = ("bfin-elf-gcc", "bfin-elf-run")
FLAGS = ("-mcpu=bf561", "-msim")
CALLED = "__attribute__((noinline, noclone))"


@dataclass(frozen=True, slots=True)
class Variant:
    """How twins are compiled: optimisation, what KERNEL and HELPER mean, and whether all is one file."""

    level: str
    kernels: str
    helpers: str
    one_file: bool = False


VARIANTS = {
    "O0": Variant("-O0", CALLED, f"static {CALLED}"),
    "calls": Variant("-O2", CALLED, f"static {CALLED}"),
    "inlined": Variant("-O2", "", "static"),
    "one_file": Variant("-O2", "static", "static", one_file=True),
}


def missing_tools() -> list[str]:
    """Return the programs of the toolchain that are not on PATH."""
    return [tool for tool in TOOLS if shutil.which(tool) is None]


def measure(kernel: Kernel, folder: Path) -> dict[str, Any]:
    """Return what `measured.json` says of a kernel; `folder` takes the programs."""
    checksums, cycles = set(), {}
    for variant in VARIANTS:
        program = build(kernel, variant, folder, compiler=("bfin-elf-gcc", *FLAGS))
        *spent, checksum = _output("bfin-elf-run", program).split()
        checksums.add(checksum)
        cycles[variant] = [int(each) for each in spent]
    if len(checksums) != 1:
        raise SystemExit(f"{kernel.name}: the variants must leave the same, not {sorted(checksums)}")
    return {"checksum": checksums.pop(), "cycles": cycles}


def build(kernel: Kernel, variant: str, folder: Path, compiler: Sequence[str]) -> Path:
    """Compile the program that plays the recorded calls of a kernel; return it. A folder is for one compiler."""
    sources = {"driver": driver(kernel), "calls": CALLS.format(path=folder / "calls.bin")}
    (folder / "calls.bin").write_bytes(block(recorded()[kernel].arguments))
    if VARIANTS[variant].one_file:
        files = dict.fromkeys(Path(each.file).stem for each in (kernel.function, *kernel.function.callees()))
        sources["entry"] = "".join(f'#include "{each}.c"\n' for each in files) + entry(kernel)
        library = []
    else:
        sources["entry"] = f"extern void {kernel.name}(void);\n{entry(kernel)}"
        library = [_library(variant, folder, compiler)]
    objects = []
    for name, text in sources.items():
        source = folder / f"{name}.c"
        source.write_text(text, encoding="utf-8")
        objects.append(_compiled(source, folder / f"{name}.o", variant, compiler))
    program = folder / f"{kernel.name}_{variant}"
    _output(*compiler, *objects, *library, "-o", program)
    return program


def _library(variant: str, folder: Path, compiler: Sequence[str]) -> Path:
    """Compile every file of twins for a variant, once."""
    archive = folder / f"{variant}.a"
    if not archive.exists():
        for each in sorted(SOURCES.glob("*.c")):
            _compiled(each, folder / f"{variant}_{each.stem}.o", variant, compiler)
        _output(compiler[0].replace("gcc", "ar"), "rcs", archive, *sorted(folder.glob(f"{variant}_*.o")))
    return archive


def _compiled(source: Path, to: Path, variant: str, compiler: Sequence[str]) -> Path:
    each = VARIANTS[variant]
    meanings = (f"-DKERNEL={each.kernels}", f"-DHELPER={each.helpers}", f"-I{SOURCES}")
    _output(*compiler, "-std=gnu99", each.level, "-w", *meanings, "-c", source, "-o", to)
    return to


CALLS = """\
#ifdef __BFIN__
#define NAME "_calls"
#else
#define NAME "calls"
#endif
__asm__(".section .rodata; .align 4; .global " NAME "; " NAME ": .incbin \\"{path}\\"; .text");
"""


def _output(*command: str | Path) -> str:
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return done.stdout


def main(names: list[str]) -> None:
    """Measure the kernels and write their entries."""
    if missing := missing_tools():
        raise SystemExit(f"a bfin-elf toolchain must be on PATH; not found: {', '.join(missing)}")
    measured: dict[str, Any] = json.loads(MEASURED.read_text()) if MEASURED.exists() else {}
    with tempfile.TemporaryDirectory() as folder:
        for kernel in TWINS:
            if kernel.name in names or not names:
                measured[kernel.name] = measure(kernel, Path(folder))
    rows = ",\n".join(f"{json.dumps(name)}: {json.dumps(row)}" for name, row in measured.items())
    MEASURED.write_text("{\n" + rows + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
