"""Arguments of real calls: the built-in firmware plays the built-in recording, and a sample of its calls is kept.

Each core's calls are sampled as `bfsim verify` samples those of a run (`bfsim/verifying/sample.py`), so that the sample is spread
evenly over both cores, all frames and all rows. It is the same everywhere: the firmware is played without time
(`benchmarks/bare.py`), and its pixels do not depend on any.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from benchmarks.bare import BareCore, run_bare
from bfsim.api import Kernel
from bfsim.recording import RecordingReader
from bfsim.running.inputs import calibration_of
from bfsim.shipped import RECORDING
from bfsim.verifying import Sampler
from bfsim.verifying.sample import Argument, Sample
from tinyphoon import tinyphoon

SAMPLES = 32  # of a kernel on a core, at most


@dataclass(frozen=True, slots=True)
class Calls:
    """Calls of one kernel by both cores: how many a stereo frame has on average, and the arguments of some."""

    per_frame: float
    arguments: tuple[tuple[Argument, ...], ...]


@cache
def recorded() -> Mapping[Kernel, Calls]:
    """Play the recording; return the calls of every kernel that a core ran."""
    with RecordingReader(RECORDING) as reader:
        frames = list(reader.frames())
        firmware = tinyphoon.calibrated(calibration_of(reader))
    samplers: dict[str, Sampler] = {}

    class RecordingCore(BareCore):
        counted = True  # the build that `bfsim run` has in the cache already

        def run(self, kernel: Kernel, *arguments: Any) -> Any:
            samplers.setdefault(self.name, Sampler(SAMPLES)).see(kernel, arguments)
            return super().run(kernel, *arguments)

    run_bare(firmware, frames, RecordingCore)
    cores = [samplers[core].of for core in sorted(samplers)]
    return {
        kernel: _of_both(kernel, cores, len(frames))
        for kernel in dict.fromkeys(each for of in cores for each in of)
    }


def _of_both(kernel: Kernel, cores: Sequence[Mapping[Kernel, Sample]], frames: int) -> Calls:
    samples = [each[kernel] for each in cores if kernel in each]
    arguments = tuple(each for sample in samples for each in sample.kept)
    return Calls(sum(each.seen for each in samples) / frames, arguments)


def copied(arguments: tuple[Argument, ...]) -> tuple[Argument, ...]:
    """Return arguments that a call may write to."""
    return tuple(each.copy() if isinstance(each, np.ndarray) else each for each in arguments)
