"""Core A: the left camera, and the results of both."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.features import features
from firmware.modes import INDOOR_FIELD
from firmware.report import report
from firmware.stages.object_detection import left_sight, object_detection
from firmware.stages.stereo_edges import stereo_edges
from firmware.stages.stereo_lines import stereo_lines


def core_a(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the left camera, and depth where core B's right one shows the same.

    Core B writes its results again only when core A is done with them: the cores take the same next pair.
    """
    mode = INDOOR_FIELD
    while (frame := (yield from core.next_frame())) is not None:
        found = yield from features(core, frame, mode)
        with core.stage("Object detection"):
            yield from left_sight(core, frame, found.outlines, mode.objects)
        yield from core.wait("core B is done")
        with core.stage("Line detection"):
            yield from stereo_lines(core, frame, found.lines, mode.stereo_lines)
            yield from stereo_edges(core, frame, mode.stereo_edges)
        with core.stage("Object detection"):
            yield from object_detection(core, mode.objects)
        yield from core.post("core A is done")
        yield from core.receive(core.array("orders"))  # modes and models: taken, not obeyed yet
        yield from report(core, frame)
