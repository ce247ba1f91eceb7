"""Compare what a run estimates with what the real compiler's code takes, on a sample of its calls."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from bfsim.errors import ConfigError
from bfsim.kernel import CompilerProfile, Kernel
from bfsim.kernel.c import c_program
from bfsim.verified import Verification, VerifiedKernel
from bfsim.verifying.player import checksum, played, player
from bfsim.verifying.sample import Argument, Sample, Sampler
from bfsim.verifying.toolchain import Toolchain

OPTIONS = {"gcc-O2": ("-O2",), "gcc-O0": ("-O0",)}
"""What the compiler is told, for each profile that stands for it."""


def require_compiler(profile: CompilerProfile) -> None:
    """Raise ConfigError unless a profile stands for a compiler that can be asked."""
    if profile.name not in OPTIONS:
        raise ConfigError(
            f"the profile must be {' or '.join(OPTIONS)} to be verified, not {profile.name}: of other compilers there is no code"
        )


def verify(sampler: Sampler, frames: int, profile: CompilerProfile, toolchain: Toolchain) -> Verification:
    """Play the calls that `sampler` kept of a run of `frames`, by the kernels here and by what the compiler makes of their C.

    Raises ConfigError for a profile that stands for no compiler that can be asked, for a run without kernels, and for what the
    compiler refuses.
    """
    require_compiler(profile)
    kernels = list(sampler.of)
    if not kernels:
        raise ConfigError("the run must call a kernel to be verified, but calls none")
    program = c_program([each.function for each in kernels], entries=[each.function for each in kernels])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in program.files.items():
            (folder / file).write_text(text, encoding="utf-8")
        (folder / "player.c").write_text(
            player([each.function for each in kernels], program.names), encoding="utf-8"
        )
        with (folder / "calls.bin").open("wb") as stream:
            stream.writelines(played(_calls(kernels, sampler)))
        built = toolchain.build(
            folder, [*program.sources, "player.c"], ("-std=gnu99", "-w", *OPTIONS[profile.name])
        )
        lines = iter(toolchain.run(built).splitlines())
    found = [_compared(each, sampler.of[each], frames, profile, lines) for each in kernels]
    found.sort(key=lambda each: -each.measured_cclk)
    return Verification(profile.name, toolchain.version, frames, tuple(found))


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
