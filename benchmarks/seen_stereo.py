"""The 3-D lines that the firmware sees in stereo frames: its edge, line and stereo stages on a simulated board.

The 3-D edges are found too, for they vote on the lines.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.playing import play
from bfsim.api import BudgetRow, Calibration, Core, Firmware, Frame, Readout
from bfsim.recording import StereoFrame
from tinyphoon.buffers import buffers, calibration_buffers
from tinyphoon.exchange import share_edges, share_lines
from tinyphoon.stages.edge_detection import edge_detection
from tinyphoon.stages.line_detection import line_detection
from tinyphoon.stages.line_refinement import line_refinement
from tinyphoon.stages.rectification import rectification
from tinyphoon.stages.stereo_edges import stereo_edges
from tinyphoon.stages.stereo_lines import stereo_lines
from tinyphoon.stores.lines3d import LINE3D_WORDS, LINE3D_X0, LINE3D_Z1
from tinyphoon.strategy.modes import Mode

STAGES = ("Edge detection", "Line detection", "3-D lines", "3-D edges")


@dataclass(frozen=True, slots=True)
class SeenStereo:
    """The 3-D lines of a frame, start and end in mm (count, 2, 3), and the cycles of core A's stages."""

    lines_mm: NDArray[np.float64]
    stages_cclk: Mapping[str, int]


def see_stereo(
    frames: Sequence[StereoFrame],
    calibration: Calibration,
    mode: Mode,
) -> list[SeenStereo]:
    """Return what the firmware finds in each of `frames`."""

    def features(core: Core, frame: Frame) -> Generator[Any, Any, tuple[int, int]]:
        with core.stage("Edge detection"):
            frame = yield from rectification(core, frame)
            edges = yield from edge_detection(core, frame, mode.edges)
        with core.stage("Line detection"):
            count: int = yield from line_detection(core, frame, mode.lines)
            yield from line_refinement(core, frame, count, mode.refinement)
        return edges, count

    def core_a(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            _, lines = yield from features(core, frame)
            yield from core.wait("core B is done")
            with core.stage("3-D lines"):
                vote = yield from stereo_lines(core, frame, lines, mode.stereo_lines)
            with core.stage("3-D edges"):
                yield from stereo_edges(core, frame, mode.stereo_edges, vote)
            with core.stage("3-D lines"):
                yield from vote.close()
            yield from core.post("core A is done")

    def core_b(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            edges, lines = yield from features(core, frame)
            yield from share_lines(core, lines)
            yield from share_edges(core, edges)
            yield from core.post("core B is done")
            yield from core.wait("core A is done")

    firmware = Firmware(
        mains={"A": core_a, "B": core_b},
        buffers=buffers,
        camera="camera",
        rows=tuple(BudgetRow(stage=name) for name in STAGES),
        calibration=calibration_buffers,
    ).calibrated(calibration)
    played = play(frames, firmware, _lines_mm)
    return [SeenStereo(each.taken["A"], each.stages_cclk("A")) for each in played]


def _lines_mm(readout: Readout) -> NDArray[np.float64]:
    """The 3-D lines of core A; core B publishes none."""
    if readout.core != "A":
        return np.empty((0, 2, 3))
    records = readout.records("lines_3d", LINE3D_WORDS, readout.published("lines_3d"))
    return records[:, LINE3D_X0 : LINE3D_Z1 + 1].reshape(-1, 2, 3).astype(float)
