"""Decide disparities by those around: most things continue in the next rows, at nearly the same depth.

A pair that matched by itself (`edge_correspondence.py`) is believed if pairs in two of the four rows around have its
disparity, to a pixel. An unsure pair, on its row's path but with rivals, is believed if the next believed pair in its
row has its disparity, to a pixel, and all four rows have it on their paths. A remaining edge then follows believed ones
in its row and the two below: it takes the most similar right edge at their disparities. It must not follow rows above,
which are not decided yet: an error there would be followed and then believed for it. There are few disparities to
choose from, so its gradient may be turned farther than that of a pair which had the whole row, and they may lie farther
beside it: contours lean, and many things keep their depth.

A row of disparities holds, at the column of each left edge, its disparity in pixels plus 1 (negative: unsure), or 0.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u16, u32
from tinyphoon.stages.edge_correspondence import WORST, unlike

OFFER_BITS = 12
"""More than the disparities of any picture need."""

NO_OFFER = WORST << OFFER_BITS

LEAST_SUPPORT = 2
"""Rows around that must have a disparity: by chance, one of the four often has it, but seldom two."""

BESIDE = 16
"""How much more similar a pair must be that differs from the followed disparity by a pixel: most things keep theirs."""

FOLLOW_REACH = 12
"""Columns on both sides of an edge in which it finds disparities to follow."""


@kernel
def clear_disparities(words: u32[:]) -> None:
    """Begin a row of disparities, two columns a word."""
    for word in range(len(words)):
        words[word] = 0


@kernel
def place_disparities(
    left_row: u32[:], left_count: i32, right_row: u32[:], partners: i16[:], disparities: i16[:]
) -> None:
    """Put the disparities of the left edges of a row that have a partner into a cleared row."""
    for left in range(left_count):
        partner = i32(partners[left])
        if partner != 0:
            x = i32(left_row[left] >> 16)
            disparity = x - i32(right_row[abs(partner) - 1] >> 16) + 1
            disparities[x] = disparity if partner > 0 else -disparity


@kernel
def is_beside(disparities: i16[:], x: i32, away: i32, disparity: i32) -> i32:
    """Return 1 if an edge within `away` of column `x` has a sure disparity (plus 1) like this, to a pixel; else 0."""
    for column in range(max(x - away, 0), min(x + away, len(disparities) - 1) + 1):
        known = i32(disparities[column])
        if known > 0 and abs(known - disparity) <= 1:
            return 1
    return 0


@kernel
def like_beside(disparities: i16[:], x: i32, away: i32, disparity: i32) -> i32:
    """Return a disparity (plus 1), sure or not, like this to a pixel, of an edge within `away` of column `x`, or 0."""
    for column in range(max(x - away, 0), min(x + away, len(disparities) - 1) + 1):
        known = abs(i32(disparities[column]))
        if known != 0 and abs(known - disparity) <= 1:
            return known
    return 0


@kernel
def believe_edges(
    left_row: u32[:],
    left_count: i32,
    above2: i16[:],
    above: i16[:],
    here: i16[:],
    below: i16[:],
    below2: i16[:],
    right_edges: u16[:],
) -> None:
    """Remove a row's sure disparities that the rows around do not confirm, and from `right_edges` the edges of the rest.

    `right_edges` has the row's gradients and directions by column, or 0, as a window of `spread_edges`.
    """
    for left in range(left_count):
        x = i32(left_row[left] >> 16)
        disparity = i32(here[x])
        if disparity > 0:
            support = is_beside(below, x, 1, disparity) + is_beside(above, x, 1, disparity)
            support = support + is_beside(below2, x, 2, disparity) + is_beside(above2, x, 2, disparity)
            if support >= LEAST_SUPPORT:
                right_edges[x - disparity + 1] = 0
            else:
                here[x] = 0


@kernel
def believe_unsure(
    left_row: u32[:],
    left_count: i32,
    above2: i16[:],
    above: i16[:],
    here: i16[:],
    below: i16[:],
    below2: i16[:],
    right_edges: u16[:],
) -> None:
    """Make unsure disparities of a row sure if all rows around have them, and the nearest sure one beside them, too.

    Those to the right of believed pairs come first, then those to the left. A right edge belongs to only one.
    """
    for side in range(2):
        beside = 0
        for number in range(left_count):
            place = number if side == 0 else left_count - 1 - number
            x = i32(left_row[place] >> 16)
            known = i32(here[x])
            if known > 0:
                beside = known
            elif known < 0 and beside != 0 and abs(known + beside) <= 1:
                disparity = -known
                if (
                    right_edges[x - disparity + 1] != 0
                    and like_beside(below, x, 1, disparity) != 0
                    and like_beside(above, x, 1, disparity) != 0
                    and like_beside(below2, x, 2, disparity) != 0
                    and like_beside(above2, x, 2, disparity) != 0
                ):
                    here[x] = disparity
                    right_edges[x - disparity + 1] = 0
                    beside = disparity


@kernel
def best_offer(
    edge: u32,
    row: u32[:],
    first: i32,
    count: i32,
    disparities: i16[:],
    right_edges: u16[:],
    follow_range: i32,
    max_disparity: i32,
) -> i32:
    """Return the difference between `edge` and the most similar right edge that a row offers.

    Offered are those at the disparities of the edges within FOLLOW_REACH of its column, and a pixel beside; `row` has
    the row's `count` edges, of which those before place `first` are farther away. The lower OFFER_BITS are the
    disparity plus 1; without an offer it is NO_OFFER or more.
    """
    x = i32(edge >> 16)
    most = min(x, max_disparity) + 1
    best = NO_OFFER
    before = 0
    for place in range(first, count):
        column = i32(row[place] >> 16)
        if column > x + FOLLOW_REACH:
            break
        known = i32(disparities[column])
        if known > 0 and known != before:
            for disparity in range(max(known - 1, 1), min(known + 1, most) + 1):
                other = i32(right_edges[x - disparity + 1])
                if other != 0:
                    off = unlike(i32(edge & 0xFFFF), other, follow_range)
                    off = off + BESIDE * abs(disparity - known)
                    best = min(best, off << OFFER_BITS | disparity)
            before = known
    return best


@kernel
def first_in_reach(row: u32[:], first: i32, count: i32, x: i32) -> i32:
    """Return the place, from `first` on, of a row's first edge that is not too far to the left of column `x`."""
    while first < count and i32(row[first] >> 16) < x - FOLLOW_REACH:
        first = first + 1
    return first


@kernel
def follow_edges(
    left_row: u32[:],
    left_count: i32,
    below_row: u32[:],
    below_count: i32,
    below2_row: u32[:],
    below2_count: i32,
    here: i16[:],
    below: i16[:],
    below2: i16[:],
    right_edges: u16[:],
    follow_range: i32,
    max_disparity: i32,
) -> None:
    """Give left edges of a row without a sure disparity one of those around; a right edge belongs to only one."""
    first = 0
    first_below = 0
    first_below2 = 0
    for left in range(left_count):
        edge = left_row[left]
        x = i32(edge >> 16)
        if here[x] <= 0:
            first = first_in_reach(left_row, first, left_count, x)
            first_below = first_in_reach(below_row, first_below, below_count, x)
            first_below2 = first_in_reach(below2_row, first_below2, below2_count, x)
            best = best_offer(
                edge, left_row, first, left_count, here, right_edges, follow_range, max_disparity
            )
            offer = best_offer(
                edge, below_row, first_below, below_count, below, right_edges, follow_range, max_disparity
            )
            best = min(best, offer)
            offer = best_offer(
                edge, below2_row, first_below2, below2_count, below2, right_edges, follow_range, max_disparity
            )
            best = min(best, offer)
            if best < NO_OFFER:
                disparity = best & (1 << OFFER_BITS) - 1
                here[x] = disparity
                right_edges[x - disparity + 1] = 0
