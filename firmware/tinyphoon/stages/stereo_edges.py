"""3-D edges: edges of the left picture that an edge of the right one corresponds to, for obstacles of any kind (T §5.2.8).

The corresponding edge lies in the same row, has nearly the same gradient direction and a disparity within limits; which one
it is say `edge_correspondence.py` and, two rows later, `edge_following.py`; how far away it is, `edge_depths.py`. Edges whose
gradient looks up or down belong to lines along the row, all of whose edges are alike: with `level_range` they are left out, as
T §5.2.7 leaves out such lines.
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

    `correspondence`: how the edge is chosen. `level_range`: how near to straight up or down a gradient is left out, in
    1/256 of a turn; 0 for none. `direction_range`: how far their gradient directions may differ, in 1/256 of a turn.
    `nearest_mm`, `farthest_mm`: depths between which edges are wanted. Only for MUTUAL: `lack`, what a pair's score gets for
    each of the rows around without a pair of its disparity, and `margin`, how much less its score must be than any
    rival's. A score is made of grey levels of gradients and of twice the directions' 1/256. `follow_range`: how far the
    directions may differ where the rows around have the disparity.
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
    """Return the buffers of the stage on core A, in the memory of `images`: they are written only, which costs little."""
    return (Buffer("edges_3d", i16, EDGE3D_WORDS * EDGE3D_CAPACITY, images),)


@dataclass(frozen=True, slots=True)
class _Rows:
    """Rows of both edge stores, without level edges: one as a list, and those around it in windows.

    They lie in L1 over the rings of the stages before, which have finished with them, as all that the search needs.
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

    def take_left(self, y: int) -> Generator[Any, Any, tuple[Row, int]]:
        """Return the edges of the left picture in row `y`, and how many."""
        count: int = yield self.core.run(take_left_row, *self.left, y, self.left_row, self.level_range)
        return self.left_row, count

    def take_below(self, y: int, height: int) -> Generator[Any, Any, list[Row | int]]:
        """Return the edges of the left picture in the REACH rows below row `y` of `height`, each with how many."""
        found: list[Row | int] = []
        for beside, room in enumerate(self.below_rows, y + 1):
            count = 0
            if beside < height:
                count = yield self.core.run(take_left_row, *self.left, beside, room, self.level_range)
            found += room, count
        return found

    def take_right(self, y: int) -> Generator[Any, Any, tuple[Row, int]]:
        """Return the edges of the right picture in row `y`, and how many."""
        count: int = yield self.core.run(take_right_row, *self.right, y, self.right_row, self.level_range)
        return self.right_row, count

    def spread(self, y: int) -> Generator[Any, Any, None]:
        """Put row `y` into the windows; it may lie outside the picture."""
        left, right = self.windows
        rest = y % WINDOW_ROWS, self.level_range
        yield self.core.run(spread_left_row, *self.left, y, left, *rest)
        yield self.core.run(spread_right_row, *self.right, y, right, *rest)


_WINDOWS = "colour_ring", "eroded_ring"
"""Where the windows of both pictures lie."""

_SCORES = "opened_ring"
"""Where matching a row has its scores, and settling one the edges of the rows below."""


def _disparity_rows(core: Core, element: Any, columns: int) -> tuple[Row, ...]:
    """Return the memory of WINDOW_ROWS rows of disparities: what the windows leave, and one row more."""
    left, right = (core.overlay(each, element, columns)[WINDOW_ROWS:] for each in _WINDOWS)
    return (*left, *right, *core.overlay("edge_ring", element, columns))[:WINDOW_ROWS]


def _windows(rows: tuple[Row, ...]) -> tuple[tuple[Row, ...], ...]:
    """Return for each row of a ring those around it and, in their middle, itself."""
    steps = range(-REACH, REACH + 1)
    return tuple(
        tuple(rows[(middle + step) % WINDOW_ROWS] for step in steps) for middle in range(WINDOW_ROWS)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Search:
    """The search for the disparities of left edges, row by row from the bottom of the picture.

    They are found in two steps: `match` asks the edges, and `settle`, `delay` rows later, the disparities around; the
    thesis's way has the first one only, and one row of disparities: those around stay empty. `least` and `most` are the
    disparities that are wanted, in pixels; `around`: the rows of disparities around each of WINDOW_ROWS and, in their middle, its own;
    `is_mutual`: whether it is our way.
    """

    core: Core
    rows: _Rows
    thresholds: StereoEdgeThresholds
    height: int
    least: int
    most: int
    partners: Row
    scores: tuple[Row, ...]
    path: tuple[Row, Row, Row]
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
        return cls(
            core=core, rows=_Rows.of(core, frame.width, thresholds.level_range), thresholds=thresholds,
            height=frame.height, least=least, most=most, partners=partners, scores=tuple(scores),
            path=(values, ends, core.array("edge_groups")),
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
        slot = y % WINDOW_ROWS
        if self.is_mutual:
            yield self.core.run(clear_disparities, self.words[slot])
            yield from self.rows.spread(y - REACH)
        else:
            yield self.core.run(clear_disparities, self.words[0])
        if y < 0:
            return
        left = yield from self.rows.take_left(y)
        right = yield from self.rows.take_right(y)
        limit = self.thresholds.direction_range
        if self.is_mutual:
            limits = limit, self.most, self.thresholds.lack, self.thresholds.margin
            room = self.partners, *self.scores, *self.path
            yield self.core.run(match_edges, *left, *right, *self.rows.windows, slot, *room, *limits)
        else:
            yield self.core.run(match_nearest, *left, *right, self.partners, limit, self.least, self.most)
        yield self.core.run(place_disparities, *left, right[0], self.partners, self.around[slot][REACH])

    def settle(self, y: int) -> Generator[Any, Any, tuple[Row, int, Row]]:
        """Return the edges of the left picture in row `y`, how many, and their disparities."""
        left = yield from self.rows.take_left(y)
        around = self.around[y % WINDOW_ROWS]
        if self.is_mutual:
            right = self.rows.right_window_rows[y % WINDOW_ROWS]
            yield self.core.run(believe_edges, *left, *around, right)
            yield self.core.run(believe_unsure, *left, *around, right)
            below = yield from self.rows.take_below(y, self.height)
            limits = self.thresholds.follow_range, self.most
            yield self.core.run(follow_edges, *left, *below, *around[REACH:], right, *limits)
        return *left, around[REACH]

    def means(self, y: int, left: Row, count: int) -> Generator[Any, Any, Row]:
        """Return the disparities of the `count` edges of a settled row, in 1/16 px: the means with those around."""
        means = self.partners  # which have been placed
        yield self.core.run(mean_disparities, left, count, *self.around[y % WINDOW_ROWS], means)
        return means


def stereo_edges(
    core: Core, frame: Frame, thresholds: StereoEdgeThresholds, vote: LineVote
) -> Generator[Any, Any, int]:
    """Find the 3-D edges of the edge store and the one that core B shares; they vote. Returns how many are in `edges_3d`.

    Core B must have posted that its edges are there. Publishes `edges_3d`, that number, and `edges_3d_lost`, how many
    found no room.
    """
    geometry, edges_3d = core.array("geometry"), core.array("edges_3d")
    far: int = yield core.run(disparity_at, geometry, thresholds.farthest_mm)
    near: int = yield core.run(disparity_at, geometry, thresholds.nearest_mm)
    least, most = far // SUBPIXELS + 1, near // SUBPIXELS  # whole pixels between
    search = _Search.of(core, frame, thresholds, least, most)
    yield from search.open()
    store = core.array("edge_data"), core.array("edge_index")
    size = frame.width, frame.height
    found = 0
    for matched in range(frame.height - 1, -1 - search.delay, -1):
        y = matched + search.delay
        core.at(max(matched, 0), edge_columns(core, max(matched, 0)))
        yield from search.match(matched)
        if y < frame.height:
            core.at(y, edge_columns(core, y))
            row = yield from search.settle(y)
            yield from vote.add(y, row)
            edges = row[:2]
            means = yield from search.means(y, *edges)
            found = yield core.run(
                store_edges3d_row, *store, y, *edges, means, far, geometry, *size, edges_3d, found
            )
    core.at()
    kept = min(found, EDGE3D_CAPACITY)
    core.publish(edges_3d=kept, edges_3d_lost=found - kept)
    return kept
