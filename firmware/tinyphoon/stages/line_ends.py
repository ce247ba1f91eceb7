"""The scan for line segments as in T §5.2.2: each edge is compared with the ends of the lines in the table.

[said] An edge that lies next to the end of a line, and is within the angle range of its mean
direction, becomes its new end; on lines that become flat from the right to the left it is
compared with the start (T §5.2.2, step 1). [implied] So every edge is compared with the lines
of the table until one takes it. [assumed] "Next to" is one of the eight neighbours; what ended
too short leaves its place to others, as in `line_scan.py`, or the table would be full of noise.

Its lines differ from those of `line_scan.py` where runs of edges fit two segments.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, i32, kernel, u16, u32
from tinyphoon.stages.line_detection import LineThresholds
from tinyphoon.stages.line_segments import (
    DIRECTION,
    EDGES,
    END_X,
    END_Y,
    FREE,
    LAST_ROW,
    NONE,
    SEGMENT_WORDS,
    START_X,
    START_Y,
    TURN,
    UNPLACED,
    add_edge,
    clear_segments,
    is_flat,
    line_length,
    new_segment,
    turn_between,
)
from tinyphoon.stores.edges import edge_columns, edge_store


@kernel
def is_next_to(x: i32, y: i32, end_x: i32, end_y: i32) -> i32:
    """Return 1 if a pixel is a neighbour of another one, or the same; else 0."""
    return 1 if abs(x - end_x) <= 1 and abs(y - end_y) <= 1 else 0


@kernel
def continued_line(
    segments: i32[:], x: i32, y: i32, direction: i32, angle_range: i32, mean_edges: i32
) -> i32:
    """Return the place of the first line in the table that an edge continues, or NONE."""
    for place in range(len(segments) // SEGMENT_WORDS):
        base = place * SEGMENT_WORDS
        if segments[base + EDGES] != 0:
            near = is_next_to(x, y, segments[base + END_X], segments[base + END_Y])
            if near == 0 and is_flat(segments[base + DIRECTION]) != 0:
                near = is_next_to(x, y, segments[base + START_X], segments[base + START_Y])
            if near != 0:
                mean_of = min(segments[base + EDGES], mean_edges)
                turn = turn_between(direction, segments[base + DIRECTION])
                if abs(turn * mean_of - segments[base + TURN]) <= angle_range * mean_of:
                    return place
    return NONE


@kernel
def close_lines(segments: i32[:], scan: i32[:], y: i32, min_length: i32) -> None:
    """Empty the places of lines that ended before row `y - 1` and are shorter than `min_length`."""
    for place in range(len(segments) // SEGMENT_WORDS):
        base = place * SEGMENT_WORDS
        is_over = segments[base + EDGES] != 0 and segments[base + LAST_ROW] < y - 1
        if is_over and line_length(segments, base) < min_length:
            segments[base + EDGES] = 0
            segments[base + LAST_ROW] = scan[FREE]
            scan[FREE] = place


@kernel
def lines_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    segments: i32[:],
    scan: i32[:],
    angle_range: i32,
    mean_edges: i32,
) -> None:
    """Add the edges of row `y` to lines, one by one."""
    first = i32(edge_index[y])
    for position in range(first, first + edge_counts[y]):
        x = i32(edge_data[position] >> 16)
        direction = i32(edge_data[position] >> 8 & 255)
        place = continued_line(segments, x, y, direction, angle_range, mean_edges)
        if place == NONE:
            place = new_segment(segments, scan, x, y, direction)
        if place == NONE:
            scan[UNPLACED] = scan[UNPLACED] + 1
        else:
            add_edge(segments, place, x, y, direction, mean_edges)


def scan_by_ends(core: Core, frame: Frame, thresholds: LineThresholds) -> Generator[Any, Any, None]:
    """Scan the edge store, row by row; leave segments in their table, as `scan_by_labels` does."""
    store, segments, scan = edge_store(core), core.array("segments"), core.array("line_scan")
    yield core.run(clear_segments, segments, scan, *core.rows("line_labels"))
    for y in range(frame.height):
        core.at(y, edge_columns, store, y)
        yield core.run(close_lines, segments, scan, y, thresholds.min_length)
        row = *store, y, segments, scan
        yield core.run(lines_row, *row, thresholds.angle_range, thresholds.mean_edges)
    core.at()
