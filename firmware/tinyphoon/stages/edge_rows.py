"""Rows of both edge stores, without level edges: one as a list, and those around it in windows.

Edges whose gradient looks up or down belong to lines along the row, whose edges are all alike.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u16, u32

REACH = 2
"""Rows above and below that support a pair; as many columns on both sides: an edge that leans by 45 degrees."""

WINDOW_ROWS = 2 * REACH + 1


@kernel
def is_level(edge: u32, level_range: i32) -> i32:
    """Return 1 for an edge whose gradient looks up or down, to less than `level_range`; else 0."""
    # half a turn is 128: above 0 and below twice the range, counted from this much before straight down
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
    """Put row `y` of the edge store into a window; rows outside the picture are empty."""
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
    """Put row `y` of the edge store that core B shares into a window; rows outside the picture are empty."""
    here: u32 = 0
    if 0 <= y < len(right_rows):
        here = right_rows[y]
    spread_edges(right_edges, i32(here & 0xFFFF), i32(here >> 16), window, slot, level_range)
