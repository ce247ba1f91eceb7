"""Core B: the right camera."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.modes import INDOOR_FIELD
from firmware.results import store_word
from firmware.stages.edge_detection import edge_detection
from firmware.stages.open_closing import open_closing
from firmware.stages.rectification import rectification


def core_b(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the right camera. The cores end a frame together, to take the same next pair."""
    while (frame := (yield from core.next_frame())) is not None:
        with core.stage("Edge detection"):
            with core.stage("Rectification"):
                frame = yield from rectification(core, frame)
            found = yield from edge_detection(core, frame, INDOOR_FIELD)
        with core.stage("Open & closing"):
            yield from open_closing(core, frame)
        yield core.run(store_word, core.array("right_edges"), found)
        yield from core.post("core B is done")
        yield from core.wait("core A is done")
