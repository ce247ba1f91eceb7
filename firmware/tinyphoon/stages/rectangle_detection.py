"""Rectangle detection: the lines that border the blob of a rectangular model (T §6.4).

The thesis has the stage and says little of it; the rules are [ours]. A border line runs along its side of the blob for
a good part of it, and the outermost point of that part is near the blob's border. Of several the nearest is taken.
A line with its bright side outside counts as farther off: things on the field are brighter than the floor, though not than
the lines on it.

A line may be longer than the side, as where the background carries it on (T Figure 6.9); only its part beside the
blob is looked at.

A goal's blob is mostly its back, which ends below where the back does, farther from the camera than the mouth, and its
posts are so thin that their colour gets lost. Their border lines do not: a goal's bottom line is looked for below the
lower end of those first.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, i16, i32, kernel, u8, u32
from tinyphoon.fields import allowed
from tinyphoon.stages.line_pixels import line_pixels
from tinyphoon.stores.blobs import ACROSS, BLOB_WORDS, COLOURS, DOWN
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1, SUBPIXELS
from tinyphoon.stores.rectangles import (
    NO_LINE,
    RECTANGLE_BLOB,
    RECTANGLE_BOTTOM,
    RECTANGLE_CAPACITY,
    RECTANGLE_HIDDEN,
    RECTANGLE_LEFT,
    RECTANGLE_RIGHT,
    RECTANGLE_TOP,
    RECTANGLE_WORDS,
)

HALF_PIXEL = SUBPIXELS // 2
SHARE_BITS = 8

LEVEL = 0  # which coordinate runs along a border
UPRIGHT = 1
TOWARDS_0 = -1  # which way is out
AWAY = 1

FAR = 1 << 20  # 1/16 px: farther than any picture is wide


@dataclass(frozen=True, slots=True, kw_only=True)
class RectangleThresholds:
    """What makes a border line.

    `border_px`: so far it may be from the blob's border. `dark_px`: so much farther off counts a line that is bright
    outside when there are several. `overlap`: the share of the blob's side that it runs along, of 256.
    """

    border_px: int = allowed(0, 64)
    dark_px: int = allowed(0, 64)
    overlap: int = allowed(0, 256)


def rectangle_buffers() -> Sequence[Buffer]:
    """Return the buffers of the stage for a core."""
    return (Buffer("rectangles", i16, RECTANGLE_CAPACITY * RECTANGLE_WORDS, "data1"),)


@kernel
def crossing(along0: i32, across0: i32, along1: i32, across1: i32, along: i32) -> i32:
    """Return where across a line is at `along`; its ends must differ in that."""
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

    The blob reaches from `first` to `last` along the border, which is at `border` across, and the line must be `reach`
    from it at most. One that is bright outside counts as `dark` farther away.
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
def post_end(lines: i16[:], line: i32, top: i32, bottom: i32) -> i32:
    """Return where a goal's post ends: with the blob that has these rows, or farther down with its border line, if that is seen.

    A line that goes on by more than half of the blob is also something else's. All in 1/16 px.
    """
    if line == NO_LINE:
        return bottom
    at = line * LINE_WORDS
    end = max(lines[at + LINE_Y0], lines[at + LINE_Y1])
    return max(bottom, end) if end <= bottom + (bottom - top >> 1) else bottom


@kernel
def find_rectangle(
    blob_data: u32[:],
    blob: i32,
    goals: u32,
    lines: i16[:],
    count: i32,
    rectangles: i16[:],
    place: i32,
    reach: i32,
    overlap: i32,
    dark: i32,
) -> None:
    """Make record `place` of a blob: its border lines among the first `count` lines. Distances in 1/16 px.

    `goals` are the colours of goals.
    """
    across = blob_data[blob * BLOB_WORDS + ACROSS]
    down = blob_data[blob * BLOB_WORDS + DOWN]
    left = SUBPIXELS * i32(across & 0xFFFF) - HALF_PIXEL
    right = SUBPIXELS * i32(across >> 16) + HALF_PIXEL
    top = SUBPIXELS * i32(down & 0xFFFF) - HALF_PIXEL
    bottom = SUBPIXELS * i32(down >> 16) + HALF_PIXEL
    at = place * RECTANGLE_WORDS
    left_line = border_line(lines, count, UPRIGHT, TOWARDS_0, top, bottom, left, reach, overlap, dark)
    right_line = border_line(lines, count, UPRIGHT, AWAY, top, bottom, right, reach, overlap, dark)
    bottom_line: i32 = NO_LINE
    if blob_data[blob * BLOB_WORDS + COLOURS] & goals != 0:
        feet = max(post_end(lines, left_line, top, bottom), post_end(lines, right_line, top, bottom))
        if feet > bottom:
            below = reach >> 1
            bottom_line = border_line(
                lines, count, LEVEL, AWAY, left, right, feet + below, below, overlap, dark
            )
    if bottom_line == NO_LINE:
        bottom_line = border_line(lines, count, LEVEL, AWAY, left, right, bottom, reach, overlap, dark)
    rectangles[at + RECTANGLE_LEFT] = left_line
    rectangles[at + RECTANGLE_RIGHT] = right_line
    rectangles[at + RECTANGLE_TOP] = border_line(
        lines, count, LEVEL, TOWARDS_0, left, right, top, reach, overlap, dark
    )
    rectangles[at + RECTANGLE_BOTTOM] = bottom_line
    rectangles[at + RECTANGLE_BLOB] = blob
    rectangles[at + RECTANGLE_HIDDEN] = 0


@kernel
def find_rectangles(
    blob_data: u32[:],
    parents: u8[:],
    blobs: i32,
    colours: u32,
    goals: u32,
    lines: i16[:],
    count: i32,
    rectangles: i16[:],
    reach: i32,
    overlap: i32,
    dark: i32,
) -> i32:
    """Make a record of each blob that has some of `colours` and is no part of another; returns how many there are, also beyond the room.

    `goals` are those of goals.
    """
    found: i32 = 0
    room = len(rectangles) // RECTANGLE_WORDS
    for blob in range(blobs):
        if parents[blob] == blob and blob_data[blob * BLOB_WORDS + COLOURS] & colours != 0:
            if found < room:
                find_rectangle(blob_data, blob, goals, lines, count, rectangles, found, reach, overlap, dark)
            found = found + 1
    return found


def rectangle_detection(
    core: Core, blobs: int, lines: int, colours: int, goals: int, thresholds: RectangleThresholds
) -> Generator[Any, Any, int]:
    """Look for the border lines of the blobs of rectangular models, merged ones too, and leave them in `rectangles`.

    `blobs` and `lines` are how many are in their stores, `colours` those of the models, `goals` those of goals. Publishes `rectangles`, how many
    are stored, and `rectangles_lost`, how many had no room. Returns how many are stored.
    """
    limits = SUBPIXELS * thresholds.border_px, thresholds.overlap, SUBPIXELS * thresholds.dark_px
    core.at(line_pixels(core.array("lines"), lines))
    found = yield core.run(
        find_rectangles,
        *(core.array("blob_data"), core.array("label_parents"), blobs, colours, goals),
        *(core.array("lines"), lines, core.array("rectangles")),
        *limits,
    )
    core.at()
    stored: int = min(found, RECTANGLE_CAPACITY)
    core.publish(rectangles=stored, rectangles_lost=found - stored)
    return stored
