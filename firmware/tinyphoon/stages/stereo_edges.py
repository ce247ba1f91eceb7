"""3-D edges: edges of the left picture that an edge of the right one corresponds to, for obstacles of any kind (T §5.2.8).

The corresponding edge lies in the same row, has nearly the same gradient direction and a disparity within limits; which one
it is says `edge_correspondence.py`. Edges whose gradient looks up or down belong to lines along the row, all of whose edges
are alike: with `level_range` they are left out, as T §5.2.7 leaves out such lines.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, Row, i16, u16
from tinyphoon.fields import allowed
from tinyphoon.geometry import FARTHEST_MM, disparity_at
from tinyphoon.stages.edge_correspondence import (
    REACH,
    WINDOW_ROWS,
    match_edges,
    match_nearest,
    spread_left_row,
    spread_right_row,
    store_edges3d_row,
    take_left_row,
    take_right_row,
)
from tinyphoon.stages.line_votes import LineVote
from tinyphoon.stages.stereo_lines import Correspondence, check_depths
from tinyphoon.stores.edges import edge_columns, edge_store
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.lines3d import EDGE3D_CAPACITY, EDGE3D_WORDS


@dataclass(frozen=True, slots=True, kw_only=True)
class StereoEdgeThresholds:
    """What makes two edges correspond.

    `correspondence`: how the edge is chosen. `level_range`: how near to straight up or down a gradient is left out, in
    1/256 of a turn; 0 for none. `direction_range`: how far their gradient directions may differ, in 1/256 of a turn.
    `nearest_mm`, `farthest_mm`: depths between which edges are wanted. Only for MUTUAL: `lack`, what a pair's score gets for
    each of the rows around without a pair of its disparity, and `margin`, how much less its score must be than any
    rival's. A score is made of grey levels of gradients and of twice the directions' 1/256.
    """

    correspondence: Correspondence
    level_range: int = allowed(0, 64)
    direction_range: int = allowed(0, 64)
    nearest_mm: int = allowed(1, FARTHEST_MM, at_most="farthest_mm")
    farthest_mm: int = allowed(1, FARTHEST_MM)
    lack: int = allowed(0, 4096)
    margin: int = allowed(0, 4096)

    def __post_init__(self) -> None:
        check_depths(self.nearest_mm, self.farthest_mm)


def stereo_edge_buffers(images: str) -> Sequence[Buffer]:
    """Return the buffers of the stage on core A, in the memory of `images`: they are written only, which costs little."""
    return (Buffer("edges_3d", i16, EDGE3D_WORDS * EDGE3D_CAPACITY, images),)


@dataclass(frozen=True, slots=True)
class _Rows:
    """Rows of both edge stores, without level edges: one as a list, and those around it in windows.

    They lie in L1 over the rings of the stages before, which have finished with them.
    """

    core: Core
    left: tuple[Row, ...]
    right: tuple[Row, ...]
    left_row: Row
    right_row: Row
    windows: tuple[Row, Row]
    level_range: int

    @classmethod
    def of(cls, core: Core, width: int, level_range: int) -> _Rows:
        left_row, right_row = core.rows("candidate_ring")
        right = core.array("right_edge_data"), core.array("right_edge_rows")
        rings = ("colour_ring", "eroded_ring")
        left_window, right_window = (core.overlay(each, u16, WINDOW_ROWS * width)[0] for each in rings)
        return cls(
            core, edge_store(core), right, left_row, right_row, (left_window, right_window), level_range
        )

    def take(self, y: int) -> Generator[Any, Any, tuple[Row, int, Row, int]]:
        """Return row `y`: the edges of the left picture and how many, those of the right one and how many."""
        left: int = yield self.core.run(take_left_row, *self.left, y, self.left_row, self.level_range)
        right: int = yield self.core.run(take_right_row, *self.right, y, self.right_row, self.level_range)
        return self.left_row, left, self.right_row, right

    def spread(self, y: int) -> Generator[Any, Any, None]:
        """Put row `y` into the windows; it may lie outside the picture."""
        left, right = self.windows
        rest = y % WINDOW_ROWS, self.level_range
        yield self.core.run(spread_left_row, *self.left, y, left, *rest)
        yield self.core.run(spread_right_row, *self.right, y, right, *rest)


def stereo_edges(
    core: Core, frame: Frame, thresholds: StereoEdgeThresholds, vote: LineVote
) -> Generator[Any, Any, int]:
    """Find the 3-D edges of the edge store and the one that core B shares; they vote. Returns how many are in `edges_3d`.

    Core B must have posted that its edges are there. Publishes `edges_3d`, that number, and `edges_3d_lost`, how many
    found no room.
    """
    rows = _Rows.of(core, frame.width, thresholds.level_range)
    geometry, edges_3d = core.array("geometry"), core.array("edges_3d")
    partners, *scores = core.overlay("opened_ring", u16, frame.width)
    far: int = yield core.run(disparity_at, geometry, thresholds.farthest_mm)
    near: int = yield core.run(disparity_at, geometry, thresholds.nearest_mm)
    least, most = far // SUBPIXELS + 1, near // SUBPIXELS  # whole pixels between
    is_mutual = thresholds.correspondence is Correspondence.MUTUAL
    limits = thresholds.direction_range, most, thresholds.lack, thresholds.margin
    if is_mutual:
        for y in range(frame.height + REACH - 1, frame.height - REACH - 1, -1):
            yield from rows.spread(y)
    found = 0
    for y in range(frame.height - 1, -1, -1):
        core.at(y, edge_columns(core, y))
        row = yield from rows.take(y)
        if is_mutual:
            yield from rows.spread(y - REACH)
            place = *rows.windows, y % WINDOW_ROWS
            yield core.run(match_edges, *row, *place, partners, *scores, *limits)
        else:
            yield core.run(match_nearest, *row, partners, thresholds.direction_range, least, most)
        yield from vote.add(y, row, partners)
        left, left_count, right, _ = row
        pairs = left, left_count, right, partners, least
        store = core.array("edge_data"), core.array("edge_index"), y
        size = frame.width, frame.height
        found = yield core.run(store_edges3d_row, *store, *pairs, geometry, *size, edges_3d, found)
    core.at()
    kept = min(found, EDGE3D_CAPACITY)
    core.publish(edges_3d=kept, edges_3d_lost=found - kept)
    return kept
