"""Arguments of real calls: a sample of those that a run makes of each kernel.

For each kernel, the calls number 0, s, 2s, ... of the whole run are kept, where s is the least power of two that leaves
at most as many as are wanted. So a sample is spread evenly over the run, and the same run gives the same sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from bfsim.kernel import Kernel
from bfsim.machine.memories import Row

Argument = NDArray[Any] | int | float


@dataclass(slots=True)
class Sample:
    """Calls of one kernel. `seen`: how many there were; `kept`: the arguments of every `stride`th."""

    seen: int = 0
    stride: int = 1
    kept: list[tuple[Argument, ...]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Sampler:
    """Keeps the arguments of at most `most` calls of each kernel, as they are before the call."""

    most: int
    of: dict[Kernel, Sample] = field(default_factory=dict)

    def see(self, kernel: Kernel, arguments: Sequence[Row | int]) -> None:
        """Note a call. Code for the Blackfin, as from `kernel_from`, has no estimate to judge."""
        if kernel.object_code is not None:
            return
        sample = self.of.setdefault(kernel, Sample())
        if sample.seen % sample.stride == 0:
            if len(sample.kept) == self.most:
                sample.kept, sample.stride = sample.kept[::2], 2 * sample.stride
            if sample.seen % sample.stride == 0:
                sample.kept.append(_copied(kernel, arguments))
        sample.seen += 1


def _copied(kernel: Kernel, arguments: Sequence[Row | int]) -> tuple[Argument, ...]:
    floats = kernel.arguments.float_positions
    return tuple(
        each.array.copy() if isinstance(each, Row) else float(each) if number in floats else each
        for number, each in enumerate(arguments)
    )
