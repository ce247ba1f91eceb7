"""Core A: the left camera, and the results of both."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.features import features
from firmware.orders import read_orders, see_by, take_orders
from firmware.results import MESSAGE_WORDS, load_word, pack_results


def core_a(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the left camera. The cores end a frame together, to take the same next pair."""
    while (frame := (yield from core.next_frame())) is not None:
        orders = yield from read_orders(core)
        area = see_by(core, frame, orders.mode)
        found = yield from features(core, frame, area, orders.mode)
        refused = yield from take_orders(core)  # for the next frame; core B reads them when core A is done
        yield from core.post("core A is done")
        yield from core.wait("core B is done")
        others = yield core.run(load_word, core.array("right_edges"))
        message = core.array("results")
        yield core.run(pack_results, message, frame.index & 0x7FFF, found, others, refused)
        yield from core.send(message, 2 * MESSAGE_WORDS)
