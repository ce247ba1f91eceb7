"""Measure the C twins: compile each for the BF561, run it under the GNU simulator, write `measured.json`.

    python -m benchmarks.twins.measure            all kernels
    python -m benchmarks.twins.measure NAME ...   only these

Needs a bfin-elf toolchain on PATH (bfin-elf-gcc, bfin-elf-nm, bfin-elf-run; the recorded run: GCC 12.2.0, newlib,
GNU simulator 13.1). The simulator charges cycles without memory, cache or interlocks: code and data in L1.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.twins.trace import executed, steps, summary

HERE = Path(__file__).parent
SOURCES = HERE / "c"
MEASURED = HERE / "measured.json"
LEVELS = ("O0", "O2")
TOOLS = ("bfin-elf-gcc", "bfin-elf-nm", "bfin-elf-run")
FLAGS = ("-mcpu=bf561", "-std=c99", "-msim")
NEW_ROLE = "held-out"  # until its numbers are used to find rules: then it is "fit"


def missing_tools() -> list[str]:
    """Return the programs of the toolchain that are not on PATH."""
    return [tool for tool in TOOLS if shutil.which(tool) is None]


def measure(name: str, folder: Path) -> dict[str, Any]:
    """Return what `measured.json` says of a kernel, but for its role; `folder` takes the programs."""
    record: dict[str, Any] = {}
    levels = {}
    for level in LEVELS:
        program = folder / f"{name}_{level}"
        _output("bfin-elf-gcc", *FLAGS, f"-{level}", SOURCES / f"k_{name}.c", "-o", program)
        (_, _, checksum), (_, *words) = map(str.split, _output("bfin-elf-run", program).splitlines())
        sizes = dict(word.split("=") for word in words)
        found = {"unit": sizes["unit"], "units": int(sizes["units"]), "checksum": checksum}
        if record and record != found:
            raise SystemExit(f"{name}: the outputs at -{level} must be those at -{LEVELS[0]}, not {found}")
        record = found
        levels[level] = _traced(program, name)
    return record | {"levels": levels}


def _traced(program: Path, name: str) -> dict[str, Any]:
    command = ["bfin-elf-run", "--trace-insn", str(program)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as run:
        assert run.stderr
        return summary(*executed(steps(run.stderr), _entry(program, name)))


def _entry(program: Path, name: str) -> int:
    symbols = (line.split() for line in _output("bfin-elf-nm", program).splitlines())
    return next(int(address, 16) for address, _, symbol in symbols if symbol == f"_{name}")


def _output(*command: str | Path) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main(names: list[str]) -> None:
    """Measure the kernels and write their entries; the role of a kernel is kept."""
    if missing := missing_tools():
        raise SystemExit(f"a bfin-elf toolchain must be on PATH; not found: {', '.join(missing)}")
    measured: dict[str, Any] = json.loads(MEASURED.read_text()) if MEASURED.exists() else {}
    with tempfile.TemporaryDirectory() as folder:
        for name in names or [path.stem.removeprefix("k_") for path in SOURCES.glob("k_*.c")]:
            role = measured.get(name, {}).get("role", NEW_ROLE)
            measured[name] = {"role": role} | measure(name, Path(folder))
    partial = MEASURED.with_suffix(".partial")
    partial.write_text(json.dumps(dict(sorted(measured.items())), indent=1) + "\n")
    partial.replace(MEASURED)


if __name__ == "__main__":
    main(sys.argv[1:])
