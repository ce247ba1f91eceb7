"""The circles that the firmware sees in recorded or rendered frames, and what they cost, on a simulated board."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.playing import play
from bfsim.api import Buffer, Core, Firmware, FrameSize, Readout
from bfsim.chip.boards import CM_BF561
from bfsim.recording import StereoFrame
from tinyphoon import ROWS, TABLE_6_4
from tinyphoon.buffers import buffers
from tinyphoon.features import features
from tinyphoon.stores.circles import CIRCLE_WORDS
from tinyphoon.stores.edges import EDGE_DATA
from tinyphoon.strategy.modes import Mode

SIDES = {"A": "left", "B": "right"}
SHAPE_ROW = "Shape detection"


@dataclass(frozen=True, slots=True)
class Seen:
    """The circles that a core saw in a frame, words of t_Circle by row, its results and the time of its stages."""

    frame: StereoFrame
    side: str
    words: NDArray[np.int16]
    results: Mapping[str, int]
    stages_ms: Mapping[str, float]


def see(frames: Iterable[StereoFrame], mode: Mode) -> list[Seen]:
    """Return what both cores find in frames, which have one size, left before right."""

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            yield from features(core, frame, mode)

    shots = list(frames)
    firmware = Firmware(
        mains=dict.fromkeys(SIDES, main),
        buffers=_own_buffers,
        camera="camera",
        rows=ROWS,
        reference=TABLE_6_4,
    )
    return [
        Seen(shot, SIDES[core], words, frame.results(core), _in_ms(frame.stages_cclk(core)))
        for shot, frame in zip(shots, play(shots, firmware, _circles), strict=True)
        for core, words in frame.taken.items()
    ]


def _circles(readout: Readout) -> NDArray[np.int16]:
    return readout.records("circles", CIRCLE_WORDS, readout.published("circles"))


def _in_ms(stages_cclk: Mapping[str, int]) -> dict[str, float]:
    return {stage: float(1000 * cclk / CM_BF561.clocks.cclk_hz) for stage, cclk in stages_cclk.items()}


def _own_buffers(size: FrameSize) -> Mapping[str, Sequence[Buffer]]:
    """The firmware's buffers without what the cores share, but with the edges of core B, which lie there."""
    every = buffers(size)
    shared = [each for each in every["shared"] if each.name == EDGE_DATA["B"]]
    return {**{core: each for core, each in every.items() if core != "shared"}, "shared": shared}
