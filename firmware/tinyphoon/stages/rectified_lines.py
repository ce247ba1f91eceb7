"""Lines, moved to their places in the rectified picture (T §7.2).

A lens bends a line, and the line fitted to it is straight: right on average, too far in at the middle and too far out
at both ends. So not only its ends are moved but points all along it, and a straight line is fitted to these. The error
of the first fit is undone by the second: both are least squares over the same length.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, i16, i32, kernel, u8
from tinyphoon.stages.line_fit import SLOPE_BITS, foot, slope, store_ends
from tinyphoon.stages.line_pixels import line_pixels
from tinyphoon.stages.rectified_places import ACROSS, DOWN, rectified
from tinyphoon.stores.lines import LINE_WORDS, LINE_X0, LINE_X1, LINE_Y0, LINE_Y1

PARTS = 8
"""A line is moved by the middles of this many equal parts: with them, the squares of their places are right to 2 %."""
PART_BITS = 4  # two steps a part


@kernel
def rectify_line(lines: i16[:], line: i32, places: i16[:], atan: u8[:], width: i32, height: i32) -> None:
    """Move a line; its ends are the feet of its moved ends."""
    base = line * LINE_WORDS
    x0 = i32(lines[base + LINE_X0])
    y0 = i32(lines[base + LINE_Y0])
    x1 = i32(lines[base + LINE_X1])
    y1 = i32(lines[base + LINE_Y1])
    sum_x = 0
    sum_y = 0
    along_x = 0
    along_y = 0
    for step in range(1, 2 * PARTS, 2):
        x = x0 + ((x1 - x0) * step >> PART_BITS)
        y = y0 + ((y1 - y0) * step >> PART_BITS)
        to_x = rectified(places, x, y, ACROSS)
        to_y = rectified(places, x, y, DOWN)
        sum_x = sum_x + to_x
        sum_y = sum_y + to_y
        along_x = along_x + (step - PARTS) * to_x
        along_y = along_y + (step - PARTS) * to_y
    middle_x = (sum_x + PARTS // 2) // PARTS
    middle_y = (sum_y + PARTS // 2) // PARTS
    start_x = rectified(places, x0, y0, ACROSS) - middle_x
    start_y = rectified(places, x0, y0, DOWN) - middle_y
    end_x = rectified(places, x1, y1, ACROSS) - middle_x
    end_y = rectified(places, x1, y1, DOWN) - middle_y
    if abs(along_x) >= abs(along_y):
        rise = slope(along_x, along_y)
        start_x = foot(start_x, start_y, rise)
        start_y = start_x * rise >> SLOPE_BITS
        end_x = foot(end_x, end_y, rise)
        end_y = end_x * rise >> SLOPE_BITS
    else:
        rise = slope(along_y, along_x)
        start_y = foot(start_y, start_x, rise)
        start_x = start_y * rise >> SLOPE_BITS
        end_y = foot(end_y, end_x, rise)
        end_x = end_y * rise >> SLOPE_BITS
    store_ends(
        lines, line, middle_x + start_x, middle_y + start_y, middle_x + end_x, middle_y + end_y, atan, width, height
    )  # fmt: skip


@kernel
def rectify_lines(lines: i16[:], count: i32, places: i16[:], atan: u8[:], width: i32, height: i32) -> None:
    """Move the first `count` lines."""
    for line in range(count):
        rectify_line(lines, line, places, atan, width, height)


def rectified_lines(core: Core, frame: Frame, count: int) -> Generator[Any, Any, None]:
    """Move the first `count` of `lines`."""
    lines = core.array("lines")
    core.at(line_pixels(lines, count))
    tables = core.array("places"), core.array("atan")
    yield core.run(rectify_lines, lines, count, *tables, frame.width, frame.height)
    core.at()
