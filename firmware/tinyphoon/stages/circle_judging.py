"""The record of a circle during the search: opened, judged by its centre, radius and outline, and closed."""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u8, u16, u32
from tinyphoon.stages.circle_consensus import find_consensus
from tinyphoon.stages.circle_edges import (
    BORDERING,
    FINE,
    MASS_X,
    MASS_Y,
    REACH,
)
from tinyphoon.stages.circle_fit import (
    CENTRE_X,
    CENTRE_Y,
    RADIUS,
    arc_of,
)
from tinyphoon.stages.circle_radius import edges_round, find_radius, mean_radius
from tinyphoon.stages.circle_votes import find_peak, mean_offset, votes_round
from tinyphoon.stores.blobs import BLOB_WORDS, PIXELS, SUM_X, SUM_Y
from tinyphoon.stores.circles import (
    CENTRE_PASSED,
    CIRCLE_ARC,
    CIRCLE_BLOB,
    CIRCLE_CENTRE,
    CIRCLE_EDGES,
    CIRCLE_RADIUS,
    CIRCLE_RADIUS_SHARE,
    CIRCLE_TESTS,
    CIRCLE_WORDS,
    CIRCLE_X,
    CIRCLE_Y,
    RADIUS_PASSED,
)
from tinyphoon.stores.lines import SUBPIXELS


@kernel
def share_of(part: i32, whole: i32) -> i32:
    """Return a part of a positive whole in 1/256, 255 at most."""
    return min((part << 8) // whole, 255)


@kernel
def sixteenths(sum: u32, pixels: u32) -> i32:
    """Return the mean coordinate of a blob's pixels in 1/16 px, without leaving 32 bits."""
    whole = sum // pixels
    rest = sum - whole * pixels
    return i32(whole * SUBPIXELS + (2 * SUBPIXELS * rest + pixels) // (2 * pixels))


@kernel
def open_circle(blob_data: u32[:], blob: i32, edges: i32, circles: i16[:], number: i32) -> None:
    """Begin the record of a circle with its blob's centre of mass, and no test passed."""
    at = number * CIRCLE_WORDS
    base = blob * BLOB_WORDS
    circles[at + CIRCLE_X] = sixteenths(blob_data[base + SUM_X], blob_data[base + PIXELS])
    circles[at + CIRCLE_Y] = sixteenths(blob_data[base + SUM_Y], blob_data[base + PIXELS])
    circles[at + CIRCLE_RADIUS] = 0
    circles[at + CIRCLE_BLOB] = blob
    circles[at + CIRCLE_EDGES] = edges
    circles[at + CIRCLE_CENTRE] = 0
    circles[at + CIRCLE_RADIUS_SHARE] = 0
    circles[at + CIRCLE_TESTS] = 0
    circles[at + CIRCLE_ARC] = 0


@kernel
def judge_centre(
    votes: u16[:],
    area: i32[:],
    edges: i32,
    peak_reach: i32,
    centre_share: i32,
    fit: i32[:],
    circles: i16[:],
    number: i32,
) -> i32:
    """Find the peak of the votes of `edges` edges and return 1 if it passes T_c, else 0 (T Eq. 5.6).

    `fit` gets the centre. A line through the middle of a square leaves a vote in each of its columns or rows, so the
    peak counts as its votes divided by its side.
    """
    side = 2 * area[REACH] + 1
    reach = min(peak_reach, area[REACH])
    peak = find_peak(votes, area[REACH], reach)
    size = votes_round(votes, side, peak, reach)
    share = share_of(size, edges * (2 * reach + 1))
    circles[number * CIRCLE_WORDS + CIRCLE_CENTRE] = share
    if size == 0 or share < centre_share:
        return 0
    x = area[MASS_X] - area[REACH] + peak % side
    y = area[MASS_Y] - area[REACH] + peak // side
    fit[CENTRE_X] = FINE * x + mean_offset(votes, peak, 1, side, reach)
    fit[CENTRE_Y] = FINE * y + mean_offset(votes, peak, side, 1, reach)
    circles[number * CIRCLE_WORDS + CIRCLE_TESTS] = CENTRE_PASSED
    return 1


@kernel
def judge_radius(
    histogram: u16[:],
    edges: i32,
    peak_reach: i32,
    min_peak: i32,
    radius_share: i32,
    fit: i32[:],
    circles: i16[:],
    number: i32,
) -> i32:
    """Find the peak of the distances of `edges` edges and return 1 if it passes T_r, else 0 (T Eq. 5.7).

    `fit` gets the radius.
    """
    at = number * CIRCLE_WORDS
    radius = find_radius(histogram, peak_reach)
    size = edges_round(histogram, radius, peak_reach)
    fit[RADIUS] = 0
    if size == 0:
        return 0
    fit[RADIUS] = mean_radius(histogram, radius, peak_reach)
    share = share_of(size, edges)
    circles[at + CIRCLE_RADIUS_SHARE] = share
    if size < min_peak or share < radius_share:
        return 0
    circles[at + CIRCLE_TESTS] = CENTRE_PASSED | RADIUS_PASSED
    return 1


@kernel
def judge_consensus(
    selected: u32[:],
    count: i32,
    area: i32[:],
    consensus_share: i32,
    passed: i32,
    fit: i32[:],
    circles: i16[:],
    number: i32,
) -> i32:
    """Find the circle that most of `count` edges agree on, and return 1 if the circle has passed T_c and T_r, or now does.

    Edges at the blob's border that look elsewhere agree on nothing, but count as well.
    """
    if passed == 0:
        fit[RADIUS] = 0
    share = find_consensus(selected, count, area, fit) * count // area[BORDERING]
    if passed == 0 and share <= consensus_share:
        return 0
    circles[number * CIRCLE_WORDS + CIRCLE_TESTS] = CENTRE_PASSED | RADIUS_PASSED
    return 1


@kernel
def judge_arc(points: u32[:], fit: i32[:], atan: u8[:], circles: i16[:], number: i32) -> None:
    """Store how much of a circle has outline on it."""
    circles[number * CIRCLE_WORDS + CIRCLE_ARC] = arc_of(points, fit, atan)


@kernel
def close_circle(fit: i32[:], circles: i16[:], number: i32) -> None:
    """Store centre and radius in 1/16 px."""
    at = number * CIRCLE_WORDS
    part = FINE // SUBPIXELS
    circles[at + CIRCLE_X] = (fit[CENTRE_X] + part // 2) // part
    circles[at + CIRCLE_Y] = (fit[CENTRE_Y] + part // 2) // part
    circles[at + CIRCLE_RADIUS] = (fit[RADIUS] + part // 2) // part
