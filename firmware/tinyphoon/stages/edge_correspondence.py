"""Which edge of the other picture corresponds to an edge of this one (T §5.2.8).

The pictures are rectified, so both show a point in the same row. The plain way of the thesis (`thesis_edges.py`) takes the
nearest edge, which has the least disparity. The better way, ours, asks the rows around: a disparity continues in the next
rows, along the edge. A pair's score is the difference of its gradients plus, for each of four rows around, that of the most
similar pair of the same disparity beside the edge. The pair with the least score must be the best for both its edges, by a
margin, must have support in at least one row, and must be on the path through the row. A pair on the path that fails the rest
is unsure. Which pairs are believed, and which others are added, is decided by the disparities around (`edge_following.py`).

The *path* is the largest set of pairs of a row that are in the same order in both pictures (stereo by dynamic
programming, as Ohta and Kanade have it). Things side by side are seen in the same order by both cameras, unless
something thin stands far before the rest. So if one square of a board is like the next, their number tells them apart,
and so does what lies beyond the board. Left edges nearer to the border than the disparity of the path's first pair are
beyond the right picture's, and right edges likewise beyond the left picture's by the last pair's: they have no partner
and need none. Without that, a board that one picture cuts would have as many pairs a square further on, and more
beyond. Of paths with equally many pairs, the better one has more similar pairs, and smaller steps of disparity between
them. The path is found while the pairs come in, left edges from left to right, the right ones of each from right to
left: for each right edge, `values` tells how good the best path is that ends there or before, and `ends` with which
link; after the last edge they tell it of whole paths. A link is a pair and the link before it; link 0 is none.
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u16, u32
from tinyphoon.stages.edge_rows import REACH, WINDOW_ROWS
from tinyphoon.stages.line_segments import turn_between

WORST = 0xFFFF

# A link.
LINK_BEFORE, LINK_LEFT, LINK_RIGHT = 0, 1, 2
LINK_WORDS = 3

STEP = 4
"""The cost on a path of each pixel that the disparity changes by: 8 px cost as much as a row without support."""

UNSEEN = WORST // 4
"""What a path gains by an edge beyond the other picture's border: half of what one in a pair is worth. It is explained, but nothing
speaks for it as for a pair: with as much as in a pair, a board without ends would be explained as well at any of its disparities."""


@kernel
def unlike(edge: i32, other: i32, direction_range: i32) -> i32:
    """Return how different two edges are, in gradient and direction, or WORST if their directions differ too much."""
    turn = abs(turn_between(other >> 8 & 255, edge >> 8 & 255))
    if turn > direction_range:
        return WORST
    return 2 * turn + abs((other & 255) - (edge & 255))


@kernel
def unlike_around(
    left_window: u16[:],
    right_window: u16[:],
    pitch: i32,
    slot: i32,
    x: i32,
    disparity: i32,
    direction_range: i32,
    lack: i32,
) -> i32:
    """Return how different the pairs around are that have this disparity, at most `lack` for each row.

    `slot` is the row of the windows with the edge in column `x`, `pitch` the columns of each row.
    """
    total = 0
    for step in range(WINDOW_ROWS):
        away = abs(step - REACH)
        if away != 0:
            row = slot + step - REACH
            if row < 0:
                row = row + WINDOW_ROWS
            if row >= WINDOW_ROWS:
                row = row - WINDOW_ROWS
            base = row * pitch
            least = lack
            for column in range(max(x - away, disparity), min(x + away, pitch - 1) + 1):
                edge = left_window[base + column]
                if edge != 0:
                    other = right_window[base + column - disparity]
                    if other != 0:
                        least = min(least, unlike(edge, other, direction_range))
            total = total + least
    return total


@kernel
def offer(
    left_row: u32[:], left: i32, right: i32, score: i32, bests: u16[:], rivals: u16[:], owners: u16[:]
) -> None:
    """Offer a right edge its pair with a left one; left edges come from left to right."""
    owner = owners[right]
    is_apart = 1
    if owner != 0 and i32(left_row[left] >> 16) - i32(left_row[owner - 1] >> 16) <= 1:
        is_apart = 0
    if score < bests[right]:
        if is_apart != 0:
            rivals[right] = bests[right]
        bests[right] = score
        owners[right] = left + 1
    elif is_apart != 0:
        rivals[right] = min(rivals[right], score)


@kernel
def first_behind(row: u32[:], first: i32, count: i32, x: i32) -> i32:
    """Return the place, from `first` on, of the first edge of a row to the right of column `x`."""
    while first < count and i32(row[first] >> 16) <= x:
        first = first + 1
    return first


@kernel
def clear_path(values: i32[:], ends: u16[:], right_count: i32) -> None:
    """Begin without a pair."""
    for right in range(right_count + 1):
        values[right] = 0
        ends[right] = 0


@kernel
def disparity_of(left_row: u32[:], left: i32, right_row: u32[:], right: i32) -> i32:
    """Return the disparity of a pair."""
    return i32(left_row[left] >> 16) - i32(right_row[right] >> 16)


@kernel
def add_pair(
    left_row: u32[:],
    left: i32,
    right_row: u32[:],
    right: i32,
    right_count: i32,
    score: i32,
    unseen_left: i32,
    unseen_right: i32,
    values: i32[:],
    ends: u16[:],
    links: u16[:],
    used: i32,
) -> i32:
    """Add a pair to the paths that it improves; `used` links are taken. Return how many are taken then.

    `unseen_left` and `unseen_right` are how many edges of each picture lie beyond the other's border at the pair's
    disparity. A pair without room for its link is in no path.
    """
    gain = WORST - score  # large enough for the path with more pairs to win
    value = gain + UNSEEN * unseen_left
    before = 0
    if right > 0 and ends[right - 1] != 0:
        last = LINK_WORDS * ends[right - 1]
        step = disparity_of(left_row, left, right_row, right) - disparity_of(
            left_row, i32(links[last + LINK_LEFT]), right_row, i32(links[last + LINK_RIGHT])
        )
        onward = gain + values[right - 1] - STEP * abs(step)
        if onward > value:
            value = onward
            before = i32(ends[right - 1])
    whole = value + UNSEEN * unseen_right
    link = LINK_WORDS * used
    if (value <= values[right] and whole <= values[right_count]) or link + LINK_WORDS > len(links):
        return used
    links[link + LINK_BEFORE] = before
    links[link + LINK_LEFT] = left
    links[link + LINK_RIGHT] = right
    if whole > values[right_count]:
        values[right_count] = whole
        ends[right_count] = used
    place = right
    while place < right_count and values[place] < value:
        values[place] = value
        ends[place] = used
        place = place + 1
    return used + 1


@kernel
def columns_apart(row: u32[:], one: i32, other: i32) -> i32:
    """Return how many columns apart two edges of a row are."""
    return abs(i32(row[one] >> 16) - i32(row[other] >> 16))


@kernel
def take_path(
    left_row: u32[:],
    left_count: i32,
    right_row: u32[:],
    partners: i16[:],
    bests: u16[:],
    rivals: u16[:],
    owners: u16[:],
    margin: i32,
    links: u16[:],
    end: i32,
) -> None:
    """Give left edges their partners on the path ending with link `end`; unsure ones, off the best, are negative.

    `partners` comes with the best of each left edge, or 0 where that has a rival.
    """
    link = LINK_WORDS * end
    for left in range(left_count - 1, -1, -1):
        best = i32(partners[left])
        partners[left] = 0
        if link != 0 and i32(links[link + LINK_LEFT]) == left:
            right = i32(links[link + LINK_RIGHT])
            link = LINK_WORDS * i32(links[link + LINK_BEFORE])
            partners[left] = -(right + 1)
            has_rival = best == 0 or i32(bests[right]) + margin > i32(rivals[right])
            if not has_rival and (
                columns_apart(right_row, best - 1, right) <= 1
                and columns_apart(left_row, i32(owners[right]) - 1, left) <= 1
            ):
                partners[left] = right + 1


@kernel
def match_edges(
    left_row: u32[:],
    left_count: i32,
    right_row: u32[:],
    right_count: i32,
    left_window: u16[:],
    right_window: u16[:],
    slot: i32,
    partners: i16[:],
    bests: u16[:],
    rivals: u16[:],
    owners: u16[:],
    values: i32[:],
    ends: u16[:],
    links: u16[:],
    direction_range: i32,
    max_disparity: i32,
    lack: i32,
    margin: i32,
) -> None:
    """Set for each left edge the place of its partner in the right row, from 1 on, negative if it is unsure, or 0.

    `bests`, `rivals` and `owners` are room for the right row: the least score, the rival's score, and the owner of the
    least; `values`, `ends` and `links` are for the path. A rival is the best of the others more than a pixel away.
    Pairs beyond the wanted depth take part: an edge whose true partner is there must not get another.
    """
    for right in range(right_count):
        bests[right] = WORST
        rivals[right] = WORST
        owners[right] = 0
    clear_path(values, ends, right_count)
    pitch = len(left_window) // WINDOW_ROWS
    behind = 0
    used = 1
    for left in range(left_count):
        edge = left_row[left]
        x = i32(edge >> 16)
        best = WORST
        rival = WORST
        best_x = x
        partner = 0
        behind = first_behind(right_row, behind, right_count, x)
        seen_left = 0
        seen_right = right_count
        for right in range(behind - 1, -1, -1):
            other = right_row[right]
            other_x = i32(other >> 16)
            disparity = x - other_x
            if disparity > max_disparity:
                break
            score = unlike(i32(edge & 0xFFFF), i32(other & 0xFFFF), direction_range)
            if score < WORST:
                around = unlike_around(
                    left_window, right_window, pitch, slot, x, disparity, direction_range, lack
                )
                score = score + around
                if score < best:
                    if best_x - other_x > 1:
                        rival = best
                    best = score
                    best_x = other_x
                    partner = right + 1 if around < (WINDOW_ROWS - 1) * lack else 0
                elif best_x - other_x > 1:
                    rival = min(rival, score)
                offer(left_row, left, right, score, bests, rivals, owners)
                seen_left = first_behind(left_row, seen_left, left, disparity - 1)
                while i32(right_row[seen_right - 1] >> 16) + disparity >= pitch:
                    seen_right = seen_right - 1
                used = add_pair(
                    left_row,
                    left,
                    right_row,
                    right,
                    right_count,
                    score,
                    seen_left,
                    right_count - seen_right,
                    values,
                    ends,
                    links,
                    used,
                )
        partners[left] = partner if best + margin <= rival else 0
    end = i32(ends[right_count])
    take_path(left_row, left_count, right_row, partners, bests, rivals, owners, margin, links, end)
