"""Programs of the twins whose C is what `bfsim export` writes: they play the calls of the case (`bfsim/verifying`)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.twins.case import Case
from bfsim.compiling.object_code import object_code
from bfsim.compiling.toolchain import blackfin_toolchain
from bfsim.kernel import CompilerProfile
from bfsim.verifying.player import PLAYER_OPTIONS, checksum, entries_of, write_player


def played(case: Case, profile: CompilerProfile, folder: Path) -> tuple[Path, int]:
    """Compile a twin as a profile's compiler does and run it; return the program and the cycles of all its calls.

    Raises SystemExit unless every call leaves what the Python kernel leaves.
    """
    kernel, toolchain = case.kernel, blackfin_toolchain()
    calls, left = calls_of(case)
    code = object_code([kernel], [kernel], profile, toolchain)
    (folder / "kernels.o").write_bytes(code.octets)
    numbered = ((0, each) for each in calls)
    function = kernel.function
    sources = write_player(folder, [function], entries_of([code.names[function]]), numbered)
    built = toolchain.build(folder, ["kernels.o", *sources], PLAYER_OPTIONS)
    lines = [[int(each) for each in line.split()] for line in toolchain.run(built).splitlines()]
    if [there for _, there in lines] != left:
        raise SystemExit(f"{case.name}: the code of {profile.name} must leave what the Python kernel leaves")
    return built, sum(cclk for cclk, _ in lines)


def calls_of(case: Case) -> tuple[list[tuple[Any, ...]], list[int]]:
    """Return the arguments of the calls of a case, and the checksum of what each leaves."""
    calls, left = [], []

    def run(*arguments: Any) -> Any:
        calls.append(tuple(each.copy() if isinstance(each, np.ndarray) else each for each in arguments))
        result = case.kernel(*arguments)
        left.append(checksum(arguments, result))
        return result

    case.checksum(run)
    return calls, left
