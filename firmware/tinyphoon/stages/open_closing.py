"""Open & closing: noise removal in the colour image, all 32 colours at once (T §2.3.1, §5.2.3).

The thesis names the stage after both operations. Its robot applies the opening, erosion and then dilation (T §5.2.3),
which removes single pixels. The closing, dilation and then erosion, fills gaps of single pixels; one after the other
does both (T Figure 2.6). Each is a pass over the picture. The thesis says that either may be applied many times for a
larger effect; but repeating one changes nothing more, so that is not offered.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from bfsim.api import Core, Frame, Kernel, kernel, u32
from tinyphoon.scan_lines import line_ring, windows


class NoiseOrder(IntEnum):
    """Which operations are applied, in order."""

    OPENING = 0  # T §5.2.3
    CLOSING = 1
    CLOSING_OPENING = 2  # T Figure 2.6
    OPENING_CLOSING = 3


CLOSES = {
    NoiseOrder.OPENING: (False,),
    NoiseOrder.CLOSING: (True,),
    NoiseOrder.CLOSING_OPENING: (True, False),
    NoiseOrder.OPENING_CLOSING: (False, True),
}
"""For each pass over the picture, whether it is a closing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseRemoval:
    """How noise is removed from the colour image: an opening, a closing, or both in either order."""

    order: NoiseOrder

    @property
    def passes(self) -> Sequence[tuple[str, bool]]:
        """The passes: the image that each one reads, and whether it is a closing. All write the opened image."""
        images = "colour_image", "opened_image"  # a line is read before it is written
        return tuple(zip(images, CLOSES[self.order], strict=False))


# Erosion and dilation each need one line below theirs, so the finished line trails the incoming one.
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


@kernel
def repeat_border(row: u32[:]) -> None:
    """Give the border pixels of a dilated row the colours beside them, or the next erosion takes them for gaps."""
    last = len(row) - 1
    row[0] = row[1]
    row[last] = row[last - 1]


def open_closing(
    core: Core, frame: Frame, noise: NoiseRemoval, erode: Kernel = erode_row, dilate: Kernel = dilate_row
) -> Generator[Any, Any, None]:
    """Leave the colour image without its noise in `opened_image` in SDRAM. `erode` and `dilate` make a row."""
    run, at = core.run, core.at
    for image, closes in noise.passes:
        colours = core.input_ring(core.rows(image), "colour_ring")
        first, second = (dilate, erode) if closes else (erode, dilate)
        opened = core.output_ring("opened_ring", core.rows("opened_image"))
        height = frame.height
        between = line_ring(core.rows("eroded_ring"), height)
        near = windows(between)
        at(0)
        here = below = yield from colours.line()
        for y in range(1, height + LAG_LINES):
            above, here = here, below  # the first and the last line repeat
            if y < height:
                at(y)
                below = yield from colours.line()
            if y <= height:
                at(y - 1)
                yield run(first, above, here, below, between[y - 1])
                if closes:
                    yield run(repeat_border, between[y - 1])
            if y >= LAG_LINES:
                at(y - LAG_LINES)
                row = yield from opened.row()
                top, middle, bottom = near[y - LAG_LINES]
                yield run(second, top, middle, bottom, row)
                opened.send()
        at()
        yield from opened.flush()
