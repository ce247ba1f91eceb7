"""Core B: the right camera."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.features import features
from firmware.orders import read_orders, see_by
from firmware.results import store_word


def core_b(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the right camera. The cores end a frame together, to take the same next pair."""
    while (frame := (yield from core.next_frame())) is not None:
        orders = yield from read_orders(core)
        area = see_by(core, frame, orders.mode)
        found = yield from features(core, frame, area, orders.mode)
        yield core.run(store_word, core.array("right_edges"), found)
        yield from core.post("core B is done")
        yield from core.wait("core A is done")
