"""A board with one core and one camera: the left one's picture, without stereo."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.features import features
from firmware.orders import read_orders, see_by, take_orders
from firmware.results import MESSAGE_WORDS, pack_results


def one_core(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the only camera."""
    while (frame := (yield from core.next_frame())) is not None:
        orders = yield from read_orders(core)
        area = see_by(core, frame, orders.mode)
        found = yield from features(core, frame, area, orders.mode)
        refused = yield from take_orders(core)
        message = core.array("results")
        yield core.run(pack_results, message, frame.index & 0x7FFF, found, 0, refused)
        yield from core.send(message, 2 * MESSAGE_WORDS)
