"""Which edge of the other picture shows the same as an edge of this one (T §5.2.8).

The pictures are rectified, so both show a point in one row. The plain way of the thesis takes the nearest edge, which is
the one with the least disparity. The better way, ours, asks the rows around: what has a disparity has it in the next rows
too, along the edge. A pair's score is how unlike its gradients are, and for each of four rows around how unlike the most
similar pair of that disparity is that lies beside the edge. The pair with the least score must be the best of both its
edges, by a margin, and must have support in one row at least. Whether it is believed, and what else is, say the disparities
around (`edge_following.py`).
"""

from __future__ import annotations

from bfsim.api import i16, i32, kernel, u16, u32
from tinyphoon.geometry import store_point
from tinyphoon.stages.line_segments import NONE, turn_between
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.lines3d import EDGE3D_LEFT, EDGE3D_WORDS, EDGE3D_X

REACH = 2
"""Rows above and below that support a pair; as many columns to both sides: an edge that leans by 45 degrees."""

WINDOW_ROWS = 2 * REACH + 1
WORST = 0xFFFF


@kernel
def is_level(edge: u32, level_range: i32) -> i32:
    """Return 1 for an edge whose gradient looks up or down, to less than `level_range`; else 0."""
    # half a turn is 128: above 0 and below twice the range, counted from as far before straight down
    return 1 if (i32(edge >> 8) + level_range - 65 & 127) < 2 * level_range - 1 else 0


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
def take_left_row(
    edge_data: u32[:], edge_index: u32[:], edge_counts: u16[:], y: i32, row: u32[:], level_range: i32
) -> i32:
    """Copy row `y` of the edge store, without the level edges; return how many are left."""
    return take_edges(edge_data, i32(edge_index[y]), i32(edge_counts[y]), row, level_range)


@kernel
def take_right_row(right_edges: u32[:], right_rows: u32[:], y: i32, row: u32[:], level_range: i32) -> i32:
    """Copy row `y` of the edge store that core B shares, without the level edges; return how many are left."""
    here = right_rows[y]
    return take_edges(right_edges, i32(here & 0xFFFF), i32(here >> 16), row, level_range)


@kernel
def spread_edges(edges: u32[:], first: i32, count: i32, window: u16[:], slot: i32, level_range: i32) -> None:
    """Put `count` edges from place `first` on into a row of a window, by column, without the level ones.

    A column holds gradient and direction, or 0.
    """
    pitch = len(window) // WINDOW_ROWS
    base = slot * pitch
    for place in range(base, base + pitch):
        window[place] = 0
    for place in range(first, first + count):
        edge = edges[place]
        if is_level(edge, level_range) == 0:
            window[base + i32(edge >> 16)] = edge & 0xFFFF


@kernel
def spread_left_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    window: u16[:],
    slot: i32,
    level_range: i32,
) -> None:
    """Put row `y` of the edge store into a window; rows that the picture does not have are empty."""
    first = 0
    count = 0
    if 0 <= y < len(edge_counts):
        first = i32(edge_index[y])
        count = i32(edge_counts[y])
    spread_edges(edge_data, first, count, window, slot, level_range)


@kernel
def spread_right_row(
    right_edges: u32[:], right_rows: u32[:], y: i32, window: u16[:], slot: i32, level_range: i32
) -> None:
    """Put row `y` of the edge store that core B shares into a window; rows that the picture does not have are empty."""
    here: u32 = 0
    if 0 <= y < len(right_rows):
        here = right_rows[y]
    spread_edges(right_edges, i32(here & 0xFFFF), i32(here >> 16), window, slot, level_range)


@kernel
def unlike(edge: i32, other: i32, direction_range: i32) -> i32:
    """Return how unlike two edges are, both gradient and direction, or WORST if their directions differ too much."""
    turn = abs(turn_between(other >> 8 & 255, edge >> 8 & 255))
    if turn > direction_range:
        return WORST
    return 2 * turn + abs((other & 255) - (edge & 255))


@kernel
def match_nearest(
    left_row: u32[:],
    left_count: i32,
    right_row: u32[:],
    right_count: i32,
    partners: u16[:],
    direction_range: i32,
    min_disparity: i32,
    max_disparity: i32,
) -> None:
    """Set for each left edge the place of the nearest right one in the row, from 1 on, or 0 (T §5.2.8)."""
    for left in range(left_count):
        edge = left_row[left]
        partners[left] = 0
        # the others go to the right: their disparities fall
        for right in range(right_count):
            other = right_row[right]
            disparity = i32(edge >> 16) - i32(other >> 16)
            if disparity < min_disparity:
                break
            off = unlike(i32(edge & 0xFFFF), i32(other & 0xFFFF), direction_range)
            if disparity <= max_disparity and off < WORST:
                partners[left] = right + 1


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
    """Return how unlike the pairs around are that have this disparity, `lack` at most for each row.

    `slot` is the row of the windows that the edge in column `x` is in, `pitch` the columns of each row.
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
    """Let a right edge see its pair with a left one, as they come from left to right."""
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
def drop_contested(
    left_count: i32, partners: u16[:], bests: u16[:], rivals: u16[:], owners: u16[:], margin: i32
) -> None:
    """Leave left edges without a partner that is another's, or that has a rival nearly as good."""
    for left in range(left_count):
        right = partners[left] - 1
        if right >= 0 and (owners[right] != left + 1 or bests[right] + margin > rivals[right]):
            partners[left] = 0


@kernel
def match_edges(
    left_row: u32[:],
    left_count: i32,
    right_row: u32[:],
    right_count: i32,
    left_window: u16[:],
    right_window: u16[:],
    slot: i32,
    partners: u16[:],
    bests: u16[:],
    rivals: u16[:],
    owners: u16[:],
    direction_range: i32,
    max_disparity: i32,
    lack: i32,
    margin: i32,
) -> None:
    """Set for each left edge the place of its partner in the right row, from 1 on, or 0.

    `bests`, `rivals` and `owners` are room for the right row: least score, that of the rival, and whose the least is.
    A rival is the best of the others that are more than a pixel away. Pairs farther away than is wanted take part: an edge
    whose true partner is there must not get another.
    """
    for right in range(right_count):
        bests[right] = WORST
        rivals[right] = WORST
        owners[right] = 0
    pitch = len(left_window) // WINDOW_ROWS
    for left in range(left_count):
        edge = left_row[left]
        x = i32(edge >> 16)
        best = WORST
        rival = WORST
        best_x = NONE
        partner = 0
        for right in range(right_count):
            other = right_row[right]
            other_x = i32(other >> 16)
            if other_x > x:
                break
            score = WORST
            if x - other_x <= max_disparity:
                score = unlike(i32(edge & 0xFFFF), i32(other & 0xFFFF), direction_range)
            if score < WORST:
                around = unlike_around(
                    left_window, right_window, pitch, slot, x, x - other_x, direction_range, lack
                )
                score = score + around
                if score < best:
                    if other_x - best_x > 1:
                        rival = best
                    best = score
                    best_x = other_x
                    partner = right + 1 if around < (WINDOW_ROWS - 1) * lack else 0
                elif other_x - best_x > 1:
                    rival = min(rival, score)
                offer(left_row, left, right, score, bests, rivals, owners)
        partners[left] = partner if best + margin <= rival else 0
    drop_contested(left_count, partners, bests, rivals, owners, margin)


@kernel
def store_edges3d_row(
    edge_data: u32[:],
    edge_index: u32[:],
    y: i32,
    left_row: u32[:],
    left_count: i32,
    disparities: u16[:],
    min_disparity: i32,
    geometry: i32[:],
    width: i32,
    height: i32,
    edges_3d: i16[:],
    found: i32,
) -> i32:
    """Store the 3-D edges of row `y`: left edges with a disparity, in `disparities` and 1 more, that are not too far away.

    `found` is how many the rows before gave; returns it with this row. Those beyond the length of `edges_3d` are counted,
    not stored.
    """
    place = i32(edge_index[y])
    for left in range(left_count):
        edge = left_row[left]
        x = i32(edge >> 16)
        disparity = i32(disparities[x]) - 1
        if disparity >= min_disparity:
            base = EDGE3D_WORDS * found
            stored = 1
            if base < len(edges_3d):
                stored = store_point(
                    geometry,
                    SUBPIXELS * x,
                    SUBPIXELS * y,
                    SUBPIXELS * disparity,
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
