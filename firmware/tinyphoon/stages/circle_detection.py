"""Circle detection (T §5.2.4): centre and radius of the ball that a blob may be, from the edges around it.

Votes along the gradients find the centre, and a histogram of distances the radius; two tests judge them. The rest is
[ours]: the circle that most edges agree on, and a fit to the outline finer than a pixel. If a ball is partly hidden, or
cut by the picture's border, the remaining edges decide. The sphere's image is taken as a circle.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, Row, i16, i32, u8, u16, u32
from tinyphoon.fields import allowed
from tinyphoon.stages.circle_consensus import agree_on_side
from tinyphoon.stages.circle_edges import (
    AREA_WORDS,
    NONE,
    next_blob,
    open_area,
    rows_of,
    select_edges_row,
)
from tinyphoon.stages.circle_fit import (
    FIT_WORDS,
    expect_bulge,
    fit_circle,
)
from tinyphoon.stages.circle_judging import (
    close_circle,
    judge_arc,
    judge_centre,
    judge_consensus,
    judge_radius,
    open_circle,
)
from tinyphoon.stages.circle_outline import LUMA_LINES, REACH_LINES, RISES, clear_points, luma_row, refine_row
from tinyphoon.stages.circle_radius import fill_histogram
from tinyphoon.stages.circle_votes import clear_votes, draw_lines
from tinyphoon.stores.blobs import box_of
from tinyphoon.stores.circles import (
    CIRCLE_WORDS,
)
from tinyphoon.stores.edges import EDGE_CAPACITY, edge_store
from tinyphoon.tables import tangent_table

CIRCLE_CAPACITY = 64  # 1 KB; as many as there are blobs in the modes
LARGEST_REACH = 32  # of the patch: 65 x 65 votes share memory with the segments of the line detection
LARGEST_FIT_RANGE = 4  # the fit's sums over all edges of a picture 640 wide fit in 32 bits


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleThresholds:
    """Thresholds of the circle detection. Angles in 1/256 of a turn, lengths in pixels, shares of all edges in 1/256.

    `border`: how far from the blob's rectangle edges are used. `angle_range`: how far a gradient may point past
    the centre of mass, or away from it (eps_angle). `beside_colour`: if the ball's side of an edge is the dark
    one, the blob's colour must be near it. `patch_reach`: how far the centre is looked for to each side of the
    centre of mass, 0..32, and not further than half the blob. `peak_reach`: how many cells round a peak belong to
    it; 0 is the thesis, whole pixels. `min_edges`, `centre_share`: of the centre test T_c (T Eq. 5.6).
    `min_peak`, `radius_share`: of the radius test T_r (T Eq. 5.7). `consensus_share`: if more of the edges agree
    on a circle, it has passed both tests. `fit_rounds`: how often at most centre and radius are fitted to the
    outline; 0 is the thesis, without consensus. `fit_range`: how far from the circle the outline is looked for,
    1..4.
    """

    border: int = allowed(0, 64)
    angle_range: int = allowed(0, 128)
    beside_colour: bool
    patch_reach: int = allowed(0, LARGEST_REACH)
    peak_reach: int = allowed(0, LARGEST_REACH, at_most="patch_reach")
    min_edges: int = allowed(1, EDGE_CAPACITY)
    centre_share: int = allowed(0, 256)
    min_peak: int = allowed(1, EDGE_CAPACITY)
    radius_share: int = allowed(0, 256)
    consensus_share: int = allowed(0, 256)
    fit_rounds: int = allowed(0, 16)
    fit_range: int = allowed(1, LARGEST_FIT_RANGE)

    def __post_init__(self) -> None:
        if not self.peak_reach <= self.patch_reach <= LARGEST_REACH:
            raise ValueError(
                f"patch_reach must be peak_reach ({self.peak_reach}) to {LARGEST_REACH}, not {self.patch_reach}"
            )
        if not 1 <= self.fit_range <= LARGEST_FIT_RANGE:
            raise ValueError(f"fit_range must be 1 to {LARGEST_FIT_RANGE}, not {self.fit_range}")


def circle_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage for a core. Its working memory shares the rings of earlier stages."""
    return (
        Buffer("circles", i16, CIRCLE_WORDS * CIRCLE_CAPACITY, "data1"),
        Buffer("tangents", u16, 33, "L1_data", values=tangent_table()),
        Buffer("circle_area", i32, AREA_WORDS, "L1_scratch"),
        Buffer("circle_fit", i32, FIT_WORDS, "L1_scratch"),
        Buffer("circle_rises", i32, RISES, "L1_scratch"),
    )


def select_edges(
    core: Core, frame: Frame, blob: int, colours: int, thresholds: CircleThresholds, selected: Row
) -> Generator[Any, Any, int]:
    """Select the edges of a blob's outline; return how many there are. Its lines come through the opening's ring."""
    area, atan = core.array("circle_area"), core.array("atan")
    top, bottom = yield from open_outline(core, frame, blob, thresholds)
    first = max(top - 1, 0)
    image = core.rows("opened_image")[first : min(bottom + 2, frame.height)]
    lines = core.input_ring(image, "colour_ring")
    store = edge_store(core)
    filters = area, thresholds.angle_range, int(thresholds.beside_colour), atan
    found = 0
    here = below = yield from lines.line()
    for ahead in range(first + 1, bottom + 2):
        above, here = here, below  # the first and the last line repeat
        if ahead < frame.height:
            below = yield from lines.line()
        y = ahead - 1
        if top <= y:
            near = above, here, below
            found = yield core.run(select_edges_row, *store, y, *near, colours, *filters, selected, found)
    return found


EdgeSelection = Callable[[Core, Frame, int, int, CircleThresholds, Row], Generator[Any, Any, int]]
"""How the edges of a blob's outline are selected: `select_edges`, or another way."""


def circle_detection(
    core: Core,
    frame: Frame,
    blobs: int,
    colours: int,
    thresholds: CircleThresholds,
    select: EdgeSelection = select_edges,
) -> Generator[Any, Any, int]:
    """Look for a circle around each of the first `blobs` blobs with some of `colours`; leave them in `circles`.

    Returns how many records there are, failed ones included, and publishes it as `circles`. Also publishes
    `circles_lost`, how many had no room, and `circle_edges_lost`, the edges that found no room in the working memory.
    """
    blob_data, circles = core.array("blob_data"), core.array("circles")
    room = len(core.rows("eroded_ring")) * frame.width
    selected = core.overlay("eroded_ring", u32, room)[0]
    number = lost = edges_lost = 0
    blob = yield core.run(next_blob, blob_data, 0, blobs, colours)
    while blob != NONE:
        core.at(*box_of(blob_data, blob))
        if number < CIRCLE_CAPACITY:
            found = yield from select(core, frame, blob, colours, thresholds, selected)
            count = min(found, room)
            edges_lost += found - count
            if thresholds.fit_rounds:
                count = yield core.run(
                    agree_on_side, selected, count, core.array("circle_area"), core.array("circle_fit")
                )
            yield core.run(open_circle, blob_data, blob, count, circles, number)
            if count >= max(thresholds.min_edges, 1):
                yield from _measure(core, frame, selected, count, thresholds, number)
            number += 1
        else:
            lost += 1
        core.at()
        blob = yield core.run(next_blob, blob_data, blob + 1, blobs, colours)
    core.publish(circles=number, circles_lost=lost, circle_edges_lost=edges_lost)
    return number


def open_outline(
    core: Core, frame: Frame, blob: int, thresholds: CircleThresholds
) -> Generator[Any, Any, tuple[int, int]]:
    """Store in `circle_area` where to look for the outline of a blob; return the first row and the last."""
    limits = thresholds.border, thresholds.patch_reach, frame.width, frame.height
    return ends(
        (yield core.run(open_area, core.array("blob_data"), blob, core.array("circle_area"), *limits))
    )


def _measure(
    core: Core, frame: Frame, selected: Row, count: int, thresholds: CircleThresholds, number: int
) -> Generator[Any, Any, None]:
    """Find centre and radius of circle `number` from its edges, and test them."""
    area, fit, circles = core.array("circle_area"), core.array("circle_fit"), core.array("circles")
    votes = core.overlay("segments", u16, (2 * LARGEST_REACH + 1) ** 2)[0]
    histogram = core.overlay("magnitude_ring", u16, frame.width)[0]
    reach = thresholds.peak_reach
    yield core.run(clear_votes, votes, area)
    yield core.run(draw_lines, selected, count, votes, area, core.array("tangents"))
    result = fit, circles, number
    passed = yield core.run(judge_centre, votes, area, count, reach, thresholds.centre_share, *result)
    if passed:
        yield core.run(fill_histogram, selected, count, fit, histogram)
        judged = histogram, count, reach, thresholds.min_peak, thresholds.radius_share
        passed = yield core.run(judge_radius, *judged, *result)
        yield core.run(close_circle, *result)
    if thresholds.fit_rounds:
        shares = thresholds.consensus_share, passed
        passed = yield core.run(judge_consensus, selected, count, area, *shares, *result)
        if passed:
            yield from _refine(core, frame, selected, count, votes, thresholds)
            yield core.run(judge_arc, selected, fit, core.array("atan"), circles, number)
            yield core.run(close_circle, *result)


def _refine(
    core: Core, frame: Frame, selected: Row, count: int, weights: Row, thresholds: CircleThresholds
) -> Generator[Any, Any, None]:
    """Fit centre and radius to the outline in the camera's lines, which come through the ring of the edge detection.

    `weights` has room for as many words as there are edges.
    """
    area, fit = core.array("circle_area"), core.array("circle_fit")
    profile = fit, thresholds.fit_range, core.array("circle_rises"), weights
    luma = core.overlay("colour_ring", u8, LUMA_LINES * frame.width)[0]
    top, bottom = ends((yield core.run(rows_of, area)))
    first, height = max(top - REACH_LINES, 0), frame.height
    lines = core.input_ring(frame.rows[first : min(bottom + 1 + REACH_LINES, height)], "camera_ring")
    yield core.run(clear_points, fit)
    for ahead in range(first, bottom + 1 + REACH_LINES):
        if ahead < height:
            line = yield from lines.line()
            yield core.run(luma_row, line, luma, ahead, area)
        y = ahead - REACH_LINES
        if top <= y:
            yield core.run(refine_row, selected, count, y, luma, height, *profile)
    yield core.run(expect_bulge, fit, core.array("geometry"), frame.width, height)
    yield core.run(fit_circle, selected, weights, fit, thresholds.fit_range, thresholds.fit_rounds)


def ends(rows: int) -> tuple[int, int]:
    """Return the two shorts of a word."""
    return rows & 0xFFFF, rows >> 16
