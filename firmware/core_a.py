"""Core A: the left camera, and the results of both."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core
from firmware.exchange import shared_count
from firmware.features import features
from firmware.modes import INDOOR_FIELD
from firmware.results import MESSAGE_WORDS, pack_results
from firmware.stages.stereo_edges import stereo_edges
from firmware.stages.stereo_lines import stereo_lines


def core_a(core: Core) -> Generator[Any, Any, None]:
    """See every picture of the left camera, and depth where core B's right one shows the same.

    Core B writes its results again only when core A is done with them: the cores take the same next pair.
    """
    while (frame := (yield from core.next_frame())) is not None:
        found = yield from features(core, frame, INDOOR_FIELD)
        yield from core.wait("core B is done")
        others = yield from shared_count(core, "right_edges")
        with core.stage("Line detection"):
            yield from stereo_lines(core, frame, found.lines, INDOOR_FIELD.stereo_lines)
            yield from stereo_edges(core, frame, INDOOR_FIELD.stereo_edges)
        yield from core.post("core A is done")
        yield from core.receive(core.array("orders"))  # modes and models: taken, not obeyed yet
        message = core.array("results")
        yield core.run(pack_results, message, frame.index & 0x7FFF, found.edges, others)
        yield from core.send(message, 2 * MESSAGE_WORDS)
