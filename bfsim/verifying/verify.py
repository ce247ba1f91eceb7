"""Compare what a run estimates with what the real compiler's code takes, on a sample of its calls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bfsim.compiling.object_code import ObjectCode
from bfsim.compiling.toolchain import Toolchain
from bfsim.kernel import CompilerProfile, Kernel
from bfsim.trace.verification import Verification, VerifiedKernel
from bfsim.verifying.played import Calls, Played, copied, simulated, translated
from bfsim.verifying.player import checksum
from bfsim.verifying.sample import Sample, Sampler


def verify(
    sampler: Sampler, frames: int, profile: CompilerProfile, code: ObjectCode, toolchain: Toolchain | None
) -> Verification:
    """Play the calls that `sampler` kept of a run of `frames` frames, by the kernels here and by their object code.

    The code is played by its translation and, if the `toolchain` has one, under the GNU simulator, whose cycles then
    count. Raises ConfigError for what the compiler refuses.
    """
    ours = translated(sampler, code)
    judged = simulated(sampler, code, toolchain) if toolchain and toolchain.runner else None
    return compared(sampler, frames, profile, code.compiler, ours, judged)


def compared(
    sampler: Sampler, frames: int, profile: CompilerProfile, compiler: str, ours: Calls, judged: Calls | None
) -> Verification:
    """Compare the calls of a sample by the kernels here with those by their code: translated, and under the simulator."""
    found = [
        _compared(each, sampler.of[each], frames, profile, ours[each], judged[each] if judged else None)
        for each in sampler.of
    ]
    found.sort(key=lambda each: -each.measured_cclk)
    return Verification(profile.name, compiler, frames, judged is not None, tuple(found))


def _compared(
    kernel: Kernel,
    sample: Sample,
    frames: int,
    profile: CompilerProfile,
    ours: Sequence[Played],
    judged: Sequence[Played] | None,
) -> VerifiedKernel:
    """Make the same calls here, and compare."""
    compiled = kernel.compile(profile)
    estimated = different = unequal = 0
    truth = judged or ours
    for arguments, translation, real in zip(sample.kept, ours, truth, strict=True):
        copies = copied(arguments)
        arrays = [each for each in copies if isinstance(each, np.ndarray)]
        work = kernel.prepare(compiled, arrays, compiled.new_totals()).run(*copies)
        estimated += work.issue_cclk
        different += {checksum(copies, work.value)} != {translation.checksum, real.checksum}
        unequal += translation.cclk != real.cclk
    weight = sample.seen / frames / len(sample.kept)
    return VerifiedKernel(
        kernel=kernel.name,
        file=kernel.function.file,
        first_line=kernel.function.first_line,
        calls=sample.seen / frames,
        played=len(sample.kept),
        estimated_cclk=weight * estimated,
        measured_cclk=weight * sum(each.cclk for each in truth),
        different=different,
        unequal=unequal,
    )
