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
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.given_names import given_names
from benchmarks.twins.case import Case
from benchmarks.twins.cases import CASES
from benchmarks.twins.exported import played
from benchmarks.twins.measured import MEASURED, Role
from benchmarks.twins.predicted import predict
from benchmarks.twins.trace import executed, steps, summary
from bfsim.kernel import GCC_O0, GCC_O2

HERE = Path(__file__).parent
SOURCES = HERE / "c"
PROFILES = {"O0": GCC_O0, "O2": GCC_O2}
KEPT = ("role", "first_sight")
TOOLS = ("bfin-elf-gcc", "bfin-elf-nm", "bfin-elf-run")
FLAGS = ("-mcpu=bf561", "-std=c99", "-msim")


def missing_tools() -> list[str]:
    """Return the programs of the toolchain that are not on PATH."""
    return [tool for tool in TOOLS if shutil.which(tool) is None]


def measure(name: str, folder: Path) -> dict[str, Any]:
    """Return what `measured.json` says of a kernel, but for what is kept; `folder` takes the programs."""
    case = next(each for each in CASES if each.name == name)
    return _measure_exported(case, folder) if case.exported else _measure_written(name, folder)


def _measure_exported(case: Case, folder: Path) -> dict[str, Any]:
    levels = {}
    for level, profile in PROFILES.items():
        program, cycles = played(case, profile, folder)
        levels[level] = traced(program, case.name)
        if levels[level]["cycles"] != cycles:
            raise SystemExit(
                f"{case.name}: the trace must take {cycles} cycles, not {levels[level]['cycles']}"
            )
    return {"checksum": case.checksum(), "levels": levels}


def _measure_written(name: str, folder: Path) -> dict[str, Any]:
    record: dict[str, Any] = {}
    levels = {}
    for level in PROFILES:
        program = folder / f"{name}_{level}"
        _output("bfin-elf-gcc", *FLAGS, f"-{level}", SOURCES / f"k_{name}.c", "-o", program)
        (_, _, checksum), (_, *words) = map(str.split, _output("bfin-elf-run", program).splitlines())
        sizes = dict(word.split("=") for word in words)
        found = {"unit": sizes["unit"], "units": int(sizes["units"]), "checksum": checksum}
        if record and record != found:
            raise SystemExit(f"{name}: the outputs at -{level} must be those at the other level, not {found}")
        record = found
        levels[level] = traced(program, name)
    return record | {"levels": levels}


def first_sight(name: str, found: dict[str, Any]) -> dict[str, Any]:
    """Return what is kept of a kernel that nobody has looked at: that it is held out, and by how much the model is off."""
    case = next(each for each in CASES if each.name == name)
    commit, at = _output("git", "-C", HERE, "log", "-1", "--format=%h %cI").split()
    percent = {
        level: round(100 * (predict(case, profile).cycles / found["levels"][level]["cycles"] - 1), 2)
        for level, profile in PROFILES.items()
    }
    return {"role": Role.HELD_OUT.value, "first_sight": {"commit": commit, "at": at} | percent}


def traced(program: Path, name: str) -> dict[str, Any]:
    """Run a program of the Blackfin; return cycles and classes of the operations of its function `name` (`trace.summary`)."""
    command = ["bfin-elf-run", "--trace-insn", str(program)]
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, cwd=program.parent
    ) as run:
        assert run.stderr
        return summary(*executed(steps(run.stderr), _entry(program, name)))


def _entry(program: Path, name: str) -> int:
    symbols = (line.split() for line in _output("bfin-elf-nm", program).splitlines())
    return next(int(address, 16) for address, _, symbol in symbols if symbol == f"_{name}")


def _output(*command: str | Path) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main() -> None:
    """Measure the kernels and write their entries; what is kept of a kernel is written once, when it is new."""
    names = given_names(__doc__, [each.name for each in CASES])
    if missing := missing_tools():
        raise SystemExit(f"a bfin-elf toolchain must be on PATH; not found: {', '.join(missing)}")
    measured: dict[str, Any] = json.loads(MEASURED.read_text()) if MEASURED.exists() else {}
    with tempfile.TemporaryDirectory() as folder:
        for name in names or [case.name for case in CASES]:
            known = measured.get(name)
            found = measure(name, Path(folder))
            kept = {key: known[key] for key in KEPT if key in known} if known else first_sight(name, found)
            measured[name] = kept | found
    partial = MEASURED.with_suffix(".partial")
    partial.write_text(json.dumps(dict(sorted(measured.items())), indent=1) + "\n")
    partial.replace(MEASURED)


if __name__ == "__main__":
    main()
