"""Arguments of real calls: the built-in firmware plays the built-in recording, and a sample of its calls is kept.

Of each kernel and core the calls number 0, s, 2s, ... of the whole run are kept, where s is the least power of two that
leaves fewer than SAMPLES. So the sample is spread evenly over both cores, all frames and all rows, and is the same
everywhere: the firmware is played without time (`benchmarks/bare.py`), and its pixels do not depend on any.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.bare import BareCore, run_bare
from bfsim.api import Kernel, Row
from bfsim.recording import RecordingReader
from bfsim.run import BUILT_IN_RECORDING
from bfsim.run_inputs import calibration_of
from tinyphoon import tinyphoon

SAMPLES = 32  # of a kernel on a core, at most

Argument = NDArray[Any] | int


@dataclass(slots=True)
class Sample:
    """Calls of one kernel on one core. `seen`: how many there were; `kept`: the arguments of every `stride`th."""

    seen: int = 0
    stride: int = 1
    kept: list[tuple[Argument, ...]] = field(default_factory=list)

    def see(self, arguments: tuple[Row | int, ...]) -> None:
        """Take note of a call before it is made."""
        if self.seen % self.stride == 0:
            self.kept.append(
                tuple(each.array.copy() if isinstance(each, Row) else each for each in arguments)
            )
            if len(self.kept) == SAMPLES:
                self.kept, self.stride = self.kept[::2], 2 * self.stride
        self.seen += 1


@dataclass(frozen=True, slots=True)
class Calls:
    """Calls of one kernel by both cores: how many a stereo frame has on average, and the arguments of some."""

    per_frame: float
    arguments: tuple[tuple[Argument, ...], ...]


@cache
def recorded() -> Mapping[Kernel, Calls]:
    """Play the recording; return the calls of every kernel that a core ran."""
    with RecordingReader(BUILT_IN_RECORDING) as reader:
        frames = list(reader.frames())
        firmware = tinyphoon.calibrated(calibration_of(reader))
    samples: dict[str, dict[Kernel, Sample]] = {}

    class RecordingCore(BareCore):
        counted = True  # the build that `bfsim run` has in the cache already

        def run(self, kernel: Kernel, *arguments: Any) -> Any:
            samples.setdefault(self.name, {}).setdefault(kernel, Sample()).see(arguments)
            return super().run(kernel, *arguments)

    run_bare(firmware, frames, RecordingCore)
    kernels = dict.fromkeys(kernel for of_core in samples.values() for kernel in of_core)
    return {kernel: _of_both(kernel, samples, len(frames)) for kernel in kernels}


def _of_both(kernel: Kernel, samples: Mapping[str, Mapping[Kernel, Sample]], frames: int) -> Calls:
    of_cores = [samples[core][kernel] for core in sorted(samples) if kernel in samples[core]]
    arguments = tuple(each for sample in of_cores for each in sample.kept)
    return Calls(sum(each.seen for each in of_cores) / frames, arguments)


def copied(arguments: tuple[Argument, ...]) -> tuple[Argument, ...]:
    """Return arguments that a call may write to."""
    return tuple(each.copy() if isinstance(each, np.ndarray) else each for each in arguments)
