"""Calls played once more: by the GNU simulator, and by the code's own translation. Each leaves its cycles and a checksum."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bfsim.compiling.loaded_code import LoadedCode
from bfsim.compiling.object_code import ObjectCode
from bfsim.compiling.toolchain import Toolchain
from bfsim.kernel import Kernel
from bfsim.kernel.objects.calls import ObjectCall
from bfsim.verifying.player import PLAYER_OPTIONS, checksum, entries_of, write_player
from bfsim.verifying.sample import Argument, Sampler


class Played(NamedTuple):
    """One call: the cycles that it took, and the checksum of what it left (see `player`)."""

    cclk: int
    checksum: int


Calls = Mapping[Kernel, Sequence[Played]]
"""The calls of each kernel, in the order of its sample."""


def simulated(sampler: Sampler, code: ObjectCode, toolchain: Toolchain) -> Calls:
    """Play the calls of a sample under the simulator of `toolchain`. Raises ConfigError for what the compiler refuses."""
    kernels = list(sampler.of)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "kernels.o").write_bytes(code.octets)
        functions = [each.function for each in kernels]
        entries = entries_of([code.names[each] for each in functions])
        sources = write_player(folder, functions, entries, _numbered(kernels, sampler))
        built = toolchain.build(folder, ["kernels.o", *sources], PLAYER_OPTIONS)
        lines = iter(toolchain.run(built).splitlines())
    return {
        kernel: [Played(*map(int, next(lines).split())) for _ in sampler.of[kernel].kept]
        for kernel in kernels
    }


def translated(sampler: Sampler, code: ObjectCode) -> Calls:
    """Play the calls of a sample by the translation of their code."""
    loaded = LoadedCode(code)
    return {
        kernel: [_translated(kernel, arguments, loaded) for arguments in sample.kept]
        for kernel, sample in sampler.of.items()
    }


def _translated(kernel: Kernel, arguments: Sequence[Argument], loaded: LoadedCode) -> Played:
    found = loaded.compiled(kernel.function)
    copies = copied(arguments)
    arrays = [each for each in copies if isinstance(each, np.ndarray)]
    work = ObjectCall(found, arrays, kernel.arguments.check, found.new_totals()).run(*copies)
    return Played(work.issue_cclk, checksum(copies, work.value))


def copied(arguments: Sequence[Argument]) -> list[Argument]:
    """Return arguments whose arrays may be written."""
    return [each.copy() if isinstance(each, np.ndarray) else each for each in arguments]


def _numbered(kernels: Sequence[Kernel], sampler: Sampler) -> Iterator[tuple[int, tuple[Argument, ...]]]:
    for number, kernel in enumerate(kernels):
        for arguments in sampler.of[kernel].kept:
            yield number, arguments
