"""Line refinement [ours]: lines to a fraction of a pixel, for depths computed from the difference of two.

Edges lie on whole pixels, so a line that is nearly upright is off by up to half of one;
at 350 mm that is 2 % of the depth. Here the picture is read once more, row by row: in
each row that a line crosses, the centre of gravity of the grey steps across it says where
it is, and a straight line through these places takes the place of the old one. Only lines
nearer to a column than to a row are refined: the disparity of the others says little.

The sums of each line lie over the segments, which the line detection has finished with.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

from bfsim.api import Core, Frame, Row, i16, i32, kernel, u8
from tinyphoon.fields import allowed
from tinyphoon.stages.line_fit import SLOPE_BITS, slope, spread, store_ends
from tinyphoon.stages.line_pixels import line_pixels
from tinyphoon.stages.line_segments import SEGMENT_WORDS
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1, SUBPIXELS

# The sums of a line, in words of the place of its segment.
FIRST_ROW = 0  # the rows to look at, none if the last is above the first
LAST_ROW = 1
MIDDLE_ROW = 2
BRIGHTENS = 3  # 1 if it becomes brighter to the right, -1 if darker
RISE = 4  # columns by rows, in 1 / (1 << SLOPE_BITS)
ROWS = 5  # rows with an edge in them
SUM_OFF = 6  # of how far right of the line the edge is there, in STEPS of a pixel
SUM_DOWN = 7  # of the rows, from the middle row
SUM_OFF_DOWN = 8
SUM_DOWN_DOWN = 9

STEPS = 128
END_ROWS = 2
"""Rows left out at both ends, where another line may begin."""
LEAST_ROWS = 4
"""Fewer rows do not refine a line, nor do fewer than half of its rows."""
FARTHEST = 3 * SUBPIXELS // 2
"""A line that would move by more at an end stays where it is: what was seen is something else."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinementThresholds:
    """How lines are refined.

    `reach`: how many pixels on both sides of a line are looked at; 0 leaves all lines as they are. `min_step`: how many
    grey levels a pixel's neighbours must differ by to belong to the edge: more than the noise.
    """

    reach: int = allowed(0, 8)
    min_step: int = allowed(1, 255)


@kernel
def begin_sums(lines: i16[:], count: i32, sums: i32[:]) -> None:
    """Prepare the sums of each line."""
    for line in range(count):
        at = line * LINE_WORDS
        base = line * SEGMENT_WORDS
        across = lines[at + LINE_X1] - lines[at + LINE_X0]
        down = lines[at + LINE_Y1] - lines[at + LINE_Y0]
        top = min(lines[at + LINE_Y0], lines[at + LINE_Y1])
        bottom = max(lines[at + LINE_Y0], lines[at + LINE_Y1])
        for word in range(SEGMENT_WORDS):
            sums[base + word] = 0
        sums[base + LAST_ROW] = -1
        if abs(across) <= abs(down) and down != 0:
            sums[base + FIRST_ROW] = (top + SUBPIXELS - 1) // SUBPIXELS + END_ROWS
            sums[base + LAST_ROW] = bottom // SUBPIXELS - END_ROWS
            sums[base + MIDDLE_ROW] = (top + bottom) // (2 * SUBPIXELS)
            sums[base + BRIGHTENS] = 1 if down > 0 else -1
            sums[base + RISE] = (across << SLOPE_BITS) // down


@kernel
def first_row(sums: i32[:], count: i32, height: i32) -> i32:
    """Return the first row in which one of the lines is looked at; `height` if there is none."""
    first = height
    for line in range(count):
        base = line * SEGMENT_WORDS
        if sums[base + FIRST_ROW] <= sums[base + LAST_ROW]:
            first = min(first, sums[base + FIRST_ROW])
    return first


@kernel
def last_row(sums: i32[:], count: i32) -> i32:
    """Return the last row in which one of the lines is looked at; -1 if there is none."""
    last = -1
    for line in range(count):
        base = line * SEGMENT_WORDS
        if sums[base + FIRST_ROW] <= sums[base + LAST_ROW]:
            last = max(last, sums[base + LAST_ROW])
    return last


@kernel
def line_column(lines: i16[:], line: i32, rise: i32, row: i32) -> i32:
    """Return where a line crosses the middle of a row, in 1/16 px."""
    at = line * LINE_WORDS
    return lines[at + LINE_X0] + (rise * (SUBPIXELS * row - lines[at + LINE_Y0]) >> SLOPE_BITS)


@kernel
def look_at_row(
    uyvy: u8[:], y: i32, lines: i16[:], count: i32, sums: i32[:], reach: i32, min_step: i32
) -> None:
    """Add the edges in a row of the picture to the sums of each line."""
    width = len(uyvy) >> 1
    for line in range(count):
        base = line * SEGMENT_WORDS
        if sums[base + FIRST_ROW] <= y <= sums[base + LAST_ROW]:
            column = line_column(lines, line, sums[base + RISE], y)
            middle = column + SUBPIXELS // 2 >> 4
            steps = 0
            moment = 0
            for x in range(max(middle - reach, 1), min(middle + reach, width - 2) + 1):
                step = sums[base + BRIGHTENS] * (uyvy[2 * x + 3] - uyvy[2 * x - 1])
                if step >= min_step:
                    steps = steps + step
                    moment = moment + step * (SUBPIXELS * x - column)
            if steps > 0:
                off = (moment * (STEPS // SUBPIXELS) + (steps >> 1)) // steps
                down = y - sums[base + MIDDLE_ROW]
                sums[base + ROWS] = sums[base + ROWS] + 1
                sums[base + SUM_OFF] = sums[base + SUM_OFF] + off
                sums[base + SUM_DOWN] = sums[base + SUM_DOWN] + down
                sums[base + SUM_OFF_DOWN] = sums[base + SUM_OFF_DOWN] + off * down
                sums[base + SUM_DOWN_DOWN] = sums[base + SUM_DOWN_DOWN] + down * down


@kernel
def moved(sums: i32[:], base: i32, turn: i32, y: i32) -> i32:
    """Return how far right of a line its edges are at `y`, in 1/16 px; the slope differs by `turn` STEPS a row."""
    rows = sums[base + ROWS]
    from_mean = y - SUBPIXELS * sums[base + MIDDLE_ROW] - SUBPIXELS * sums[base + SUM_DOWN] // rows
    sixteenths = SUBPIXELS * sums[base + SUM_OFF] // rows + (turn * from_mean >> SLOPE_BITS)
    return (sixteenths + STEPS // 2) // STEPS


@kernel
def refine_lines(lines: i16[:], count: i32, sums: i32[:], atan: u8[:], width: i32, height: i32) -> i32:
    """Move each line onto the straight line that its sums describe, and return how many were moved."""
    refined = 0
    for line in range(count):
        base = line * SEGMENT_WORDS
        rows = sums[base + ROWS]
        if rows >= LEAST_ROWS and 2 * rows > sums[base + LAST_ROW] - sums[base + FIRST_ROW]:
            off_down = spread(sums[base + SUM_OFF_DOWN], sums[base + SUM_OFF], sums[base + SUM_DOWN], rows)
            down_down = spread(sums[base + SUM_DOWN_DOWN], sums[base + SUM_DOWN], sums[base + SUM_DOWN], rows)
            turn = slope(down_down, off_down)
            at = line * LINE_WORDS
            start = moved(sums, base, turn, lines[at + LINE_Y0])
            end = moved(sums, base, turn, lines[at + LINE_Y1])
            if abs(start) <= FARTHEST and abs(end) <= FARTHEST:
                store_ends(
                    lines, line, lines[at + LINE_X0] + start, lines[at + LINE_Y0],
                    lines[at + LINE_X1] + end, lines[at + LINE_Y1], atan, width, height,
                )  # fmt: skip
                refined = refined + 1
    return refined


def columns_at(lines: Row, sums: Row, count: int, y: int, reach: int) -> list[int]:
    """Return the columns that `look_at_row` looks at in row `y`, for `core.at`: nothing on the chip reads them here."""
    first, last, rise = _columns(sums, SEGMENT_WORDS, count, FIRST_ROW, LAST_ROW, RISE)
    x0, y0 = _columns(lines, LINE_WORDS, count, LINE_X0, LINE_Y0)
    middle = x0 + (rise * (SUBPIXELS * y - y0) >> SLOPE_BITS) + SUBPIXELS // 2 >> 4
    found: list[int] = (middle[(first <= y) & (y <= last), None] + range(-reach, reach + 1)).ravel().tolist()
    return found


def _columns(table: Row, words: int, count: int, *wanted: int) -> Any:
    """Return some columns of the first `count` rows of a table, as arrays."""
    return table.array[: count * words].reshape(-1, words)[:, wanted].T.astype("int64")


def line_refinement(
    core: Core, frame: Frame, count: int, thresholds: RefinementThresholds
) -> Generator[Any, Any, None]:
    """Refine the first `count` of `lines` by one pass of DMA lines over the rows that they cross.

    Publishes `lines_refined`, their number.
    """
    if thresholds.reach == 0:
        return
    lines, sums = core.array("lines"), core.array("segments")
    core.at(line_pixels(lines, count))
    yield core.run(begin_sums, lines, count, sums)
    first = yield core.run(first_row, sums, count, frame.height)
    last = yield core.run(last_row, sums, count)
    crossed = range(frame.height)[max(first, 0) : last + 1]  # lines may end beyond the picture
    if crossed:
        camera = core.input_ring(frame.rows[crossed.start : crossed.stop], "camera_ring")
        run, at, reach, min_step = core.run, core.at, thresholds.reach, thresholds.min_step
        for y in crossed:
            at(y, columns_at, lines, sums, count, y, reach)
            line = yield from camera.line()
            yield run(look_at_row, line, y, lines, count, sums, reach, min_step)
    core.at(line_pixels(lines, count))
    refined = yield core.run(refine_lines, lines, count, sums, core.array("atan"), frame.width, frame.height)
    core.at()
    core.publish(lines_refined=refined)
