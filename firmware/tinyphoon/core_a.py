"""Core A: the left camera, and the results of both cores."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from tinyphoon.features import PLAIN, Steps, features
from tinyphoon.stages.object_detection import left_sight, object_detection
from tinyphoon.stages.object_history import follow_area
from tinyphoon.stages.stereo_edges import stereo_edges
from tinyphoon.stages.stereo_lines import stereo_lines
from tinyphoon.strategy.orders import Orders, halvings_of, read_mode, see_by
from tinyphoon.strategy.report import Depth, report


def core_a(core: Core, steps: Steps = PLAIN) -> Generator[Any, Any, None]:
    """See every picture of the left camera, and depth where core B's right one shows the same.

    Core B writes its results again only when core A is done with them: the cores take the same next pair.
    """
    orders = Orders(core)
    yield from orders.take()
    yield from core.post("core A is done")
    while (frame := (yield from core.next_frame())) is not None:
        mode = yield from read_mode(core)
        area = yield from see_by(core, frame, mode)
        found = yield from features(core, frame, mode, area, steps)
        with core.stage("Object detection"):
            yield from left_sight(core, found.frame, found.outlines, mode.objects)
        yield from core.wait("core B is done")
        with core.stage("Line detection"):
            vote = yield from stereo_lines(core, found.frame, found.lines, mode.stereo_lines)
            edges_3d = yield from stereo_edges(core, found.frame, mode.stereo_edges, vote)
            lines_3d = yield from vote.close()
        with core.stage("Object detection"):
            yield from follow_area(core, area, halvings_of(core, frame))
            box_lines = lines_3d if mode.has_boxes else 0
            yield from object_detection(core, found.frame, mode.objects, box_lines)
        yield from orders.take()  # for the next frame; core B reads them when core A is done
        yield from core.post("core A is done")
        depth = Depth(lines_3d=lines_3d, edges_3d=edges_3d, limits=mode.report)
        yield from report(core, frame, area, orders.close(), depth)
