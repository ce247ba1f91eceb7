"""Line segments: connected edges of one gradient direction, found row by row in the edge store (T §5.2.2, step 1).

A table of segments takes the place of a look-up table of labels. Edges that lie side by side in a row make a
run; a run goes to the first segment of the row above that it touches and agrees with, or starts one.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8, u16, u32

# A segment is a struct of 32-bit words. The sums make the line through any edges a closed form, and two
# segments are joined by adding them. With up to 4096 edges in pictures of up to 724 pixels they keep in 32 bits.
EDGES = 0  # how many edges it has; 0 is an empty place
SUM_X = 1
SUM_Y = 2
SUM_XX = 3
SUM_XY = 4
SUM_YY = 5
START_X = 6  # its outermost edges. While scanning: the first and the last along its axis
START_Y = 7
END_X = 8
END_Y = 9
DIRECTION = 10  # gradient direction of its first edge, an 8-bit angle
TURN = 11  # sum of the differences from DIRECTION of its first edges, which the mean direction is made of
LAST_ROW = 12  # of its latest edge; of an empty place: the next empty one, or NONE
SEGMENT_WORDS = 13

# Most segments at a time. A u8 row holds 255 labels. A full edge store
SEGMENT_CAPACITY = 192
NONE = -1

# The counters of the scan.
FREE = 0  # first empty place of the table
UNPLACED = 1  # edges that are in no segment because the table was full
SCAN_WORDS = 2


@kernel
def turn_between(angle: i32, reference: i32) -> i32:
    """Return how far `reference` turns to `angle`, both 8-bit angles: -128..127."""
    return ((angle - reference + 128) & 255) - 128


@kernel
def is_flat(direction: i32) -> i32:
    """Return 1 for a line that is nearer to a row than to a column, by its gradient direction; else 0."""
    return direction + 32 >> 6 & 1


@kernel
def clear_segments(segments: i32[:], scan: i32[:], above: u8[:], here: u8[:]) -> None:
    """Empty the table and its two rows of labels, before the first row of a picture."""
    for x in range(len(above)):
        above[x] = 0
        here[x] = 0
    places = len(segments) // SEGMENT_WORDS
    for place in range(places):
        segments[place * SEGMENT_WORDS + EDGES] = 0
        segments[place * SEGMENT_WORDS + LAST_ROW] = place + 1
    segments[(places - 1) * SEGMENT_WORDS + LAST_ROW] = NONE
    scan[FREE] = 0
    scan[UNPLACED] = 0


@kernel
def run_length(edge_data: u32[:], begin: i32, stop: i32, angle_range: i32, mean_edges: i32) -> i32:
    """Return how many edges from `begin` on lie side by side, each within `angle_range` of the mean before it.

    The mean is that of the run's first `mean_edges` edges: a curve leaves it sooner than one that follows.
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

    Its direction is the mean `direction + turns / averaged`; both means are compared without dividing.
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
def new_segment(segments: i32[:], scan: i32[:], x: i32, y: i32, direction: i32) -> i32:
    """Take an empty place for a segment that starts at an edge; return the place, or NONE if none is empty."""
    place = scan[FREE]
    if place == NONE:
        return NONE
    base = place * SEGMENT_WORDS
    scan[FREE] = segments[base + LAST_ROW]
    for word in range(SEGMENT_WORDS):
        segments[base + word] = 0
    segments[base + START_X] = x
    segments[base + START_Y] = y
    segments[base + END_X] = x
    segments[base + END_Y] = y
    segments[base + DIRECTION] = direction
    return place


@kernel
def add_edge(segments: i32[:], place: i32, x: i32, y: i32, direction: i32, mean_edges: i32) -> None:
    """Add an edge of the row now scanned to a segment.

    The rows come from above and their edges from the left. So the edge is a new end, except on a flat line:
    there it is the new start if it lies to the left of that, as on lines that fall from the right to the left.
    """
    base = place * SEGMENT_WORDS
    if segments[base + EDGES] < mean_edges:
        turn = turn_between(direction, segments[base + DIRECTION])
        segments[base + TURN] = segments[base + TURN] + turn
    segments[base + EDGES] = segments[base + EDGES] + 1
    segments[base + SUM_X] = segments[base + SUM_X] + x
    segments[base + SUM_Y] = segments[base + SUM_Y] + y
    segments[base + SUM_XX] = segments[base + SUM_XX] + x * x
    segments[base + SUM_XY] = segments[base + SUM_XY] + x * y
    segments[base + SUM_YY] = segments[base + SUM_YY] + y * y
    segments[base + LAST_ROW] = y
    flat = is_flat(segments[base + DIRECTION])
    if flat != 0 and x < segments[base + START_X]:
        segments[base + START_X] = x
        segments[base + START_Y] = y
    elif flat == 0 or x > segments[base + END_X]:
        segments[base + END_X] = x
        segments[base + END_Y] = y


@kernel
def line_length(segments: i32[:], base: i32) -> i32:
    """Return how long a segment is: its edges, but not more than have room between its outermost ones."""
    dx = segments[base + END_X] - segments[base + START_X]
    dy = segments[base + END_Y] - segments[base + START_Y]
    return min(segments[base + EDGES], max(abs(dx), abs(dy)) + 1)


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
    """Wipe the labels of the row above row `y`, and empty what ended in it shorter than `min_length`."""
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
    """Put the edges of row `y` into segments.

    `above` and `here` hold for each x the segment of the edge there, counted from 1, in the row above and in
    this one. Afterwards `above` is empty, ready to be `here` of the next row.
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


@kernel
def copy_segment(segments: i32[:], source: i32, target: i32) -> None:
    """Copy a segment from one place of the table to another."""
    for word in range(SEGMENT_WORDS):
        segments[target * SEGMENT_WORDS + word] = segments[source * SEGMENT_WORDS + word]


@kernel
def turn_round(segments: i32[:], base: i32) -> None:
    """Exchange start and end of a segment."""
    x = segments[base + START_X]
    y = segments[base + START_Y]
    segments[base + START_X] = segments[base + END_X]
    segments[base + START_Y] = segments[base + END_Y]
    segments[base + END_X] = x
    segments[base + END_Y] = y


@kernel
def keep_segments(segments: i32[:], min_length: i32, mean_edges: i32) -> i32:
    """Move the segments of `min_length` and more to the front of the table and return how many they are.

    Start and end are placed so that each has its bright side on the left and its dark side on the right: it
    goes a quarter turn on from the gradient. DIRECTION becomes the mean, for the connectors.
    """
    count = 0
    for place in range(len(segments) // SEGMENT_WORDS):
        if line_length(segments, place * SEGMENT_WORDS) >= min_length:
            copy_segment(segments, place, count)
            base = count * SEGMENT_WORDS
            # The scan has led flat lines to the right and the others downwards: wrong for two of four sides.
            first = segments[base + DIRECTION]
            if 32 <= first < 160:
                turn_round(segments, base)
            averaged = min(segments[base + EDGES], mean_edges)
            mean_turn = (2 * segments[base + TURN] + averaged) // (2 * averaged)
            segments[base + DIRECTION] = first + mean_turn & 255
            count = count + 1
    return count
