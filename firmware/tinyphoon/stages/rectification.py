"""Rectification: every pixel is taken from where a look-up table says that the lens put it (T §3.4, §5.2.5).

`dst[i] = src[lut[i]]`, one table per camera and no weights. The thesis takes its pixels from SDRAM, at worst each from
another page. Here DMA keeps a window of camera lines near the core, as deep as one line of the rectified picture
reaches up and down in the camera's, and the table comes line by line through a ring of its own. A table's entry is the
place of a pixel in the window, so the kernel computes no address.

Of the two pixels of a pair each has its own luma, and both the colour of the left one. A pixel without a source is
black: the window ends with a black pair, which stands for all of them. What borders on them is the rim of the camera's
picture and nothing in the world: `sighted_first` and `sighted_last` say for each row between which columns it is not.

The window is a plain variable (section data1): the LDF puts it into L1 if the line rings leave room, else into L2.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.api import Buffer, Buffers, Core, FirmwareError, Frame, SourcePixels, i32, kernel, u8, u16
from tinyphoon.areas import WHOLE_PICTURE, Area, area_in, cropped

BLACK_PAIR = (128, 0, 128, 0)  # U Y V Y
PLACES = 1 << 16  # entries have 16 bits
GRADIENT_REACH = 4  # pixels: the larger Gauss 2, Sobel 1, the neighbour for the maximum 1


@kernel
def rectify_row(window: u8[:], places: u16[:], rectified: u8[:]) -> None:
    """Gather one UYVY row of `len(places)` pixels; a place counts the pixels of the window."""
    for pair in range(len(places) >> 1):
        left = 2 * places[2 * pair]
        colour = left & -4
        rectified[4 * pair] = window[colour]
        rectified[4 * pair + 1] = window[left + 1]
        rectified[4 * pair + 2] = window[colour + 2]
        rectified[4 * pair + 3] = window[2 * places[2 * pair + 1] + 1]


@kernel
def load_lines(lines: u16[:], y: i32) -> i32:
    """Return how many lines of the camera rows 0 to `y` of the rectified picture need."""
    return i32(lines[y])


def lines_reached(rows: NDArray[np.int32]) -> NDArray[np.int64]:
    """Return for each row of a table how many camera lines must have come: down to its lowest, and any row's before."""
    return np.maximum.accumulate(rows.max(axis=1).astype(np.int64) + 1)


def window_lines(rows: NDArray[np.int32]) -> int:
    """Return the lines that a ring needs for a table: the most that any row reaches over, and one on its way."""
    highest = np.where(rows >= 0, rows, np.iinfo(np.int32).max).min(axis=1)
    return max(2, int((lines_reached(rows) - highest).max()) + 1)


def places_in_window(sources: SourcePixels, depth: int) -> NDArray[np.int64]:
    """Return the place of each source pixel in a window of `depth` lines; after the last line comes the black pair."""
    width = sources.rows.shape[1]
    return np.where(sources.rows >= 0, sources.rows % depth * width + sources.columns, depth * width)


def sighted_columns(rows: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first and the last column of each row whose gradient depends on no pixel without a source.

    For a row with several stretches of such columns it is the longest; one without any begins after its end.
    """
    height, width = rows.shape
    blind = np.pad(rows < 0, GRADIENT_REACH, mode="edge")
    near = np.lib.stride_tricks.sliding_window_view(blind, (2 * GRADIENT_REACH + 1,) * 2).any(axis=(2, 3))
    first, last = np.full(height, width, np.int64), np.zeros(height, np.int64)
    for y in range(height):
        ends = np.flatnonzero(np.diff(np.concatenate(([True], near[y], [True])).astype(np.int8)))
        if len(ends):
            longest = np.argmax(ends[1::2] - ends[::2])
            first[y], last[y] = ends[2 * longest], ends[2 * longest + 1] - 1
    return first, last


def rectification_buffers(sources: Mapping[str, SourcePixels]) -> Buffers:
    """Return the buffers for a recording's tables in the memory of each core."""
    return {core: _core_buffers(core, each) for core, each in sources.items()}


def _core_buffers(core: str, sources: SourcePixels) -> Sequence[Buffer]:
    height, width = sources.rows.shape
    depth = window_lines(sources.rows)
    if depth * width >= PLACES:
        raise FirmwareError(
            f"the rectification table of core {core} must not need more than {PLACES // width - 1} camera lines at once, "
            f"but needs {depth}"
        )
    window = np.zeros(2 * depth * width + len(BLACK_PAIR), np.uint8)
    window[-len(BLACK_PAIR) :] = BLACK_PAIR
    first, last = sighted_columns(sources.rows)
    return (
        Buffer("camera_window", u8, len(window), "data1", values=window),
        Buffer("places_ring", u16, width, "data1", rows=2),
        Buffer("lines_reached", u16, height, "data1", values=lines_reached(sources.rows)),
        Buffer("sighted_first", u16, height, "data1", values=first),
        Buffer("sighted_last", u16, height, "data1", values=last),
        Buffer("places", u16, width, "sdram0", rows=height, values=places_in_window(sources, depth)),
        Buffer("rectified_image", u8, 2 * width, "sdram0", rows=height),
    )


def rectification(core: Core, frame: Frame, area: Area = WHOLE_PICTURE) -> Generator[Any, Any, Frame]:
    """Rectify an area of a picture in one pass of DMA lines; leave `rectified_image` in SDRAM and return it as a frame.

    If a recording has no tables, its pictures count as rectified: the area is returned.
    """
    area = area_in(frame, area)
    if not core.has_buffer("camera_window"):
        return cropped(core, frame, area)
    window, reached = core.array("camera_window"), core.array("lines_reached")
    depth = (window.nbytes - len(BLACK_PAIR)) // (2 * frame.width)
    rows = core.rows("places")[area.y : area.y + area.height]
    places = core.input_ring(
        core.part(rows, area.x, area.width), core.overlay("places_ring", u16, area.width)[:2]
    )
    image = core.overlay("rectified_image", u8, 2 * area.width)[: area.height]
    rectified = core.output_ring("camera_ring", image)
    # Line n of the camera lies in row n modulo the depth, so the window begins with a line that has row 0.
    lines = yield core.run(load_lines, reached, area.y)
    above = max(0, lines - depth + 1) // depth * depth
    camera = core.window_ring(frame.rows[above:], core.overlay("camera_window", u8, 2 * frame.width)[:depth])
    taken = above
    for y in range(area.y, area.y + area.height):
        core.at(y - area.y)
        lines = yield core.run(load_lines, reached, y)
        for _ in range(taken, lines):
            yield from camera.line()
        taken = lines
        table = yield from places.line()
        row = yield from rectified.row()
        yield core.run(rectify_row, window, table, row)
        rectified.send()
    core.at()
    yield from rectified.flush()
    return Frame(frame.index, image, area.width, area.height)
