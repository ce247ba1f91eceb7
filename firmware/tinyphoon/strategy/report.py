"""The end of a frame: the message with its results is made and sent."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

from bfsim.api import Core, Frame
from tinyphoon.areas import WHOLE_PICTURE, Area
from tinyphoon.strategy.depth_report import ReportLimits, pack_edges_3d, pack_lines_3d
from tinyphoon.strategy.results import close_message, pack_border_lines, pack_objects

SEQUENCE_MASK = 0x7FFF


@dataclass(frozen=True, slots=True, kw_only=True)
class Depth:
    """How many 3-D lines and 3-D edges are stored, and how many of them may be sent."""

    lines_3d: int
    edges_3d: int
    limits: ReportLimits


def report(
    core: Core,
    frame: Frame,
    area: Area = WHOLE_PICTURE,
    refusal: int = 0,
    depth: Depth | None = None,
) -> Generator[Any, Any, None]:
    """Send the object history, the border lines of rectangles in the left picture, and everything with depth.

    `refusal`: why an order was refused, or 0. A board with one camera has no `depth`.
    """
    message, seen = core.array("results"), core.array("left_seen")
    words = yield core.run(pack_objects, message, core.array("objects"))
    outlines = core.array("rectangles"), core.array("lines")
    words = yield core.run(pack_border_lines, message, words, seen, core.array("models"), *outlines)
    if depth is not None:
        lines_3d, edges_3d = core.array("lines_3d"), core.array("edges_3d")
        most = depth.limits
        words = yield core.run(pack_lines_3d, message, words, lines_3d, depth.lines_3d, most.lines_3d)
        words = yield core.run(pack_edges_3d, message, words, edges_3d, depth.edges_3d, most.edges_3d)
    known = frame.index & SEQUENCE_MASK, frame.index, refusal, area.x, area.y
    nbytes = yield core.run(close_message, message, *known, words)
    yield from core.send(message, nbytes)
