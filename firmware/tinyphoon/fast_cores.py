"""The firmware with its pixel steps by the instructions for several pixels at once: the same features in a third of the time."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import Any

from bfsim.api import Buffer, Core, FrameSize
from tinyphoon.buffers import buffers
from tinyphoon.core_a import core_a
from tinyphoon.core_b import core_b
from tinyphoon.features import PixelSteps
from tinyphoon.stages.fast_opening import fast_opening
from tinyphoon.stages.fast_scan import fast_scan, fast_scan_buffers

FAST = PixelSteps(scan=fast_scan, open_closing=fast_opening)


def fast_core_a(core: Core) -> Generator[Any, Any, None]:
    """Play core A with the fast steps."""
    yield from core_a(core, FAST)


def fast_core_b(core: Core) -> Generator[Any, Any, None]:
    """Play core B with the fast steps."""
    yield from core_b(core, FAST)


def fast_buffers(size: FrameSize) -> Mapping[str, Sequence[Buffer]]:
    """Return the buffers of each core for pictures of `size`."""
    return buffers(size, fast_scan_buffers)
