"""The end of a frame: the message of its results is made and sent."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame
from tinyphoon.areas import WHOLE_PICTURE, Area
from tinyphoon.strategy.results import close_message, pack_goal_lines, pack_objects

SEQUENCE_MASK = 0x7FFF


def report(
    core: Core, frame: Frame, area: Area = WHOLE_PICTURE, refusal: int = 0
) -> Generator[Any, Any, None]:
    """Send the object history and the lines of the goals in the left picture to the strategy unit.

    `refusal`: why an order was refused, or 0.
    """
    message, seen = core.array("results"), core.array("left_seen")
    words = yield core.run(pack_objects, message, core.array("objects"))
    outlines = core.array("rectangles"), core.array("lines")
    words = yield core.run(pack_goal_lines, message, words, seen, core.array("models"), *outlines)
    known = frame.index & SEQUENCE_MASK, frame.index, refusal, area.x, area.y
    nbytes = yield core.run(close_message, message, *known, words)
    yield from core.send(message, nbytes)
