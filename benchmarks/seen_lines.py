"""The lines that the firmware sees in pictures: its edge and its line detection on a simulated board."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.api import BudgetRow, Buffer, Core, Firmware, FrameSize
from bfsim.chip.boards import CM_BF561
from bfsim.linker import link, parse_ldf
from bfsim.machine.board import Board, symbols_of
from bfsim.recording import StereoFrame
from bfsim.run import THESIS_LDF
from firmware.buffers import buffers
from firmware.line_store import LINE_WORDS, LINE_X0, LINE_Y1, SUBPIXELS
from firmware.modes import INDOOR_FIELD
from firmware.stages.edge_detection import edge_detection
from firmware.stages.line_detection import line_detection

STAGES = ("Edge detection", "Line detection")

Picture = NDArray[np.uint8]
"""Grey, `height` x `width`."""

Lines = NDArray[np.float64]
"""Rows of x0, y0, x1, y1 in pixels."""


@dataclass(frozen=True, slots=True)
class Seen:
    """The lines of a picture, the numbers that the stages published, and the cycles of each stage."""

    lines: Lines
    results: Mapping[str, int]
    stages_cclk: Mapping[str, int]


def see(pictures: Sequence[Picture]) -> list[Seen]:
    """Return what the firmware finds in each of `pictures`, which have one size."""
    height, width = pictures[0].shape
    size = FrameSize(width, height)
    found: dict[str, list[Lines]] = {"A": [], "B": []}

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            with core.stage("Edge detection"):
                yield from edge_detection(core, frame, INDOOR_FIELD.edges)
            with core.stage("Line detection"):
                count = yield from line_detection(core, frame, INDOOR_FIELD.lines)
            records = core.array("lines").array[: count * LINE_WORDS].reshape(count, LINE_WORDS)
            found[core.name].append(records[:, LINE_X0 : LINE_Y1 + 1] / SUBPIXELS)

    rows = tuple(BudgetRow(stage=name, thesis_ms=None) for name in STAGES)
    firmware = Firmware(mains={"A": main, "B": main}, buffers=_own_buffers, camera="camera", rows=rows)
    link_map = link(parse_ldf(THESIS_LDF), symbols_of(firmware, size), CM_BF561.chip.regions)
    outcome = Board(CM_BF561, firmware, size, link_map).run(_frames(pictures))
    seen = []
    for frame, *both in zip(outcome.frames, found["A"], found["B"], strict=True):
        for core, lines in zip(frame.cores, both, strict=True):
            ending = f"_{core.core}"
            own = {
                name.removesuffix(ending): value
                for name, value in frame.results.items()
                if name.endswith(ending)
            }
            seen.append(Seen(lines, own, {each.stage: each.elapsed_cclk for each in core.stages}))
    return seen[: len(pictures)]


def _own_buffers(size: FrameSize) -> Mapping[str, Sequence[Buffer]]:
    """The firmware's buffers without what the cores share."""
    return {core: each for core, each in buffers(size).items() if core != "shared"}


def _frames(pictures: Sequence[Picture]) -> Iterator[StereoFrame]:
    """Two pictures a frame, one for each core; of an odd number the last comes twice."""
    for index in range(0, len(pictures), 2):
        left, right = uyvy(pictures[index]), uyvy(pictures[min(index + 1, len(pictures) - 1)])
        yield StereoFrame(index // 2, left, right, left_ns=index, right_ns=index, truth=None)


def uyvy(picture: Picture) -> Picture:
    """Return a grey picture as bytes U Y V Y."""
    height, width = picture.shape
    result = np.full((height, 2 * width), 128, np.uint8)
    result[:, 1::2] = picture
    return result
