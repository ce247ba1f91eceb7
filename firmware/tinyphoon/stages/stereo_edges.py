"""3-D edges: edges of the left picture with a corresponding edge in the right one, for any obstacles (T §5.2.8).

The corresponding edge lies in the same row, and has nearly the same gradient direction and a disparity within limits;
`edge_correspondence.py` chooses it and, two rows later, `edge_following.py`; `edge_depths.py` computes its depth. Edges
whose gradient looks up or down belong to lines along the row, whose edges are all alike: with `level_range` they are
left out, as T §5.2.7 leaves out such lines.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, Row, i16, i32, u16, u32
from tinyphoon.fields import allowed
from tinyphoon.geometry import FARTHEST_MM, disparity_at
from tinyphoon.stages.edge_correspondence import match_edges
from tinyphoon.stages.edge_depths import mean_disparities, store_edges3d_row
from tinyphoon.stages.edge_following import (
    believe_edges,
    believe_unsure,
    clear_disparities,
    follow_edges,
    place_disparities,
)
from tinyphoon.stages.edge_rows import (
    REACH,
    WINDOW_ROWS,
    spread_left_row,
    spread_right_row,
    take_left_row,
    take_right_row,
)
from tinyphoon.stages.line_votes import LineVote
from tinyphoon.stages.stereo_lines import Correspondence, check_depths
from tinyphoon.stages.thesis_edges import match_nearest
from tinyphoon.stores.edges import edge_columns, edge_store
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.lines3d import EDGE3D_CAPACITY, EDGE3D_WORDS


@dataclass(frozen=True, slots=True, kw_only=True)
class StereoEdgeThresholds:
    """What makes two edges correspond.

    `correspondence`: how the edge is chosen. `level_range`: gradients this near to straight up or down are left out, in
    1/256 of a turn; 0 for none. `direction_range`: how far their gradient directions may differ, in 1/256 of a turn.
    `nearest_mm`, `farthest_mm`: depths between which edges are wanted. Only for MUTUAL: `lack`, what a pair's score
    gets for each of the rows around without a pair of its disparity, and `margin`, how much less its score must be than
    any rival's. A score consists of grey levels of gradients and twice the directions' 1/256. `follow_range`: how far
    the directions may differ if the rows around have the disparity.
    """

    correspondence: Correspondence
    level_range: int = allowed(0, 64)
    direction_range: int = allowed(0, 64)
    nearest_mm: int = allowed(1, FARTHEST_MM, at_most="farthest_mm")
    farthest_mm: int = allowed(1, FARTHEST_MM)
    lack: int = allowed(0, 4096)
    margin: int = allowed(0, 4096)
    follow_range: int = allowed(0, 64)

    def __post_init__(self) -> None:
        check_depths(self.nearest_mm, self.farthest_mm)


def stereo_edge_buffers(images: str) -> Sequence[Buffer]:
    """Return the stage's buffers on core A, in the memory of `images`: they are only written, which costs little."""
    return (Buffer("edges_3d", i16, EDGE3D_WORDS * EDGE3D_CAPACITY, images),)


@dataclass(frozen=True, slots=True)
class _Rows:
    """Rows of both edge stores, without level edges: one as a list, and those around it in windows.

    Like everything that the search needs, they lie in L1 over the rings of earlier stages, which no longer need them.
    """

    core: Core
    left: tuple[Row, ...]
    right: tuple[Row, ...]
    left_row: Row
    right_row: Row
    windows: tuple[Row, Row]
    right_window_rows: tuple[Row, ...]
    below_rows: tuple[Row, ...]
    level_range: int

    @classmethod
    def of(cls, core: Core, width: int, level_range: int) -> _Rows:
        lists = core.rows("candidate_ring")
        right = core.array("right_edge_data"), core.array("right_edge_rows")
        left_window, right_window = (core.overlay(each, u16, WINDOW_ROWS * width)[0] for each in _WINDOWS)
        right_window_rows = core.overlay(_WINDOWS[1], u16, width)[:WINDOW_ROWS]
        windows = (left_window, right_window), right_window_rows
        below_rows = core.overlay(_SCORES, u32, width)[:REACH]
        return cls(core, edge_store(core), right, *lists, *windows, tuple(below_rows), level_range)

    def spread(self, y: int) -> Generator[Any, Any, None]:
        """Put row `y` into the windows; it may lie outside the picture."""
        run, (left, right), (data, index, counts) = self.core.run, self.windows, self.left
        (edges, rows), slot, level_range = self.right, y % WINDOW_ROWS, self.level_range
        yield run(spread_left_row, data, index, counts, y, left, slot, level_range)
        yield run(spread_right_row, edges, rows, y, right, slot, level_range)


_WINDOWS = "colour_ring", "eroded_ring"
"""The memory of the windows of both pictures."""

_SCORES = "opened_ring"
"""The memory of the scores in matching a row, and of the edges of the rows below in settling one."""


def _disparity_rows(core: Core, element: Any, columns: int) -> tuple[Row, ...]:
    """Return the memory of WINDOW_ROWS rows of disparities: what the windows leave, and one row more."""
    left, right = (core.overlay(each, element, columns)[WINDOW_ROWS:] for each in _WINDOWS)
    return (*left, *right, *core.overlay("edge_ring", element, columns))[:WINDOW_ROWS]


def _windows(rows: tuple[Row, ...]) -> tuple[tuple[Row, ...], ...]:
    """Return for each row of a ring those around it, with itself in their middle."""
    steps = range(-REACH, REACH + 1)
    return tuple(
        tuple(rows[(middle + step) % WINDOW_ROWS] for step in steps) for middle in range(WINDOW_ROWS)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Search:
    """The search for the disparities of left edges, row by row from the bottom of the picture.

    They are found in two steps: `match` compares edges, and `settle`, `delay` rows later, uses the disparities around;
    the thesis's way has only the first one, and one row of disparities: those around stay empty. `most`: the largest
    wanted disparity, in pixels; `around`: the rows of disparities around each of WINDOW_ROWS, with its own in their
    middle; `is_mutual`: whether it is our way; `room` and `limits`: the last arguments of the matching kernel.
    """

    core: Core
    rows: _Rows
    height: int
    most: int
    follow_range: int
    partners: Row
    room: tuple[Row, ...]
    limits: tuple[int, ...]
    around: tuple[tuple[Row, ...], ...]
    words: tuple[Row, ...]
    is_mutual: bool

    @classmethod
    def of(cls, core: Core, frame: Frame, thresholds: StereoEdgeThresholds, least: int, most: int) -> _Search:
        partners, *_ = core.overlay(_SCORES, i16, frame.width)
        _, *scores = core.overlay(_SCORES, u16, frame.width)
        values, *_ = core.overlay("camera_ring", i32, frame.width)
        ends, *_ = core.overlay("grey_ring", u16, frame.width)
        around = _windows(_disparity_rows(core, i16, frame.width))
        is_mutual = thresholds.correspondence is Correspondence.MUTUAL
        limit = thresholds.direction_range
        return cls(
            core=core, rows=_Rows.of(core, frame.width, thresholds.level_range), height=frame.height, most=most,
            follow_range=thresholds.follow_range, partners=partners,
            room=(*scores, values, ends, core.array("edge_groups")),
            limits=(limit, most, thresholds.lack, thresholds.margin) if is_mutual else (limit, least, most),
            around=around if is_mutual else WINDOW_ROWS * around[:1],
            words=_disparity_rows(core, u32, frame.width // 2),
            is_mutual=is_mutual,
        )  # fmt: skip

    @property
    def delay(self) -> int:
        """How many rows later a row is settled than matched."""
        return REACH if self.is_mutual else 0

    def open(self) -> Generator[Any, Any, None]:
        """Begin below the picture."""
        for words in self.words:
            yield self.core.run(clear_disparities, words)
        if self.is_mutual:
            for y in range(self.height + REACH - 1, self.height - REACH - 1, -1):
                yield from self.rows.spread(y)

    def match(self, y: int) -> Generator[Any, Any, None]:
        """Look for partners of the edges of row `y`; it may lie above the picture."""
        run, rows, slot, partners = self.core.run, self.rows, y % WINDOW_ROWS, self.partners
        if self.is_mutual:
            yield run(clear_disparities, self.words[slot])
            yield from rows.spread(y - REACH)
        else:
            yield run(clear_disparities, self.words[0])
        if y < 0:
            return
        (data, index, counts), (edges, starts), level_range = rows.left, rows.right, rows.level_range
        left, right = rows.left_row, rows.right_row
        count = yield run(take_left_row, data, index, counts, y, left, level_range)
        right_count = yield run(take_right_row, edges, starts, y, right, level_range)
        both = left, count, right, right_count
        if self.is_mutual:
            yield run(match_edges, *both, *rows.windows, slot, partners, *self.room, *self.limits)
        else:
            yield run(match_nearest, *both, partners, *self.limits)
        yield run(place_disparities, left, count, right, partners, self.around[slot][REACH])

    def settle(self, y: int) -> Generator[Any, Any, tuple[Row, int, Row]]:
        """Return the edges of the left picture in row `y`, their number, and their disparities."""
        run, rows, slot = self.core.run, self.rows, y % WINDOW_ROWS
        (data, index, counts), left, level_range = rows.left, rows.left_row, rows.level_range
        count = yield run(take_left_row, data, index, counts, y, left, level_range)
        above2, above, here, below, below2 = self.around[slot]
        if self.is_mutual:
            right = rows.right_window_rows[slot]
            yield run(believe_edges, left, count, above2, above, here, below, below2, right)
            yield run(believe_unsure, left, count, above2, above, here, below, below2, right)
            beside: list[Row | int] = []
            for next_y, room in enumerate(rows.below_rows, y + 1):
                edges = 0
                if next_y < self.height:
                    edges = yield run(take_left_row, data, index, counts, next_y, room, level_range)
                beside += room, edges
            settled = here, below, below2, right
            yield run(follow_edges, left, count, *beside, *settled, self.follow_range, self.most)
        return left, count, here


def stereo_edges(
    core: Core, frame: Frame, thresholds: StereoEdgeThresholds, vote: LineVote
) -> Generator[Any, Any, int]:
    """Find the 3-D edges of the edge store and core B's; they vote. Return how many are in `edges_3d`.

    Core B must have posted that its edges are there. Publishes `edges_3d`, that number, and `edges_3d_lost`, how many
    found no room.
    """
    geometry, edges_3d = core.array("geometry"), core.array("edges_3d")
    far: int = yield core.run(disparity_at, geometry, thresholds.farthest_mm)
    near: int = yield core.run(disparity_at, geometry, thresholds.nearest_mm)
    least, most = far // SUBPIXELS + 1, near // SUBPIXELS  # whole pixels between
    search = _Search.of(core, frame, thresholds, least, most)
    yield from search.open()
    run, at, store, delay = core.run, core.at, search.rows.left, search.delay
    data, index, _ = store
    means = search.partners  # these have been placed
    width, height = frame.width, frame.height
    found = 0
    for matched in range(height - 1, -1 - delay, -1):
        at(max(matched, 0), edge_columns, store, max(matched, 0))
        yield from search.match(matched)
        y = matched + delay
        if y < height:
            at(y, edge_columns, store, y)
            row = yield from search.settle(y)
            yield from vote.add(y, row)
            left, count, _ = row
            above2, above, here, below, below2 = search.around[y % WINDOW_ROWS]
            yield run(mean_disparities, left, count, above2, above, here, below, below2, means)
            found = yield run(
                store_edges3d_row,
                data, index, y, left, count, means, far, geometry, width, height, edges_3d, found,
            )  # fmt: skip
    at()
    kept = min(found, EDGE3D_CAPACITY)
    core.publish(edges_3d=kept, edges_3d_lost=found - kept)
    return kept
