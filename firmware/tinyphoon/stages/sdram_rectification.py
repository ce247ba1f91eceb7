"""Rectification as in T §5.2.5: each pixel is moved from where a look-up table says, from SDRAM to SDRAM.

[said] One table a picture, of its size, in place of Matlab's, to save the time of random accesses to SDRAM (T §5.2.5). [implied] So the
core itself reads table and pixels there, each by one access; and since DMA brings the edge detection line by line what it reads (T §5.2.1),
this is a pass of its own before it. No row of T Table 6.4 names it: its time is in that of the edge detection, which is said to be due to
the reading of the image from SDRAM (T §6.6). [assumed] Entries have 32 bits, for 320x240 pixels have more places than 16 bits count; two
pixels share the colour of the left one's pair, as in `rectification.py`, and are stored together; and pictures that are rectified already
have a table, too, for the robot's always had one.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import Any

import numpy as np

from bfsim.api import Buffer, Buffers, Core, Frame, FrameSize, SourcePixels, i32, kernel, u8, u16, u32
from tinyphoon.areas import WHOLE_PICTURE, Area, area_in, cropped
from tinyphoon.stages.rectification import sighted_columns

NOWHERE = -1
CHROMA = 0x00FF00FF  # of a pair U Y V Y, the first byte lowest
BLACK_PAIR = 0x00800080


def untouched(size: FrameSize) -> SourcePixels:
    """Return the table of pictures that are already rectified: each pixel stays."""
    rows, columns = np.indices((size.height_px, size.width_px), np.int32)
    return SourcePixels(rows, columns)


def sdram_rectification_buffers(sources: Mapping[str, SourcePixels]) -> Buffers:
    """Return the buffers for a recording's tables in the memory of each core."""
    return {core: _core_buffers(each) for core, each in sources.items()}


def _core_buffers(sources: SourcePixels) -> Sequence[Buffer]:
    height, width = sources.rows.shape
    places = np.where(sources.rows >= 0, sources.rows * width + sources.columns, NOWHERE)
    first, last = sighted_columns(sources.rows)
    return (
        Buffer("sighted_first", u16, height, "data1", values=first),
        Buffer("sighted_last", u16, height, "data1", values=last),
        Buffer("places", i32, width, "sdram0", rows=height, values=places),
        Buffer("rectified_image", u8, 2 * width, "sdram0", rows=height),
    )


@kernel
def move_row(camera: u8[:], words: u32[:], places: i32[:], rectified: u32[:]) -> None:
    """Take a UYVY row of `len(places)` pixels from a picture; places count pixels. `words`: the pairs of `camera`."""
    for pair in range(len(rectified)):
        left = places[2 * pair]
        right = places[2 * pair + 1]
        word: u32 = BLACK_PAIR
        if left >= 0:
            word = words[left >> 1]
            luma = word >> 24 if left & 1 != 0 else word >> 8 & 255
            word = word & CHROMA | luma << 8
        if right >= 0:
            word = word | u32(camera[2 * right + 1]) << 24
        rectified[pair] = word


def sdram_rectification(core: Core, frame: Frame, area: Area = WHOLE_PICTURE) -> Generator[Any, Any, Frame]:
    """Rectify an area of a picture; leave `rectified_image` in SDRAM and return it as a frame, like `rectification`.

    Without tables the picture counts as rectified: its area is returned.
    """
    area = area_in(frame, area)
    if not core.has_buffer("places"):
        return cropped(core, frame, area)
    nbytes = 2 * frame.width * frame.height
    camera = core.overlay(frame.rows, u8, nbytes)[0], core.overlay(frame.rows, u32, nbytes // 4)[0]
    places = core.part(core.rows("places")[area.y : area.y + area.height], area.x, area.width)
    image = core.overlay("rectified_image", u8, 2 * area.width)[: area.height]
    words = core.overlay(image, u32, area.width // 2)
    for y in range(area.height):
        core.at(y)
        yield core.run(move_row, *camera, places[y], words[y])
    core.at()
    return Frame(frame.index, image, area.width, area.height)
