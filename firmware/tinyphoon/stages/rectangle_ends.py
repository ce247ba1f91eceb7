"""Both ends of a goal's blob: their rows, and whether something in front of the goal hides what stands there [ours].

A goal stands on its posts, at both ends of its blob. Seen at an angle, its blob is no rectangle: the farther post ends
above the nearer one. So the opened image tells which rows an end has, unless the picture's border cuts it off: there is
no post there, and it has the rows of the blob. If another thing stands in front of an end, the blob ends at that
thing's border, and with the goal's back, which is farther away. But the border continues below the blob, where beneath
a post there is only floor: so edges tell.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, i16, i32, kernel, u16, u32
from tinyphoon.stages.line_segments import is_flat
from tinyphoon.stores.blobs import (
    ACROSS,
    BLOB_WORDS,
    COLOURS,
    DOWN,
    extent_of,
    is_cut_before,
    is_cut_behind,
)
from tinyphoon.stores.edges import edge_store
from tinyphoon.stores.rectangles import (
    RECTANGLE_BLOB,
    RECTANGLE_HIDDEN,
    RECTANGLE_LEFT_ROWS,
    RECTANGLE_RIGHT_ROWS,
    RECTANGLE_WORDS,
    rows_at,
    store_rows,
)

NONE = -1

# A post leans by at most five columns if the camera looks down by 10 degrees, and pairs of pixels share their colour.
END_PX = 8
LEAN_PX = 2  # from row to row; a faster slope is the goal's bottom, seen at an angle

LEFT_HIDDEN = 1
RIGHT_HIDDEN = 2

FOOT_PX = 3  # how far below its colour there are edges of a post's foot
BESIDE_PX = 2  # the opening rounds a blob's border, and an edge lies where the colours change


@kernel
def next_goal(rectangles: i16[:], rectangle: i32, count: i32, blob_data: u32[:], goals: u32) -> i32:
    """Return the first rectangle from number `rectangle` on with a colour of `goals`, or `count`."""
    while rectangle < count:
        blob = i32(rectangles[rectangle * RECTANGLE_WORDS + RECTANGLE_BLOB])
        if blob_data[blob * BLOB_WORDS + COLOURS] & goals != 0:
            return rectangle
        rectangle = rectangle + 1
    return count


@kernel
def open_end(rectangles: i16[:], rectangle: i32, end: i32, blob_data: u32[:], width: i32) -> i32:
    """Begin a rectangle's end without rows, and return its first column; NONE if a picture `width` wide cuts it off."""
    blob = i32(rectangles[rectangle * RECTANGLE_WORDS + RECTANGLE_BLOB])
    across = blob_data[blob * BLOB_WORDS + ACROSS]
    down = blob_data[blob * BLOB_WORDS + DOWN]
    if (is_cut_before(across) if end == RECTANGLE_LEFT_ROWS else is_cut_behind(across, width)) != 0:
        return NONE
    store_rows(rectangles, rectangle, end, i32(down >> 16), i32(down & 0xFFFF))
    if end == RECTANGLE_LEFT_ROWS:
        return min(i32(across & 0xFFFF), width - END_PX)
    return max(i32(across >> 16) - END_PX + 1, 0)


@kernel
def rows_of_blob(rectangles: i16[:], rectangle: i32, blob_data: u32[:]) -> u32:
    """Return the rows of a rectangle's blob, as a pair of shorts."""
    return blob_data[rectangles[rectangle * RECTANGLE_WORDS + RECTANGLE_BLOB] * BLOB_WORDS + DOWN]


@kernel
def see_end_row(
    opened: u32[:], y: i32, rectangles: i16[:], rectangle: i32, end: i32, blob_data: u32[:], inside: i32
) -> i32:
    """Add row `y` to an end's rows if its border is there: the outermost pixel of the blob's colours in its columns.

    In the row above, the border was `inside` columns from the outermost one; return the number for this row.
    """
    colours = blob_data[rectangles[rectangle * RECTANGLE_WORDS + RECTANGLE_BLOB] * BLOB_WORDS + COLOURS]
    farthest = min(inside + LEAN_PX, END_PX - 1)
    for step in range(farthest + 1):
        x = step if end == RECTANGLE_LEFT_ROWS else END_PX - 1 - step
        if opened[x] & colours != 0:
            rows = rows_at(rectangles, rectangle, end)
            store_rows(rectangles, rectangle, end, min(i32(rows & 0xFFFF), y), y)
            return step
    return farthest


@kernel
def has_upright_edge(edge_data: u32[:], edge_index: u32[:], edge_counts: u16[:], column: i32, y: i32) -> i32:
    """Return 1 if row `y` has an edge near a column that goes up or down; else 0."""
    first = i32(edge_index[y])
    for position in range(first, first + edge_counts[y]):
        edge = edge_data[position]
        if abs(i32(edge >> 16) - column) <= BESIDE_PX and is_flat(i32(edge >> 8 & 255)) == 0:
            return 1
    return 0


@kernel
def goes_on_below(edge_data: u32[:], edge_index: u32[:], edge_counts: u16[:], column: i32, rows: u32) -> i32:
    """Return 1 if upright edges continue below an end near a column, in most of half as many rows as it has; else 0.

    Rows beyond the picture have none.
    """
    first = i32(rows >> 16) + 1 + FOOT_PX
    last = min(first + (extent_of(rows) >> 1), len(edge_index))
    found = 0
    for y in range(first, last):
        found = found + has_upright_edge(edge_data, edge_index, edge_counts, column, y)
    return 1 if 4 * found > extent_of(rows) else 0


@kernel
def mark_hidden_ends(
    rectangles: i16[:],
    count: i32,
    blob_data: u32[:],
    goals: u32,
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    width: i32,
) -> None:
    """Store which ends of the first `count` rectangles are hidden, for those with a colour of `goals`.

    Ends that the border of a picture `width` pixels wide cuts off are not hidden.
    """
    for number in range(count):
        at = number * RECTANGLE_WORDS
        blob = i32(rectangles[at + RECTANGLE_BLOB])
        hidden: i32 = 0
        if blob_data[blob * BLOB_WORDS + COLOURS] & goals != 0:
            across = blob_data[blob * BLOB_WORDS + ACROSS]
            if is_cut_before(across) == 0:
                rows = rows_at(rectangles, number, RECTANGLE_LEFT_ROWS)
                if goes_on_below(edge_data, edge_index, edge_counts, i32(across & 0xFFFF), rows) != 0:
                    hidden = LEFT_HIDDEN
            if is_cut_behind(across, width) == 0:
                rows = rows_at(rectangles, number, RECTANGLE_RIGHT_ROWS)
                if goes_on_below(edge_data, edge_index, edge_counts, i32(across >> 16), rows) != 0:
                    hidden = hidden | RIGHT_HIDDEN
        rectangles[at + RECTANGLE_HIDDEN] = hidden


def rows_of_ends(core: Core, frame: Frame, rectangles: int, goals: int) -> Generator[Any, Any, None]:
    """Store the rows of both ends of the first `rectangles` rectangles, for those that are `goals` by colour."""
    table, blobs = core.array("rectangles"), core.array("blob_data")
    goal = yield core.run(next_goal, table, 0, rectangles, blobs, goals)
    while goal < rectangles:
        rows = yield core.run(rows_of_blob, table, goal, blobs)
        top, bottom = rows & 0xFFFF, rows >> 16
        for end in (RECTANGLE_LEFT_ROWS, RECTANGLE_RIGHT_ROWS):
            column = yield core.run(open_end, table, goal, end, blobs, frame.width)
            if column == NONE:
                continue
            image = core.part(core.rows("opened_image")[top : bottom + 1], column, END_PX)
            opened = core.input_ring(image, core.part(core.rows("opened_ring"), 0, END_PX))
            inside = END_PX
            for y in range(top, bottom + 1):
                core.at(y, range(column, column + END_PX))
                line = yield from opened.line()
                inside = yield core.run(see_end_row, line, y, table, goal, end, blobs, inside)
        core.at()
        goal = yield core.run(next_goal, table, goal + 1, rectangles, blobs, goals)


def hidden_ends(core: Core, frame: Frame, rectangles: int, goals: int) -> Generator[Any, Any, None]:
    """Store which ends of the first `rectangles` rectangles are hidden, for those that are `goals` by colour."""
    limits = core.array("blob_data"), goals
    yield core.run(
        mark_hidden_ends, core.array("rectangles"), rectangles, *limits, *edge_store(core), frame.width
    )
