"""A board with one core and one camera: the left one's picture, without stereo."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.features import features
from firmware.modes import INDOOR_FIELD
from firmware.results import MESSAGE_WORDS, pack_results


def one_core(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the only camera."""
    while (frame := (yield from core.next_frame())) is not None:
        found = yield from features(core, frame, INDOOR_FIELD)
        yield from core.receive(core.array("orders"))  # modes and models: taken, not obeyed yet
        message = core.array("results")
        yield core.run(pack_results, message, frame.index & 0x7FFF, found.edges, 0)
        yield from core.send(message, 2 * MESSAGE_WORDS)
