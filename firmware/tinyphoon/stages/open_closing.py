"""Open & closing: noise removal in the colour image, all 32 colours at once (T §2.3.1, §5.2.3).

The thesis names the stage after both operations; what it applies is the opening: erosion, then dilation.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, Kernel, kernel, u32
from tinyphoon.scan_lines import line_ring, window

# Erosion and dilation each need one line below theirs, so the finished line trails the one that comes in.
LAG_LINES = 2


@kernel
def erode_row(above: u32[:], here: u32[:], below: u32[:], eroded: u32[:]) -> None:
    """Keep the colours of a row that all nine pixels around have (T Eq. 2.14). Border pixels get none."""
    last = len(here) - 1
    eroded[0] = 0
    for x in range(1, last):
        top = above[x - 1] & above[x] & above[x + 1]
        middle = here[x - 1] & here[x] & here[x + 1]
        bottom = below[x - 1] & below[x] & below[x + 1]
        eroded[x] = top & middle & bottom
    eroded[last] = 0


@kernel
def dilate_row(above: u32[:], here: u32[:], below: u32[:], dilated: u32[:]) -> None:
    """Give each pixel of a row the colours of all nine around it (T Eq. 2.15). Border pixels get none."""
    last = len(here) - 1
    dilated[0] = 0
    for x in range(1, last):
        top = above[x - 1] | above[x] | above[x + 1]
        middle = here[x - 1] | here[x] | here[x + 1]
        bottom = below[x - 1] | below[x] | below[x + 1]
        dilated[x] = top | middle | bottom
    dilated[last] = 0


def open_closing(
    core: Core, frame: Frame, erode: Kernel = erode_row, dilate: Kernel = dilate_row
) -> Generator[Any, Any, None]:
    """Open the colour image in one pass of DMA lines; leaves `opened_image` in SDRAM. `erode` and `dilate` make a row."""
    colours = core.input_ring(core.rows("colour_image"), "colour_ring")
    opened = core.output_ring("opened_ring", core.rows("opened_image"))
    height = frame.height
    eroded = line_ring(core.rows("eroded_ring"), height)
    for y in range(height + LAG_LINES):
        if y < height:
            core.at(y)
            yield from colours.line()
        if 1 <= y <= height:
            core.at(y - 1)
            yield core.run(erode, *window(colours, y - 1, height), eroded[y - 1])
        if y >= LAG_LINES:
            core.at(y - LAG_LINES)
            row = yield from opened.row()
            yield core.run(dilate, *window(eroded, y - LAG_LINES, height), row)
            opened.send()
    core.at()
    yield from opened.flush()
