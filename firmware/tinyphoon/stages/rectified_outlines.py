"""Outlines of objects, moved to their places in the rectified picture (T §7.2): circles, blobs, ends of rectangles.

An object's size and place are computed for an ideal camera's picture, so nothing bent may reach them. A circle is moved
by its four points above, below and beside its centre; a blob by the middles of the sides of its box.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, i16, i32, kernel, u32
from tinyphoon.stages.circle_judging import sixteenths
from tinyphoon.stages.object_detection import Outlines
from tinyphoon.stages.rectified_places import ACROSS as COLUMN
from tinyphoon.stages.rectified_places import DOWN as ROW
from tinyphoon.stages.rectified_places import rectified
from tinyphoon.stores.blobs import (
    ACROSS,
    BLOB_WORDS,
    DOWN,
    PIXELS,
    SUM_X,
    SUM_Y,
    close_blob,
    extent_of,
    pair,
)
from tinyphoon.stores.circles import CIRCLE_RADIUS, CIRCLE_WORDS, CIRCLE_X, CIRCLE_Y
from tinyphoon.stores.lines import SUBPIXELS
from tinyphoon.stores.rectangles import (
    RECTANGLE_BLOB,
    RECTANGLE_LEFT_FOOT,
    RECTANGLE_LEFT_ROWS,
    RECTANGLE_RIGHT_FOOT,
    RECTANGLE_RIGHT_ROWS,
    RECTANGLE_WORDS,
    rows_at,
    store_rows,
)

HALF_PIXEL = SUBPIXELS // 2


@kernel
def rectify_circles(circles: i16[:], count: i32, places: i16[:]) -> None:
    """Move the first `count` circles. One without a radius is just its centre."""
    for circle in range(count):
        at = circle * CIRCLE_WORDS
        x = i32(circles[at + CIRCLE_X])
        y = i32(circles[at + CIRCLE_Y])
        radius = i32(circles[at + CIRCLE_RADIUS])
        left = rectified(places, x - radius, y, COLUMN)
        right = rectified(places, x + radius, y, COLUMN)
        top = rectified(places, x, y - radius, ROW)
        bottom = rectified(places, x, y + radius, ROW)
        across = rectified(places, x, y - radius, COLUMN) + rectified(places, x, y + radius, COLUMN)
        down = rectified(places, x - radius, y, ROW) + rectified(places, x + radius, y, ROW)
        circles[at + CIRCLE_X] = left + right + across + 2 >> 2
        circles[at + CIRCLE_Y] = top + bottom + down + 2 >> 2
        circles[at + CIRCLE_RADIUS] = right - left + bottom - top + 2 >> 2


@kernel
def rectified_pixel(places: i16[:], x: i32, y: i32, axis: i32, pixels: i32) -> i32:
    """Return column or row of a point's pixel in a picture of `pixels` that way; the nearest one in the picture.

    The point is in 1/16 px.
    """
    return min(max(rectified(places, x, y, axis) + HALF_PIXEL >> 4, 0), pixels - 1)


@kernel
def rectify_end(
    rectangles: i16[:],
    rectangle: i32,
    rows_word: i32,
    foot_word: i32,
    column: i32,
    places: i16[:],
    height: i32,
) -> None:
    """Move what an end of a rectangle, in `column`, has of its own: the rows of its blob, and the foot of a post."""
    x = SUBPIXELS * column
    at = rectangle * RECTANGLE_WORDS
    rows = rows_at(rectangles, rectangle, rows_word)
    first = rectified_pixel(places, x, SUBPIXELS * i32(rows & 0xFFFF), ROW, height)
    last = rectified_pixel(places, x, SUBPIXELS * i32(rows >> 16), ROW, height)
    store_rows(rectangles, rectangle, rows_word, first, last)
    rectangles[at + foot_word] = rectified(places, x, i32(rectangles[at + foot_word]), ROW)


@kernel
def rectify_ends(rectangles: i16[:], count: i32, blob_data: u32[:], places: i16[:], height: i32) -> None:
    """Move the ends of the first `count` rectangles, whose blobs are still in the camera's picture."""
    for rectangle in range(count):
        blob = i32(rectangles[rectangle * RECTANGLE_WORDS + RECTANGLE_BLOB])
        across = blob_data[blob * BLOB_WORDS + ACROSS]
        left = i32(across & 0xFFFF)
        right = i32(across >> 16)
        rectify_end(rectangles, rectangle, RECTANGLE_LEFT_ROWS, RECTANGLE_LEFT_FOOT, left, places, height)
        rectify_end(rectangles, rectangle, RECTANGLE_RIGHT_ROWS, RECTANGLE_RIGHT_FOOT, right, places, height)


@kernel
def rectify_blob(blob_data: u32[:], blob: i32, places: i16[:], width: i32, height: i32) -> None:
    """Move a blob: its box, its centre of mass, and its pixels in proportion to the growth of the box."""
    at = blob * BLOB_WORDS
    across = blob_data[at + ACROSS]
    down = blob_data[at + DOWN]
    x = HALF_PIXEL * (i32(across & 0xFFFF) + i32(across >> 16))
    y = HALF_PIXEL * (i32(down & 0xFFFF) + i32(down >> 16))
    left = rectified_pixel(places, SUBPIXELS * i32(across & 0xFFFF), y, COLUMN, width)
    right = rectified_pixel(places, SUBPIXELS * i32(across >> 16), y, COLUMN, width)
    top = rectified_pixel(places, x, SUBPIXELS * i32(down & 0xFFFF), ROW, height)
    bottom = rectified_pixel(places, x, SUBPIXELS * i32(down >> 16), ROW, height)
    centre_x = sixteenths(blob_data[at + SUM_X], blob_data[at + PIXELS])
    centre_y = sixteenths(blob_data[at + SUM_Y], blob_data[at + PIXELS])
    blob_data[at + ACROSS] = pair(left, right)
    blob_data[at + DOWN] = pair(top, bottom)
    pixels = blob_data[at + PIXELS] * u32(extent_of(blob_data[at + ACROSS])) // u32(extent_of(across))
    pixels = max(pixels * u32(extent_of(blob_data[at + DOWN])) // u32(extent_of(down)), u32(1))
    to_x = min(max(rectified(places, centre_x, centre_y, COLUMN), 0), SUBPIXELS * (width - 1))
    to_y = min(max(rectified(places, centre_x, centre_y, ROW), 0), SUBPIXELS * (height - 1))
    blob_data[at + PIXELS] = pixels
    blob_data[at + SUM_X] = u32(to_x) * pixels // SUBPIXELS
    blob_data[at + SUM_Y] = u32(to_y) * pixels // SUBPIXELS
    close_blob(blob_data, blob)


@kernel
def rectify_blobs(blob_data: u32[:], count: i32, places: i16[:], width: i32, height: i32) -> None:
    """Move the first `count` blobs."""
    for blob in range(count):
        rectify_blob(blob_data, blob, places, width, height)


def rectified_outlines(core: Core, frame: Frame, outlines: Outlines) -> Generator[Any, Any, None]:
    """Move circles, the ends of rectangles, and blobs."""
    places, blob_data = core.array("places"), core.array("blob_data")
    yield core.run(rectify_circles, core.array("circles"), outlines.circles, places)
    rectangles = core.array("rectangles"), outlines.rectangles
    yield core.run(rectify_ends, *rectangles, blob_data, places, frame.height)
    yield core.run(rectify_blobs, blob_data, outlines.blobs, places, frame.width, frame.height)
