"""Core B: the right camera."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from tinyphoon.exchange import share_edges, share_lines
from tinyphoon.features import PLAIN, Steps, features
from tinyphoon.stages.object_detection import right_sight
from tinyphoon.strategy.orders import read_mode, see_by


def core_b(core: Core, steps: Steps = PLAIN) -> Generator[Any, Any, None]:
    """See every picture of the right camera. The cores end a frame together, to take the same next pair.

    Core A is also done with orders before the first frame.
    """
    yield from core.wait("core A is done")
    while (frame := (yield from core.next_frame())) is not None:
        mode = yield from read_mode(core)
        area = yield from see_by(core, frame, mode)
        found = yield from features(core, frame, mode, area, steps)
        with core.stage("Object detection"):
            yield from right_sight(core, found.frame, found.outlines, mode.objects)
        yield from share_lines(core, found.lines)
        yield from share_edges(core, found.edges)
        yield from core.post("core B is done")
        yield from core.wait("core A is done")
