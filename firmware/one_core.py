"""A board with one core and one camera: the left one's picture, without stereo."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.modes import INDOOR_FIELD
from firmware.results import MESSAGE_WORDS, pack_results
from firmware.stages.edge_detection import edge_detection
from firmware.stages.open_closing import open_closing
from firmware.stages.rectification import rectification


def one_core(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the only camera."""
    while (frame := (yield from core.next_frame())) is not None:
        with core.stage("Edge detection"):
            with core.stage("Rectification"):
                frame = yield from rectification(core, frame)
            found = yield from edge_detection(core, frame, INDOOR_FIELD)
        with core.stage("Open & closing"):
            yield from open_closing(core, frame)
        yield from core.receive(core.array("orders"))  # modes and models: taken, not obeyed yet
        message = core.array("results")
        yield core.run(pack_results, message, frame.index & 0x7FFF, found, 0)
        yield from core.send(message, 2 * MESSAGE_WORDS)
