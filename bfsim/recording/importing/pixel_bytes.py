"""Detect raw grey or sensor frames with two bytes a pixel, where `--bits` was not given and one byte is assumed.

With two bytes a pixel, the lower one is like noise and the upper one like a picture, so every other byte differs more
from the next pixel's.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.importing.sources import PictureSource

NEXT_BYTES = 4
"""The distance to the next pixel of the same colour behind a sensor's filters, if pixels have two bytes."""

ROUGHER = 2.4
"""How many times more every other byte differs before there is a warning.

It is 0.8 to 1.1 in 136 real pictures with one byte a pixel, grey and from sensors, and 5.2 and more in the same
pictures with two, of which 10 to 16 bits are used.
"""


def pixel_bytes_warnings(sources: Iterable[PictureSource]) -> Iterator[str]:
    """Yield a warning for each raw source with one byte a pixel whose pixels seem to have two."""
    for source in sources:
        if source.count:
            octets = np.memmap(source.name, np.uint8, "r")
            frame = octets[: len(octets) // source.count]
            is_of_bytes = len(frame) == source.size[0] * source.size[1]
            if is_of_bytes and (order := order_of_two_bytes(frame)):
                yield f"Warning: {source.name}: pixels seem to have two bytes, {order}"


def order_of_two_bytes(frame: NDArray[np.uint8]) -> str:
    """Return which byte of a pixel comes first, and what to do; "" if each pixel seems to have one."""
    steps = np.abs(frame[NEXT_BYTES:].astype(np.int16) - frame[:-NEXT_BYTES])
    if len(steps) < 2:
        return ""
    first, second = float(steps[0::2].mean()), float(steps[1::2].mean())
    if first > ROUGHER * second:
        return "the lower one first: say with `--bits` how many of the 16 bits the camera uses"
    if second and not first:
        return "of which the first one is always the same: the upper one has all, say `--bits 16`"
    if second > ROUGHER * first:
        return "the upper one first: swap them, as `dd conv=swab` does, and say with `--bits` how many of the 16 bits the camera uses"
    return ""
