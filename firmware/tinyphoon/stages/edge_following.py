"""What the disparities around say of an edge's: most things go on in the next rows, at nearly the depth that they have here.

A pair that matched by itself (`edge_correspondence.py`) is believed if pairs in two of the four rows around have its disparity,
to a pixel. An unsure pair, which is on its row's path but has rivals, is believed if the next pair in its row that is believed has
its disparity, to a pixel, and all four rows have it on their paths. An edge that is left then follows those that are believed, in
its row and the two below: it takes the most similar of the right edges at their disparities. The rows above it must not follow:
whether they are believed is not known yet, and what is wrong there would be followed here and then believed for it. There are few
disparities to choose from, so its gradient may be turned farther than that of a pair which had the whole row, and they may lie
farther beside it: contours lean, and many things are as deep a little farther on.

A row of disparities holds by the column of each left edge its disparity in pixels and 1, negative if that is unsure, or 0 for none.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u16, u32
from tinyphoon.stages.edge_correspondence import WORST, unlike

OFFER_BITS = 12
"""More than the disparities of any picture need."""

NO_OFFER = WORST << OFFER_BITS

LEAST_SUPPORT = 2
"""Rows around that must have a disparity: chance gives one of the four easily, but seldom two."""

BESIDE = 16
"""How much more alike a pair must be that differs from the disparity it follows by a pixel: most things go on at the same."""

FOLLOW_REACH = 12
"""Columns to both sides of an edge in which it finds disparities to follow."""


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
    """Return 1 if an edge `away` from column `x` at most has a sure disparity (and 1) that is this one to a pixel; else 0."""
    for column in range(max(x - away, 0), min(x + away, len(disparities) - 1) + 1):
        known = i32(disparities[column])
        if known > 0 and abs(known - disparity) <= 1:
            return 1
    return 0


@kernel
def like_beside(disparities: i16[:], x: i32, away: i32, disparity: i32) -> i32:
    """Return the disparity (and 1), sure or not, of an edge `away` from column `x` at most that is this one to a pixel; else 0."""
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
    """Take the sure disparities of a row away that the rows around do not believe, and from `right_edges` the edges of the others.

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
    """Make the unsure disparities of a row sure that all rows around have, and the nearest sure one on a side of the row.

    Those to the right of what is believed come first, then those to the left of it. A right edge belongs to one only.
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
    """Return how unlike `edge` the right edge is that is most like it of those that a row offers.

    These are those at the disparities of the edges FOLLOW_REACH from its column at most, and a pixel beside; `row` has the
    row's `count` edges, of which those before place `first` are farther away. The lower OFFER_BITS are the disparity and 1;
    without an offer it is NO_OFFER or more.
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
    """Return the place, from `first` on, of the first edge of a row that is not too far to the left of column `x`."""
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
    """Give the left edges of a row that have no sure disparity one of those around; a right edge belongs to one only."""
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
