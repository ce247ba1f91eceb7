"""Measure the C twins of the firmware's kernels on the BF561: compile them, run the recorded calls, write `measured.json`.

    python -m benchmarks.firmware_twins.measure            all kernels
    python -m benchmarks.firmware_twins.measure NAME ...   only these

Needs a bfin-elf toolchain on PATH (`benchmarks/toolchain/`). Each kernel is measured at -O2 in three variants and at -O0
with calls; `c/twin.h` says what the variants are. The simulator charges cycles without memory, cache or interlocks.
"""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.firmware_twins.measured import MEASURED
from benchmarks.firmware_twins.recorded import recorded
from benchmarks.firmware_twins.twins import TWINS, of_all
from benchmarks.given_names import given_names
from bfsim.api import Kernel
from bfsim.compiling.toolchain import Toolchain, blackfin_toolchain
from bfsim.verifying.player import entries_of, write_player

HERE = Path(__file__).parent
SOURCES = HERE / "c"
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


def measure(kernel: Kernel, folder: Path) -> dict[str, Any]:
    """Return what `measured.json` says of a kernel; `folder` takes the programs."""
    checksums, cycles = set(), {}
    for variant in VARIANTS:
        toolchain = blackfin_toolchain()
        program = build(kernel, variant, folder, toolchain)
        lines = [[int(each) for each in line.split()] for line in toolchain.run(program).splitlines()]
        checksums.add(of_all([left for _, left in lines]))
        cycles[variant] = [cclk for cclk, _ in lines]
    if len(checksums) != 1:
        raise SystemExit(f"{kernel.name}: the variants must leave the same, not {sorted(checksums)}")
    return {"checksum": checksums.pop(), "cycles": cycles}


def build(kernel: Kernel, variant: str, folder: Path, toolchain: Toolchain) -> Path:
    """Compile the program that plays the recorded calls of a kernel; return it."""
    function, twins = kernel.function, []
    options = options_of(variant)
    if VARIANTS[variant].one_file:
        files = dict.fromkeys(Path(each.file).stem for each in (function, *function.callees()))
        included = "".join(f'#include "{each}.c"\n' for each in files)
        entries = included + entries_of([kernel.name], declared=False)
    else:
        twins = [_twins(variant, folder, toolchain)]
        entries = entries_of([kernel.name])
    calls = ((0, each) for each in recorded()[kernel].arguments)
    return toolchain.build(folder, [*write_player(folder, [function], entries, calls), *twins], options)


def _twins(variant: str, folder: Path, toolchain: Toolchain) -> str:
    """Compile every file of twins for a variant, once, and link them to one object file."""
    linked = folder / f"{variant}.o"
    if not linked.exists():
        sources = [str(each) for each in sorted(SOURCES.glob("*.c"))]
        toolchain.build(folder, sources, ("-r", *options_of(variant))).rename(linked)
    return linked.name


def options_of(variant: str) -> tuple[str, ...]:
    """Return what the compiler is told for a variant."""
    each = VARIANTS[variant]
    meanings = (f"-DKERNEL={each.kernels}", f"-DHELPER={each.helpers}", f"-I{SOURCES}", "-I.")
    return ("-std=gnu99", each.level, "-w", *meanings)


def main() -> None:
    """Measure the kernels and write their entries."""
    names = given_names(__doc__, [each.name for each in TWINS])
    measured: dict[str, Any] = json.loads(MEASURED.read_text()) if MEASURED.exists() else {}
    with tempfile.TemporaryDirectory() as folder:
        for kernel in TWINS:
            if kernel.name in names or not names:
                measured[kernel.name] = measure(kernel, Path(folder))
    rows = ",\n".join(f"{json.dumps(name)}: {json.dumps(row)}" for name, row in measured.items())
    MEASURED.write_text("{\n" + rows + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
