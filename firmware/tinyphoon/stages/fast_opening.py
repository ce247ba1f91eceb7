"""Open & closing column by column, bit-identical to `open_closing.py`: three pixels of a column are combined once."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from bfsim.api import Core, Frame, kernel, u32
from tinyphoon.stages.open_closing import NoiseRemoval, open_closing


@kernel
def erode_columns(above: u32[:], here: u32[:], below: u32[:], eroded: u32[:]) -> None:
    """Keep the colours of a row that all nine pixels around have, as `erode_row` does."""
    last = len(here) - 1
    column = above[1] & here[1] & below[1]
    both = above[0] & here[0] & below[0] & column  # this column and the one before it
    eroded[0] = 0
    for x in range(1, last):
        after = above[x + 1] & here[x + 1] & below[x + 1]
        eroded[x] = both & after
        both = column & after
        column = after
    eroded[last] = 0


@kernel
def dilate_columns(above: u32[:], here: u32[:], below: u32[:], dilated: u32[:]) -> None:
    """Give each pixel of a row the colours of all nine around it, as `dilate_row` does."""
    last = len(here) - 1
    column = above[1] | here[1] | below[1]
    both = above[0] | here[0] | below[0] | column  # this column and the one before it
    dilated[0] = 0
    for x in range(1, last):
        after = above[x + 1] | here[x + 1] | below[x + 1]
        dilated[x] = both | after
        both = column | after
        column = after
    dilated[last] = 0


def fast_opening(core: Core, frame: Frame, noise: NoiseRemoval) -> Generator[Any, Any, None]:
    """Leave the colour image without its noise in `opened_image` in SDRAM."""
    yield from open_closing(core, frame, noise, erode_columns, dilate_columns)
