"""Erosion as T Eq. 2.14 is written: for each pixel, a loop over the rows around it contains a loop over the columns.

[said] "For all neighbours", k from i - 1 to i + 1 and l from j - 1 to j + 1 (T §2.3.1). [said] DMA brings the lines into a ring in
L1, and takes the finished ones back (T §5.2). [assumed] The ring's lines are found by a table of where they begin.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from bfsim.api import Buffer, Core, Kernel, Row, i32, kernel, u32

RING_LINES = 3  # around a pixel
ALL_COLOURS = 0xFFFFFFFF


def looped_buffers() -> Sequence[Buffer]:
    """Return the table of where the lines around a pixel begin."""
    return (Buffer("line_starts", i32, RING_LINES, "L1_data_a"),)


@kernel
def start_lines(starts: i32[:], above: i32, here: i32, below: i32) -> None:
    """Store where the lines around a row begin in their ring."""
    starts[0] = above
    starts[1] = here
    starts[2] = below


@kernel
def erode_pixels(lines: u32[:], starts: i32[:], eroded: u32[:]) -> None:
    """Keep the colours of a row that all nine pixels around have, as `erode_row` does."""
    last = len(eroded) - 1
    eroded[0] = 0
    for x in range(1, last):
        word: u32 = ALL_COLOURS
        for row in range(3):
            for column in range(x - 1, x + 2):
                word = word & lines[starts[row] + column]
        eroded[x] = word
    eroded[last] = 0


def looped_row(
    core: Core, kernel: Kernel, ring: str, y: int, height: int, target: Row
) -> Generator[Any, Any, None]:
    """Make row `y` of a picture of `height` rows of the lines around it; line y is row y modulo the ring's rows."""
    rows = core.rows(ring)
    width = len(rows[0].array)
    starts = core.array("line_starts")
    near = (min(max(each, 0), height - 1) % len(rows) * width for each in (y - 1, y, y + 1))
    yield core.run(start_lines, starts, *near)
    lines = core.overlay(ring, u32, len(rows) * width)[0]
    yield core.run(kernel, lines, starts, target)


def looped_erosion(core: Core, image: Sequence[Row], eroded: Sequence[Row]) -> Generator[Any, Any, None]:
    """Erode a picture in SDRAM into another one."""
    height = len(image)
    lines, results = core.input_ring(image, "colour_ring"), core.output_ring("opened_ring", eroded)
    for ahead in range(height + 1):
        if ahead < height:
            yield from lines.line()
        if ahead >= 1:
            core.at(ahead - 1)
            row = yield from results.row()
            yield from looped_row(core, erode_pixels, "colour_ring", ahead - 1, height, row)
            results.send()
    core.at()
    yield from results.flush()
