"""3-D edges: edges of the left picture that an edge of the right one corresponds to, for obstacles of any kind (T §5.2.8).

The corresponding edge lies in the same row, has nearly the same gradient direction and a disparity within limits. The plain
way of the thesis takes the nearest, which is the one with the least disparity. The better way, ours, takes the one whose
gradient is most alike, and only if each is the best of the other. Edges whose gradient looks up or down belong to lines
along the row, all of whose edges are alike: with `level_range` they are left out, as T §5.2.7 leaves out such lines.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, i16, i32, kernel, u16, u32
from tinyphoon.fields import allowed
from tinyphoon.geometry import store_point
from tinyphoon.stages.line_segments import NONE, turn_between
from tinyphoon.stages.stereo_lines import Correspondence
from tinyphoon.stores.edges import edge_store
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.lines3d import EDGE3D_CAPACITY, EDGE3D_LEFT, EDGE3D_WORDS, EDGE3D_X

DISPARITY_BITS = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class StereoEdgeThresholds:
    """What makes two edges correspond.

    `correspondence`: how the edge is chosen. `level_range`: how near to straight up or down a gradient is left out, in
    1/256 of a turn; 0 for none. `direction_range`: how far their gradient directions may differ, in 1/256 of a turn. `min_disparity`,
    `max_disparity`: in pixels, 1 and more.
    """

    correspondence: Correspondence
    level_range: int = allowed(0, 64)
    direction_range: int = allowed(0, 64)
    min_disparity: int = allowed(1, 1023, at_most="max_disparity")
    max_disparity: int = allowed(1, 1023)

    def __post_init__(self) -> None:
        if not 1 <= self.min_disparity <= self.max_disparity:
            raise ValueError(
                f"disparities must be 1 or more and rise, not {self.min_disparity} to {self.max_disparity}"
            )


def stereo_edge_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage on core A: in L1 if there is room, else in L2."""
    return (Buffer("edges_3d", i16, EDGE3D_WORDS * EDGE3D_CAPACITY, "data1"),)


@kernel
def is_level(edge: u32, level_range: i32) -> i32:
    """Return 1 for an edge whose gradient looks up or down, to less than `level_range`; else 0."""
    from_up = abs(turn_between(i32(edge >> 8 & 255) << 1 & 255, 128))
    return 1 if from_up < level_range << 1 else 0


@kernel
def take_edges(edges: u32[:], first: i32, count: i32, row: u32[:], level_range: i32) -> i32:
    """Copy `count` edges from place `first` on to `row`, without the level ones, and return how many are left."""
    taken = 0
    for place in range(first, first + count):
        edge = edges[place]
        if is_level(edge, level_range) == 0:
            row[taken] = edge
            taken = taken + 1
    return taken


@kernel
def take_right_row(right_edges: u32[:], right_rows: u32[:], y: i32, row: u32[:], level_range: i32) -> i32:
    """Copy row `y` of the edge store that core B shares, without the level edges; return how many are left."""
    here = right_rows[y]
    return take_edges(right_edges, i32(here & 0xFFFF), i32(here >> 16), row, level_range)


@kernel
def matching_edge(
    edge: u32,
    others: u32[:],
    count: i32,
    side: i32,
    by_likeness: i32,
    direction_range: i32,
    min_disparity: i32,
    max_disparity: i32,
) -> i32:
    """Return the place of the one of `count` other edges that corresponds to an edge, or NONE.

    `side` is 1 for an edge of the left picture and others of the right one, -1 for the reverse. With `by_likeness` 0 it
    is the nearest, with 1 the one with the most similar gradient and of these the nearest.
    """
    x = i32(edge >> 16)
    best = NONE
    least: i32 = 1 << 30
    # the others go to the right: the first ones are those with the greatest disparity, or with the least
    last_disparity = min_disparity if side > 0 else -max_disparity
    for place in range(count):
        other = others[place]
        apart = x - i32(other >> 16)
        if apart < last_disparity:
            break
        disparity = side * apart
        if min_disparity <= disparity <= max_disparity:
            turn = abs(turn_between(i32(other >> 8 & 255), i32(edge >> 8 & 255)))
            if turn <= direction_range:
                unlike = 2 * turn + abs(i32(other & 255) - i32(edge & 255))
                off = (by_likeness * unlike << DISPARITY_BITS) + disparity
                if off < least:
                    best = place
                    least = off
    return best


@kernel
def stereo_edges_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    left_row: u32[:],
    right_row: u32[:],
    right_count: i32,
    geometry: i32[:],
    is_mutual: i32,
    level_range: i32,
    direction_range: i32,
    min_disparity: i32,
    max_disparity: i32,
    width: i32,
    height: i32,
    edges_3d: i16[:],
    found: i32,
) -> i32:
    """Store the 3-D edges of row `y`, where the right picture has the `right_count` edges in `right_row`.

    `left_row` is room for those of the left one. `found` is how many the rows before gave; returns it with this row.
    Those beyond the length of `edges_3d` are counted, not stored.
    """
    place = i32(edge_index[y])
    left_count = take_edges(edge_data, place, i32(edge_counts[y]), left_row, level_range)
    for left in range(left_count):
        edge = left_row[left]
        right = matching_edge(
            edge, right_row, right_count, 1, is_mutual, direction_range, min_disparity, max_disparity
        )
        if right != NONE and is_mutual != 0:
            back = matching_edge(
                right_row[right], left_row, left_count, -1, is_mutual, direction_range, min_disparity, max_disparity
            )  # fmt: skip
            if back != left:
                right = NONE
        if right != NONE:
            x = i32(edge >> 16)
            disparity = SUBPIXELS * (x - i32(right_row[right] >> 16))
            base = EDGE3D_WORDS * found
            stored = 1
            if base < len(edges_3d):
                stored = store_point(
                    geometry,
                    SUBPIXELS * x,
                    SUBPIXELS * y,
                    disparity,
                    width,
                    height,
                    edges_3d,
                    base + EDGE3D_X,
                )
            if stored != 0 and base < len(edges_3d):
                while edge_data[place] != edge:
                    place = place + 1
                edges_3d[base + EDGE3D_LEFT] = place
            found = found + stored
    return found


def stereo_edges(core: Core, frame: Frame, thresholds: StereoEdgeThresholds) -> Generator[Any, Any, int]:
    """Find the 3-D edges of the edge store and the one that core B shares. Returns how many are in `edges_3d`.

    Core B must have posted that its edges are there. Publishes `edges_3d`, that number, and `edges_3d_lost`, how many
    found no room.
    """
    store = edge_store(core)
    right = core.array("right_edge_data"), core.array("right_edge_rows")
    left_row, right_row, *_ = core.overlay("segments", u32, frame.width)
    geometry, edges_3d = core.array("geometry"), core.array("edges_3d")
    level_range = thresholds.level_range
    limits = (
        int(thresholds.correspondence),
        level_range,
        thresholds.direction_range,
        thresholds.min_disparity,
        thresholds.max_disparity,
    )
    size = frame.width, frame.height
    found = 0
    for y in range(frame.height - 1, -1, -1):
        count = yield core.run(take_right_row, *right, y, right_row, level_range)
        rows = left_row, right_row, count
        found = yield core.run(stereo_edges_row, *store, y, *rows, geometry, *limits, *size, edges_3d, found)
    kept = min(found, EDGE3D_CAPACITY)
    core.publish(edges_3d=kept, edges_3d_lost=found - kept)
    return kept
