"""From a picture to features: the stages that every core plays on the picture of its own camera."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame
from firmware.modes import Mode
from firmware.stages.blob_detection import blob_detection
from firmware.stages.circle_detection import circle_detection
from firmware.stages.edge_detection import edge_detection
from firmware.stages.line_detection import line_detection
from firmware.stages.open_closing import open_closing
from firmware.stages.rectification import rectification


def features(core: Core, frame: Frame, mode: Mode) -> Generator[Any, Any, int]:
    """Leave edges, colours, blobs, lines and circles of a picture in the core's memories; returns how many edges are stored."""
    with core.stage("Edge detection"):
        with core.stage("Rectification"):
            frame = yield from rectification(core, frame)
        found = yield from edge_detection(core, frame, mode.edges)
    with core.stage("Open & closing"):
        yield from open_closing(core, frame)
    with core.stage("Blob detection"):
        blobs = yield from blob_detection(core, frame, mode.blobs)
    with core.stage("Line detection"):
        yield from line_detection(core, frame, mode.lines)
    with core.stage("Shape detection"):
        yield from circle_detection(core, frame, blobs, mode.ball_colours, mode.circles)
    return found
