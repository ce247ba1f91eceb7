"""A board with one core and one camera: the picture of the left one, without stereo."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from tinyphoon.features import features
from tinyphoon.stages.object_detection import left_sight, remember
from tinyphoon.stages.object_history import follow_area
from tinyphoon.strategy.orders import Orders, halvings_of, read_mode, see_by
from tinyphoon.strategy.report import report


def one_core(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the only camera."""
    orders = Orders(core)
    yield from orders.take()
    while (frame := (yield from core.next_frame())) is not None:
        mode = yield from read_mode(core)
        area = yield from see_by(core, frame, mode)
        found = yield from features(core, frame, mode, area)
        with core.stage("Object detection"):
            yield from left_sight(core, found.frame, found.outlines, mode.objects)
            yield from follow_area(core, area, halvings_of(core, frame))
            yield from remember(core, [core.array("left_seen")], mode.objects)
        yield from orders.take()
        yield from report(core, frame, area, orders.close())
