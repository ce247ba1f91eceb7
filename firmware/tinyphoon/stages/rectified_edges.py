"""Edges, moved to their places in the rectified picture (T §7.2).

An edge of the store has a whole column and its row, so its new place is rounded both ways,
and the store is in the order of rows: the edges of a camera's row go to several. They are
written to their new rows in SDRAM, where candidates of the edge detection were before, and
read back row by row through DMA into the store, as much of each row as the longest one has.

Where the lens is stretched back, a chain of edges gets gaps: a row or a column in which none comes to lie.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, i16, i32, kernel, u16, u32
from tinyphoon.exchange import as_words
from tinyphoon.stages.edge_thinning import clear_levels
from tinyphoon.stages.rectified_places import (
    COLUMNS,
    CORNER_X,
    CORNER_Y,
    NODE_BITS,
    NODE_PX,
    NODES,
)
from tinyphoon.stores.edges import edge_columns, edge_store

CELL_BITS = NODE_BITS - 4  # of pixels
PLACE_BITS = 2 * CELL_BITS + 4
HALF_PIXEL = 1 << PLACE_BITS - 1
NO_CELL = -1


@kernel
def level_at(places: i16[:], node: i32, under: i32, below: i32) -> i32:
    """Return the value `below` pixels below a node's word, interpolated to that `under` it, in 1/16 px / NODE_PX."""
    return NODE_PX * places[node] + (places[under] - places[node]) * below


@kernel
def move_edges_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    places: i16[:],
    moved: u32[:],
    moved_counts: u16[:],
    width: i32,
) -> None:
    """Append the edges of row `y` to the rows of `moved` where they now lie; `moved_counts` are the edges of each.

    A row has room for `width` edges. Edges outside of the picture are left out. The table's columns are interpolated
    once for all edges of a row between them.
    """
    corner_x = i32(places[CORNER_X])
    corner_y = i32(places[CORNER_Y])
    pitch = 2 * places[COLUMNS]
    row_of_nodes = NODES + pitch * (y + corner_y >> CELL_BITS)
    below = y + corner_y & NODE_PX - 1
    cell = NO_CELL
    left_x = 0
    left_y = 0
    across = 0
    down = 0
    first = i32(edge_index[y])
    for position in range(first, first + edge_counts[y]):
        edge = edge_data[position]
        x = i32(edge >> 16) + corner_x
        if x >> CELL_BITS != cell:
            cell = x >> CELL_BITS
            node = row_of_nodes + 2 * cell
            under = node + pitch
            left_x = level_at(places, node, under, below)
            left_y = level_at(places, node + 1, under + 1, below)
            across = level_at(places, node + 2, under + 2, below) - left_x
            down = level_at(places, node + 3, under + 3, below) - left_y
        right = x & NODE_PX - 1
        column = u32((NODE_PX * left_x + across * right + HALF_PIXEL >> PLACE_BITS) - corner_x)
        row = u32((NODE_PX * left_y + down * right + HALF_PIXEL >> PLACE_BITS) - corner_y)
        if column < u32(width) and row < u32(len(moved_counts)):
            count = i32(moved_counts[row])
            if count < width:
                moved[i32(row) * width + count] = edge & 0xFFFF | column << 16
                moved_counts[row] = count + 1


@kernel
def longest_row(counts: u16[:]) -> i32:
    """Return the most edges that a row has, at least 1."""
    most = 1
    for y in range(len(counts)):
        most = max(most, i32(counts[y]))
    return most


@kernel
def sort_words(words: u32[:], count: i32) -> None:
    """Sort the first `count` words, which are nearly in order."""
    for place in range(1, count):
        word = words[place]
        to = place
        while to > 0 and words[to - 1] > word:
            words[to] = words[to - 1]
            to = to - 1
        words[to] = word


@kernel
def store_moved_row(
    moved: u32[:],
    moved_counts: u16[:],
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    kept: i32,
) -> i32:
    """Store the edges that were moved to row `y`, from left to right; if several share a column, the strongest.

    `kept` edges are stored before; return the number with this row.
    """
    count = i32(moved_counts[y])
    sort_words(moved, count)
    first = kept
    last: u32 = 0  # no edge: those have a gradient
    for place in range(count):
        edge = moved[place]
        if last == 0 or edge >> 16 != last >> 16:
            kept = kept + 1
        elif edge & 255 <= last & 255:
            edge = last
        edge_data[kept - 1] = edge
        last = edge
    edge_index[y] = first
    edge_counts[y] = kept - first
    return kept


def rectified_edges(core: Core, frame: Frame) -> Generator[Any, Any, int]:
    """Move the edges of the store; return, and publish as `edges_rectified`, how many are in the rectified picture."""
    store, places = edge_store(core), core.array("places")
    moved = as_words(core, "edge_candidates")
    counts, *_ = core.overlay("segments", u16, frame.height)  # the lines have been fitted
    yield core.run(clear_levels, counts)
    for y in range(frame.height):
        core.at(y, edge_columns, store, y)
        yield core.run(move_edges_row, *store, y, places, moved, counts, frame.width)
    most: int = yield core.run(longest_row, counts)
    written = core.part(core.rows("edge_candidates"), 0, most)
    rows = core.input_ring(written, core.overlay("candidate_ring", u32, most)[:2])
    kept = 0
    for y in range(frame.height):
        core.at(y)
        row = yield from rows.line()
        kept = yield core.run(store_moved_row, row, counts, *store, y, kept)
    core.at()
    core.publish(edges_rectified=kept)
    return kept
