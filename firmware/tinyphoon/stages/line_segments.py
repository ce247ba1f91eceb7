"""The table of line segments (T §5.2.2), which collects the edges of each line while the rows are scanned.

It replaces a look-up table of labels: a segment's place in it is the label of its edges.
"""

from __future__ import annotations

from bfsim.api import i32, kernel, u8

# A segment is a struct of 32-bit words. The sums give the line through any edges in closed form, and adding them joins
# two segments. With up to 4096 edges in pictures of up to 724 pixels they fit in 32 bits.
EDGES = 0  # number of edges; 0 is an empty place
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
TURN = 11  # sum of the differences of its first edges from DIRECTION, for the mean direction
LAST_ROW = 12  # of its latest edge; in an empty place: the next empty one, or NONE
SEGMENT_WORDS = 13

# 10 KB, and u8 labels would do for 255. The edge store full of clutter has at most 200 segments at a time.
SEGMENT_CAPACITY = 192
NONE = -1

# The counters of the scan.
FREE = 0  # first empty place of the table
UNPLACED = 1  # edges without a segment because the table was full
SCAN_WORDS = 2


@kernel
def turn_between(angle: i32, reference: i32) -> i32:
    """Return the turn from `reference` to `angle`, both 8-bit angles: -128..127."""
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
def new_segment(segments: i32[:], scan: i32[:], x: i32, y: i32, direction: i32) -> i32:
    """Take an empty place for a segment that starts at an edge; return the place, or NONE if there is none."""
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
    """Add an edge of the current row to a segment.

    The rows come from above and their edges from the left. So the edge is a new end, except on a flat line: there it is
    the new start if it lies to the left of the old one, as on lines that fall from right to left.
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
    """Return the length of a segment: its edges, but at most as many as fit between its outermost ones."""
    dx = segments[base + END_X] - segments[base + START_X]
    dy = segments[base + END_Y] - segments[base + START_Y]
    return min(segments[base + EDGES], max(abs(dx), abs(dy)) + 1)


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
    """Move the segments of at least `min_length` to the front of the table and return how many they are.

    Start and end are placed so that each has its bright side on the left and its dark side on the right: its direction
    is a quarter turn on from the gradient. DIRECTION becomes the mean, for the connectors.
    """
    count = 0
    for place in range(len(segments) // SEGMENT_WORDS):
        if line_length(segments, place * SEGMENT_WORDS) >= min_length:
            copy_segment(segments, place, count)
            base = count * SEGMENT_WORDS
            # The scan has led flat lines to the right and the others downwards: wrong for two of four directions.
            first = segments[base + DIRECTION]
            if 32 <= first < 160:
                turn_round(segments, base)
            averaged = min(segments[base + EDGES], mean_edges)
            mean_turn = (2 * segments[base + TURN] + averaged) // (2 * averaged)
            segments[base + DIRECTION] = first + mean_turn & 255
            count = count + 1
    return count
