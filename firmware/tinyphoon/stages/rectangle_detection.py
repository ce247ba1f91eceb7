"""Rectangle detection: the lines that border the blob of a rectangular model (T §6.4).

The thesis has the stage but says little of it; the rules are [ours]. A border line runs along its side of the blob for
a good part of it, and the outermost point of that part is near the blob's border. If there are several, the nearest is
taken. A line with its bright side outside counts as farther away: things on the field are brighter than the floor,
though not than the lines on it.

A line may be longer than the side, for example where the background continues it (T Figure 6.9); only its part beside
the blob counts.

A goal's blob is mostly its back, which ends below where the back does, farther from the camera than the mouth, and its
posts are so thin that their colour gets lost. Their border lines do not: a goal's bottom line is first sought below the
lower end of those.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Frame, i16, i32, kernel, u8, u32
from tinyphoon.fields import allowed
from tinyphoon.stages.line_pixels import line_pixels
from tinyphoon.stages.rectangle_ends import hidden_ends, rows_of_ends
from tinyphoon.stores.blobs import ACROSS, BLOB_WORDS, COLOURS, DOWN
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1, SUBPIXELS
from tinyphoon.stores.rectangles import (
    NO_LINE,
    RECTANGLE_BLOB,
    RECTANGLE_BOTTOM,
    RECTANGLE_CAPACITY,
    RECTANGLE_HIDDEN,
    RECTANGLE_LEFT,
    RECTANGLE_LEFT_FOOT,
    RECTANGLE_LEFT_ROWS,
    RECTANGLE_RIGHT,
    RECTANGLE_RIGHT_FOOT,
    RECTANGLE_RIGHT_ROWS,
    RECTANGLE_TOP,
    RECTANGLE_WORDS,
    rows_at,
    store_rows,
)

HALF_PIXEL = SUBPIXELS // 2
SHARE_BITS = 8

LEVEL = 0  # which coordinate runs along a border
UPRIGHT = 1
TOWARDS_0 = -1  # which direction is outwards
AWAY = 1

FAR = 1 << 20  # 1/16 px: farther than any picture is wide


@dataclass(frozen=True, slots=True, kw_only=True)
class RectangleThresholds:
    """What makes a border line.

    `border_px`: how far it may be from the blob's border. `dark_px`: how much farther away a line counts that is bright
    outside, if there are several. `overlap`: the share of the blob's side that it must run along, in 256ths.
    """

    border_px: int = allowed(0, 64)
    dark_px: int = allowed(0, 64)
    overlap: int = allowed(0, 256)


def rectangle_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage for a core."""
    return (Buffer("rectangles", i16, RECTANGLE_CAPACITY * RECTANGLE_WORDS, "data1"),)


@kernel
def crossing(along0: i32, across0: i32, along1: i32, across1: i32, along: i32) -> i32:
    """Return where a line is across at `along`; its ends must differ in that."""
    run = along1 - along0
    return across0 + ((across1 - across0) * (along - along0) + (run >> 1)) // run


@kernel
def border_distance(
    lines: i16[:],
    line: i32,
    upright: i32,
    outward: i32,
    first: i32,
    last: i32,
    border: i32,
    reach: i32,
    overlap: i32,
    dark: i32,
) -> i32:
    """Return how far a line is from being the border of a blob, in 1/16 px; FAR if it cannot be.

    The blob reaches from `first` to `last` along the border, which is at `border` across, and the line must be within
    `reach` of it. A line that is bright outside counts as `dark` farther away.
    """
    start = line * LINE_WORDS + LINE_X0
    end = line * LINE_WORDS + LINE_X1
    along0 = i32(lines[start + upright])
    along1 = i32(lines[end + upright])
    across0 = i32(lines[start + 1 - upright])
    across1 = i32(lines[end + 1 - upright])
    run = along1 - along0
    if abs(run) <= abs(across1 - across0):
        return FAR
    low = max(min(along0, along1), first)
    high = min(max(along0, along1), last)
    if high <= low or high - low << SHARE_BITS < overlap * (last - first):
        return FAR
    one = outward * crossing(along0, across0, along1, across1, low)
    other = outward * crossing(along0, across0, along1, across1, high)
    distance = abs(max(one, other) - outward * border)
    if distance > reach:
        return FAR
    bright_inside = run * outward  # if above 0, by the orientation of lines
    if upright == UPRIGHT:
        bright_inside = -bright_inside
    if bright_inside > 0:
        return distance
    return distance + dark


@kernel
def border_line(
    lines: i16[:],
    count: i32,
    upright: i32,
    outward: i32,
    first: i32,
    last: i32,
    border: i32,
    reach: i32,
    overlap: i32,
    dark: i32,
) -> i32:
    """Return the line nearest to a border of a blob, or NO_LINE; of equal ones the first."""
    found: i32 = NO_LINE
    nearest: i32 = FAR
    for line in range(count):
        distance = border_distance(lines, line, upright, outward, first, last, border, reach, overlap, dark)
        if distance < nearest:
            nearest = distance
            found = line
    return found


@kernel
def open_rectangles(blob_data: u32[:], parents: u8[:], blobs: i32, colours: u32, rectangles: i16[:]) -> i32:
    """Begin a record for each blob with some of `colours` that is not part of another; return how many there are.

    Blobs without room are counted. Both ends have the rows of the blob.
    """
    found: i32 = 0
    room = len(rectangles) // RECTANGLE_WORDS
    for blob in range(blobs):
        if parents[blob] == blob and blob_data[blob * BLOB_WORDS + COLOURS] & colours != 0:
            if found < room:
                down = blob_data[blob * BLOB_WORDS + DOWN]
                rectangles[found * RECTANGLE_WORDS + RECTANGLE_BLOB] = blob
                rectangles[found * RECTANGLE_WORDS + RECTANGLE_HIDDEN] = 0
                store_rows(rectangles, found, RECTANGLE_LEFT_ROWS, i32(down & 0xFFFF), i32(down >> 16))
                store_rows(rectangles, found, RECTANGLE_RIGHT_ROWS, i32(down & 0xFFFF), i32(down >> 16))
            found = found + 1
    return found


@kernel
def upper(rows: u32) -> i32:
    """Return where the first of a pair of rows begins, in 1/16 px."""
    return SUBPIXELS * i32(rows & 0xFFFF) - HALF_PIXEL


@kernel
def lower(rows: u32) -> i32:
    """Return where the second of a pair of rows ends, in 1/16 px."""
    return SUBPIXELS * i32(rows >> 16) + HALF_PIXEL


@kernel
def post_foot(
    lines: i16[:], count: i32, outward: i32, rows: u32, border: i32, reach: i32, overlap: i32
) -> i32:
    """Return where a goal's post ends: with its blob's rows at that end, or farther down with a border line there.

    Things that cross a post break its lines: of all of them, the one that goes farthest counts. A line that extends by
    more than half of the rows belongs also to something else. All but the rows are in 1/16 px.
    """
    top = upper(rows)
    bottom = lower(rows)
    foot = bottom
    for line in range(count):
        end = max(lines[line * LINE_WORDS + LINE_Y0], lines[line * LINE_WORDS + LINE_Y1])
        if foot < end <= bottom + (bottom - top >> 1):
            distance = border_distance(lines, line, UPRIGHT, outward, top, bottom, border, reach, overlap, 0)
            if distance < FAR:
                foot = end
    return foot


@kernel
def find_borders(
    blob_data: u32[:],
    goals: u32,
    lines: i16[:],
    count: i32,
    rectangles: i16[:],
    rectangle: i32,
    reach: i32,
    overlap: i32,
    dark: i32,
) -> None:
    """Store the border lines of a rectangle among the first `count` lines. Distances in 1/16 px.

    `goals` are the colours of goals.
    """
    at = rectangle * RECTANGLE_WORDS
    blob = i32(rectangles[at + RECTANGLE_BLOB])
    across = blob_data[blob * BLOB_WORDS + ACROSS]
    down = blob_data[blob * BLOB_WORDS + DOWN]
    left = SUBPIXELS * i32(across & 0xFFFF) - HALF_PIXEL
    right = SUBPIXELS * i32(across >> 16) + HALF_PIXEL
    bottom = lower(down)
    rows = rows_at(rectangles, rectangle, RECTANGLE_LEFT_ROWS)
    left_line = border_line(
        lines, count, UPRIGHT, TOWARDS_0, upper(rows), lower(rows), left, reach, overlap, dark
    )
    left_foot = post_foot(lines, count, TOWARDS_0, rows, left, reach, overlap)
    rows = rows_at(rectangles, rectangle, RECTANGLE_RIGHT_ROWS)
    right_line = border_line(
        lines, count, UPRIGHT, AWAY, upper(rows), lower(rows), right, reach, overlap, dark
    )
    right_foot = post_foot(lines, count, AWAY, rows, right, reach, overlap)
    feet = max(left_foot, right_foot)
    bottom_line: i32 = NO_LINE
    if blob_data[blob * BLOB_WORDS + COLOURS] & goals != 0 and feet > bottom:
        below = reach >> 1
        bottom_line = border_line(lines, count, LEVEL, AWAY, left, right, feet + below, below, overlap, dark)
    if bottom_line == NO_LINE:
        bottom_line = border_line(lines, count, LEVEL, AWAY, left, right, bottom, reach, overlap, dark)
    rectangles[at + RECTANGLE_LEFT] = left_line
    rectangles[at + RECTANGLE_RIGHT] = right_line
    rectangles[at + RECTANGLE_TOP] = border_line(
        lines, count, LEVEL, TOWARDS_0, left, right, upper(down), reach, overlap, dark
    )
    rectangles[at + RECTANGLE_BOTTOM] = bottom_line
    rectangles[at + RECTANGLE_LEFT_FOOT] = left_foot
    rectangles[at + RECTANGLE_RIGHT_FOOT] = right_foot


@kernel
def find_all_borders(
    blob_data: u32[:],
    goals: u32,
    lines: i16[:],
    count: i32,
    rectangles: i16[:],
    rectangle_count: i32,
    reach: i32,
    overlap: i32,
    dark: i32,
) -> None:
    """Store the border lines of the first `rectangle_count` rectangles."""
    for rectangle in range(rectangle_count):
        find_borders(blob_data, goals, lines, count, rectangles, rectangle, reach, overlap, dark)


def rectangle_detection(
    core: Core,
    frame: Frame,
    blobs: int,
    lines: int,
    colours: int,
    goals: int,
    thresholds: RectangleThresholds,
) -> Generator[Any, Any, int]:
    """Look for the border lines of the blobs of rectangular models, merged ones too, and leave them in `rectangles`.

    `blobs` and `lines` are how many are in their stores, `colours` those of the models, `goals` those of goals, whose ends are also
    examined. Publishes `rectangles`, how many are stored, and `rectangles_lost`, how many had no room. Returns how many are stored.
    """
    limits = SUBPIXELS * thresholds.border_px, thresholds.overlap, SUBPIXELS * thresholds.dark_px
    blob_data, table = core.array("blob_data"), core.array("rectangles")
    found = yield core.run(open_rectangles, blob_data, core.array("label_parents"), blobs, colours, table)
    stored: int = min(found, RECTANGLE_CAPACITY)
    yield from rows_of_ends(core, frame, stored, goals)
    core.at(line_pixels(core.array("lines"), lines))
    yield core.run(find_all_borders, blob_data, goals, core.array("lines"), lines, table, stored, *limits)
    core.at()
    yield from hidden_ends(core, frame, stored, goals)
    core.publish(rectangles=stored, rectangles_lost=found - stored)
    return stored
