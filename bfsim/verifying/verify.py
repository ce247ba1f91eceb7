"""Compare what a run estimates with what the real compiler's code takes, on a sample of its calls."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from bfsim.compiling import ObjectCode, Toolchain
from bfsim.kernel import CompilerProfile, Kernel
from bfsim.verified import Verification, VerifiedKernel
from bfsim.verifying.player import PLAYER_OPTIONS, checksum, write_player
from bfsim.verifying.sample import Argument, Sample, Sampler


def verify(
    sampler: Sampler, frames: int, profile: CompilerProfile, code: ObjectCode, toolchain: Toolchain
) -> Verification:
    """Play the calls that `sampler` kept of a run of `frames`, by the kernels here and by their object code under the simulator.

    Raises ConfigError for what the compiler refuses.
    """
    kernels = list(sampler.of)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "kernels.o").write_bytes(code.octets)
        functions = [each.function for each in kernels]
        source = write_player(folder, code.header, functions, code.names, _calls(kernels, sampler))
        built = toolchain.build(folder, ["kernels.o", source], PLAYER_OPTIONS)
        lines = iter(toolchain.run(built).splitlines())
    found = [_compared(each, sampler.of[each], frames, profile, lines) for each in kernels]
    found.sort(key=lambda each: -each.measured_cclk)
    return Verification(profile.name, code.compiler, frames, tuple(found))


def _calls(kernels: Sequence[Kernel], sampler: Sampler) -> Iterator[tuple[int, tuple[Argument, ...]]]:
    for number, kernel in enumerate(kernels):
        for arguments in sampler.of[kernel].kept:
            yield number, arguments


def _compared(
    kernel: Kernel, sample: Sample, frames: int, profile: CompilerProfile, lines: Iterator[str]
) -> VerifiedKernel:
    """Make the same calls here; `lines` are what the program told of its own, one for each call."""
    estimated = measured = different = 0
    code = kernel.compile(profile)
    for arguments in sample.kept:
        cclk, there = map(int, next(lines).split())
        copies = [each.copy() if isinstance(each, np.ndarray) else each for each in arguments]
        arrays = [each for each in copies if isinstance(each, np.ndarray)]
        work = kernel.prepare(code, arrays, code.new_totals()).run(copies)
        estimated += work.issue_cclk
        measured += cclk
        different += checksum(copies, work.value) != there
    weight = sample.seen / frames / len(sample.kept)
    return VerifiedKernel(
        kernel=kernel.name,
        file=kernel.function.file,
        first_line=kernel.function.first_line,
        calls=sample.seen / frames,
        played=len(sample.kept),
        estimated_cclk=weight * estimated,
        measured_cclk=weight * measured,
        different=different,
    )
