"""3-D edges: edges of the left picture that an edge of the right one corresponds to, for obstacles of any kind (T §5.2.8).

The corresponding edge lies in the same row; of those with nearly the same gradient direction and a disparity within
limits the nearest is taken, the one with the least disparity.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, i16, i32, kernel, u16, u32
from firmware.geometry import store_point
from firmware.line3d_store import EDGE3D_CAPACITY, EDGE3D_LEFT, EDGE3D_WORDS, EDGE3D_X
from firmware.line_store import SUBPIXELS
from firmware.stages.line_segments import turn_between


@dataclass(frozen=True, slots=True, kw_only=True)
class StereoEdgeThresholds:
    """What makes two edges correspond.

    `direction_range`: how far their gradient directions may differ, in 1/256 of a turn. `min_disparity`,
    `max_disparity`: in pixels, 1 and more.
    """

    direction_range: int
    min_disparity: int
    max_disparity: int

    def __post_init__(self) -> None:
        if not 1 <= self.min_disparity <= self.max_disparity:
            raise ValueError(
                f"disparities must be 1 or more and rise, not {self.min_disparity} to {self.max_disparity}"
            )


def stereo_edge_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage on core A: in L1 if there is room, else in L2."""
    return (Buffer("edges_3d", i16, EDGE3D_WORDS * EDGE3D_CAPACITY, "data1"),)


@kernel
def take_row(right_edges: u32[:], right_rows: u32[:], y: i32, row: u32[:]) -> i32:
    """Copy the edges of row `y` of the right picture to `row`, and return how many they are."""
    first = i32(right_rows[y] & 0xFFFF)
    count = i32(right_rows[y] >> 16)
    for edge in range(count):
        row[edge] = right_edges[first + edge]
    return count


@kernel
def stereo_edges_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    row: u32[:],
    count: i32,
    geometry: i32[:],
    direction_range: i32,
    min_disparity: i32,
    max_disparity: i32,
    width: i32,
    height: i32,
    edges_3d: i16[:],
    found: i32,
) -> i32:
    """Store the 3-D edges of row `y`, where the right picture has the `count` edges in `row`.

    `found` is how many the rows before gave; returns it with this row. Those beyond the length of `edges_3d` are counted,
    not stored.
    """
    nearest = 0  # how many right edges are not too near for the left edge, which moves to the right
    first = i32(edge_index[y])
    for edge in range(first, first + edge_counts[y]):
        x = i32(edge_data[edge] >> 16)
        direction = i32(edge_data[edge] >> 8 & 255)
        while nearest < count and i32(row[nearest] >> 16) <= x - min_disparity:
            nearest = nearest + 1
        other = nearest - 1
        while other >= 0 and i32(row[other] >> 16) >= x - max_disparity:
            if abs(turn_between(i32(row[other] >> 8 & 255), direction)) <= direction_range:
                disparity = x - i32(row[other] >> 16)
                if EDGE3D_WORDS * found >= len(edges_3d):
                    found = found + 1
                elif (
                    store_point(
                        geometry,
                        SUBPIXELS * x,
                        SUBPIXELS * y,
                        SUBPIXELS * disparity,
                        width,
                        height,
                        edges_3d,
                        EDGE3D_WORDS * found + EDGE3D_X,
                    )
                    != 0
                ):
                    edges_3d[EDGE3D_WORDS * found + EDGE3D_LEFT] = edge
                    found = found + 1
                break
            other = other - 1
    return found


def stereo_edges(core: Core, frame: Frame, thresholds: StereoEdgeThresholds) -> Generator[Any, Any, int]:
    """Find the 3-D edges of the edge store and the one that core B shares. Returns how many are in `edges_3d`.

    Core B must have posted that its edges are there. Publishes `edges_3d`, that number, and `edges_3d_lost`, how many
    found no room.
    """
    store = core.array("edge_data"), core.array("edge_index"), core.array("edge_counts")
    right = core.array("right_edge_data"), core.array("right_edge_rows")
    row = core.overlay("segments", u32, frame.width)[0]
    edges_3d = core.array("edges_3d")
    limits = thresholds.direction_range, thresholds.min_disparity, thresholds.max_disparity
    size = frame.width, frame.height
    found = 0
    for y in range(frame.height - 1, -1, -1):
        count = yield core.run(take_row, *right, y, row)
        found = yield core.run(
            stereo_edges_row, *store, y, row, count, core.array("geometry"), *limits, *size, edges_3d, found
        )
    kept = min(found, EDGE3D_CAPACITY)
    core.publish(edges_3d=kept, edges_3d_lost=found - kept)
    return kept
