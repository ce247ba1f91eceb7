"""Edge stores made by hand, and what the stage of 3-D edges makes of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bfsim.api import FrameSize
from tests.firmware.lines.line_rig import BareCore, size_of
from tests.firmware.stereo.stereo_edge_references import EdgeLimits
from tests.firmware.stereo.stereo_references import Edge, Rig
from tests.firmware.whole_pictures import buffer
from tinyphoon.exchange import copy_words, pack_edge_rows
from tinyphoon.geometry import GEOMETRY_WORDS
from tinyphoon.stages.edge_correspondence import LINK_WORDS
from tinyphoon.stages.line_votes import LineVote
from tinyphoon.stages.stereo_edges import StereoEdgeThresholds, stereo_edges
from tinyphoon.stages.stereo_lines import Correspondence
from tinyphoon.stores.edges import EDGE_DATA
from tinyphoon.stores.lines3d import EDGE3D_WORDS

GARBAGE = 77
Row = Sequence[Edge]
ROBOT = Rig(focal=386 * 16, baseline=30470, width=320, height=240)


def store(rows: Sequence[Row]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """An edge store with rows of edges."""
    data = [gradient | direction << 8 | x << 16 for row in rows for x, direction, gradient in row]
    counts = [len(row) for row in rows]
    index = np.cumsum([0, *counts])[:-1]
    return np.array([*data, GARBAGE], np.uint32), index.astype(np.uint32), np.array(counts, np.uint16)


class StereoCore(BareCore):
    """A core whose buffers are arrays of rows that follow each other."""

    def overlay(self, name: str, element: Any, columns: int) -> list[np.ndarray]:
        """The memory of a buffer as other rows."""
        numbers = np.asarray(self.arrays[name]).reshape(-1).view(element.dtype)
        return [*numbers[: len(numbers) // columns * columns].reshape(-1, columns)]


def found(
    left: Sequence[Row],
    right: Sequence[Row],
    mode: StereoEdgeThresholds,
    rig: Rig = ROBOT,
    room: int = 500,
    links: int = 500,
) -> tuple[list[tuple[int, ...]], int]:
    """What the stage makes of two edge stores, and how many there would be."""
    data, index, counts = store(right)
    shared = np.full_like(data, GARBAGE)
    copy_words(data, shared, len(data) - 1)
    rows = np.full(len(right), GARBAGE, np.uint32)
    pack_edge_rows(index, counts, rows)
    rings = {"candidate_ring": 2, "colour_ring": 4, "eroded_ring": 3, "opened_ring": 2}
    stores = zip(("edge_data", "edge_index", "edge_counts"), store(left), strict=True)
    core = StereoCore(
        {
            **{name: np.full((count, rig.width), GARBAGE, np.uint32) for name, count in rings.items()},
            **{name: [each] for name, each in stores},
            "edge_ring": np.full((2, rig.width), GARBAGE, np.uint8),
            "camera_ring": np.full((2, 2 * rig.width), GARBAGE, np.uint8),
            "grey_ring": np.full((3, rig.width), GARBAGE, np.uint8),
            "edge_groups": [np.full(links * LINK_WORDS, GARBAGE, np.uint16)],
            "right_edge_data": [shared],
            "right_edge_rows": [rows],
            "geometry": [np.array([rig.focal, rig.baseline, *[0] * (GEOMETRY_WORDS - 2)], np.int32)],
            "edges_3d": [np.full(room * EDGE3D_WORDS, GARBAGE, np.int16)],
        }
    )
    nobody = LineVote(core, 0, (), (), (), 0)
    core.play(stereo_edges(core, size_of(FrameSize(rig.width, len(left))), mode, nobody))
    number = core.published["edges_3d"] + core.published["edges_3d_lost"]
    kept = core.array("edges_3d").reshape(-1, EDGE3D_WORDS)[: min(number, room)]
    return [tuple(each) for each in kept.tolist()], number


def limits_of(mode: StereoEdgeThresholds) -> EdgeLimits:
    """The limits of the reference."""
    return EdgeLimits(
        is_mutual=mode.correspondence is Correspondence.MUTUAL,
        level_range=mode.level_range,
        direction_range=mode.direction_range,
        nearest_mm=mode.nearest_mm,
        farthest_mm=mode.farthest_mm,
        lack=mode.lack,
        margin=mode.margin,
        follow_range=mode.follow_range,
    )


NEAR = StereoEdgeThresholds(
    correspondence=Correspondence.NEAREST,
    level_range=0,
    direction_range=8,
    # 100 px to 8
    nearest_mm=117,
    farthest_mm=1500,
    lack=32,
    margin=24,
    follow_range=16,
)
LIKE = replace(NEAR, correspondence=Correspondence.MUTUAL, level_range=16)


def rows_of(board, core: str) -> list[Row]:
    """The edge store that a core left."""
    data, index, counts = (
        buffer(board, core, name)[0].tolist() for name in (EDGE_DATA[core], "edge_index", "edge_counts")
    )
    return [
        [(word >> 16, word >> 8 & 255, word & 255) for word in data[first : first + count]]
        for first, count in zip(index, counts, strict=True)
    ]
