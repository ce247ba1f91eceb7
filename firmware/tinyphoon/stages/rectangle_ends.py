"""Both ends of a goal's blob: which rows they have, and whether something before the goal hides what stands there [ours].

A goal stands on its posts, at both ends of its blob. Where another thing stands before an end, the blob ends at that thing's
border, and with the goal's back, which is farther away. But the border goes on down below the blob, where beneath a post
there is only floor: so edges tell.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, i16, i32, kernel, u8, u16, u32
from tinyphoon.stages.line_segments import is_flat
from tinyphoon.stores.blobs import (
    ACROSS,
    BLOB_WORDS,
    COLOURS,
    DOWN,
    extent_of,
    is_cut_before,
    is_cut_behind,
    wider,
)
from tinyphoon.stores.edges import edge_store
from tinyphoon.stores.rectangles import RECTANGLE_BLOB, RECTANGLE_HIDDEN, RECTANGLE_WORDS

NO_PART = -1

LEFT_HIDDEN = 1
RIGHT_HIDDEN = 2

FOOT_PX = 3  # so far below its colour there are edges of a post's foot
BESIDE_PX = 2  # the opening rounds a blob's border, and an edge lies where the colours change


@kernel
def is_above(across: u32, other: u32) -> i32:
    """Return 1 if two blobs have half the columns of the narrower one in common: one stands above the other; else 0."""
    common = min(i32(across >> 16), i32(other >> 16)) + 1 - max(i32(across & 0xFFFF), i32(other & 0xFFFF))
    return 1 if 2 * common >= min(extent_of(across), extent_of(other)) else 0


@kernel
def rows_at_end(blob_data: u32[:], parents: u8[:], blob: i32, is_right: i32) -> u32:
    """Return the rows of the part of a blob that reaches farthest to the left or to the right, with those that it stands on.

    A blob without parts has its own rows. Parts come before the blob.
    """
    across = blob_data[blob * BLOB_WORDS + ACROSS]
    rows = blob_data[blob * BLOB_WORDS + DOWN]
    end: i32 = NO_PART
    for part in range(blob):
        apart = blob_data[part * BLOB_WORDS + ACROSS] ^ across
        if parents[part] == blob and (apart >> 16 if is_right != 0 else apart & 0xFFFF) == 0:
            end = part
            rows = blob_data[part * BLOB_WORDS + DOWN]
    if end != NO_PART:
        across = blob_data[end * BLOB_WORDS + ACROSS]
        for part in range(blob):
            down = blob_data[part * BLOB_WORDS + DOWN]
            if parents[part] == blob and is_above(across, blob_data[part * BLOB_WORDS + ACROSS]) != 0:
                rows = wider(rows, i32(down & 0xFFFF), i32(down >> 16))
    return rows


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
    """Return 1 if upright edges go on below an end of a blob near a column, in most of half as many rows as it has; else 0.

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
    parents: u8[:],
    goals: u32,
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    width: i32,
) -> None:
    """Store which ends of the first `count` rectangles are hidden, of those that have a colour of `goals`.

    What the border of a picture `width` pixels wide cuts off is not hidden.
    """
    for at in range(0, count * RECTANGLE_WORDS, RECTANGLE_WORDS):
        blob = i32(rectangles[at + RECTANGLE_BLOB])
        hidden: i32 = 0
        if blob_data[blob * BLOB_WORDS + COLOURS] & goals != 0:
            across = blob_data[blob * BLOB_WORDS + ACROSS]
            if is_cut_before(across) == 0:
                rows = rows_at_end(blob_data, parents, blob, 0)
                if goes_on_below(edge_data, edge_index, edge_counts, i32(across & 0xFFFF), rows) != 0:
                    hidden = LEFT_HIDDEN
            if is_cut_behind(across, width) == 0:
                rows = rows_at_end(blob_data, parents, blob, 1)
                if goes_on_below(edge_data, edge_index, edge_counts, i32(across >> 16), rows) != 0:
                    hidden = hidden | RIGHT_HIDDEN
        rectangles[at + RECTANGLE_HIDDEN] = hidden


def hidden_ends(core: Core, frame: Frame, rectangles: int, goals: int) -> Generator[Any, Any, None]:
    """Say of the first `rectangles` rectangles which of their ends something hides, if they are `goals` by their colours."""
    blobs = core.array("blob_data"), core.array("label_parents")
    yield core.run(
        mark_hidden_ends, core.array("rectangles"), rectangles, *blobs, goals, *edge_store(core), frame.width
    )
