"""The circles that the firmware sees in recorded or rendered frames, and what they cost, on a simulated board."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping, Sequence
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
from firmware import ROWS
from firmware.buffers import buffers
from firmware.features import features
from firmware.stores.circles import CIRCLE_WORDS
from firmware.strategy.modes import Mode

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
    shots = list(frames)
    height, double_width = shots[0].left.shape
    size = FrameSize(double_width // 2, height)
    found: dict[str, list[NDArray[np.int16]]] = {core: [] for core in SIDES}

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            yield from features(core, frame, mode)
            found[core.name].append(core.array("circles").array.reshape(-1, CIRCLE_WORDS).copy())

    rows: Sequence[BudgetRow] = ROWS
    firmware = Firmware(mains=dict.fromkeys(SIDES, main), buffers=_own_buffers, camera="camera", rows=rows)
    link_map = link(parse_ldf(THESIS_LDF), symbols_of(firmware, size), CM_BF561.chip.regions)
    outcome = Board(CM_BF561, firmware, size, link_map).run(iter(shots))
    cclk_per_ms = CM_BF561.clocks.cclk_hz / 1000
    seen = []
    for shot, record, *both in zip(shots, outcome.frames, found["A"], found["B"], strict=True):
        for core, words in zip(record.cores, both, strict=True):
            ending = f"_{core.core}"
            results = {
                name.removesuffix(ending): value
                for name, value in record.results.items()
                if name.endswith(ending)
            }
            times = {each.stage: float(each.elapsed_cclk / cclk_per_ms) for each in core.stages}
            seen.append(Seen(shot, SIDES[core.core], words[: results["circles"]], results, times))
    return seen


def _own_buffers(size: FrameSize) -> Mapping[str, Sequence[Buffer]]:
    """The firmware's buffers without what the cores share."""
    return {core: each for core, each in buffers(size).items() if core != "shared"}
