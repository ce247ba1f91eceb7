"""The scan of the edge store for line segments: connected edges of one gradient direction (T §5.2.2, step 1).

Adjacent edges in a row form a run; a run goes to the first segment of the row above that it touches and agrees with, or
starts a new one.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u16, u32
from tinyphoon.stages.line_segments import (
    DIRECTION,
    EDGES,
    FREE,
    LAST_ROW,
    NONE,
    SEGMENT_WORDS,
    TURN,
    UNPLACED,
    add_edge,
    line_length,
    new_segment,
    turn_between,
)


@kernel
def run_length(edge_data: u32[:], begin: i32, stop: i32, angle_range: i32, mean_edges: i32) -> i32:
    """Return how many edges from `begin` on are adjacent, each within `angle_range` of the mean before it.

    The mean is that of the run's first `mean_edges` edges: a curve leaves it sooner than a mean that follows it.
    """
    x = i32(edge_data[begin] >> 16)
    direction = i32(edge_data[begin] >> 8 & 255)
    turns = 0
    averaged = 1
    length = 1
    while begin + length < stop and i32(edge_data[begin + length] >> 16) == x + length:
        turn = turn_between(i32(edge_data[begin + length] >> 8 & 255), direction)
        if abs(turn * averaged - turns) > angle_range * averaged:
            break
        if averaged < mean_edges:
            turns = turns + turn
            averaged = averaged + 1
        length = length + 1
    return length


@kernel
def run_turn(edge_data: u32[:], begin: i32, averaged: i32) -> i32:
    """Return the sum of the first `averaged` edges' turns from the direction of the run's first one."""
    direction = i32(edge_data[begin] >> 8 & 255)
    turns = 0
    for edge in range(begin + 1, begin + averaged):
        turns = turns + turn_between(i32(edge_data[edge] >> 8 & 255), direction)
    return turns


@kernel
def touched_segment(
    above: u8[:],
    segments: i32[:],
    left: i32,
    right: i32,
    direction: i32,
    turns: i32,
    averaged: i32,
    angle_range: i32,
    mean_edges: i32,
) -> i32:
    """Return the place of the segment that a run from `left` to `right` continues, or NONE.

    Its direction is the mean `direction + turns / averaged`; both means are compared without division.
    """
    label = 0
    for x in range(max(left - 1, 0), min(right + 1, len(above) - 1) + 1):
        if above[x] != 0 and above[x] != label:
            label = above[x]
            base = (label - 1) * SEGMENT_WORDS
            mean_of = min(segments[base + EDGES], mean_edges)
            turn = turn_between(direction, segments[base + DIRECTION])
            apart = (turn * averaged + turns) * mean_of - segments[base + TURN] * averaged
            if abs(apart) <= angle_range * averaged * mean_of:
                return label - 1
    return NONE


@kernel
def close_segments(
    edge_data: u32[:],
    begin: i32,
    stop: i32,
    above: u8[:],
    segments: i32[:],
    scan: i32[:],
    y: i32,
    min_length: i32,
) -> None:
    """Clear the labels of the row above row `y`, and empty segments that ended in it shorter than `min_length`."""
    for edge in range(begin, stop):
        x = i32(edge_data[edge] >> 16)
        if above[x] != 0:
            place = above[x] - 1
            above[x] = 0
            base = place * SEGMENT_WORDS
            length = line_length(segments, base)
            if segments[base + LAST_ROW] < y and 0 < length < min_length:
                segments[base + EDGES] = 0
                segments[base + LAST_ROW] = scan[FREE]
                scan[FREE] = place


@kernel
def segments_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    above: u8[:],
    here: u8[:],
    segments: i32[:],
    scan: i32[:],
    angle_range: i32,
    mean_edges: i32,
    min_length: i32,
) -> None:
    """Add the edges of row `y` to segments.

    `above` and `here` hold for each x the segment of the edge there, counted from 1, in the row above and in this one.
    Afterwards `above` is empty, ready to be `here` of the next row.
    """
    begin = i32(edge_index[y])
    stop = begin + edge_counts[y]
    while begin < stop:
        length = run_length(edge_data, begin, stop, angle_range, mean_edges)
        left = i32(edge_data[begin] >> 16)
        direction = i32(edge_data[begin] >> 8 & 255)
        averaged = min(length, mean_edges)
        turns = run_turn(edge_data, begin, averaged)
        place = touched_segment(
            above, segments, left, left + length - 1, direction, turns, averaged, angle_range, mean_edges
        )
        if place == NONE:
            place = new_segment(segments, scan, left, y, direction)
        if place == NONE:
            scan[UNPLACED] = scan[UNPLACED] + length
        else:
            for edge in range(begin, begin + length):
                x = i32(edge_data[edge] >> 16)
                add_edge(segments, place, x, y, i32(edge_data[edge] >> 8 & 255), mean_edges)
                here[x] = place + 1
        begin = begin + length
    if y > 0:
        begin = i32(edge_index[y - 1])
        close_segments(edge_data, begin, begin + edge_counts[y - 1], above, segments, scan, y, min_length)
