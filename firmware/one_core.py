"""A board with one core and one camera: the left one's picture, without stereo."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.features import features
from firmware.modes import INDOOR_FIELD
from firmware.report import report
from firmware.stages.object_detection import left_sight, remember


def one_core(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the only camera."""
    mode = INDOOR_FIELD
    while (frame := (yield from core.next_frame())) is not None:
        found = yield from features(core, frame, mode)
        with core.stage("Object detection"):
            yield from left_sight(core, frame, found.outlines, mode.objects)
            yield from remember(core, [core.array("left_seen")], mode.objects)
        yield from core.receive(core.array("orders"))  # modes and models: taken, not obeyed yet
        yield from report(core, frame)
