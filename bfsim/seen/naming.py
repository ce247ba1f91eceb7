"""The firmware's names for the colours of a picture, as plain data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bfsim.seen.in_pictures import Colour


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedColour:
    """A colour that firmware distinguishes, and the colour to draw it with.

    `hue_deg` is its range of hues, from and to, on the firmware's own colour circle, None if it has no hue.
    """

    name: str
    colour: Colour
    hue_deg: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureColours:
    """The colours of a picture: for each pixel the number of its colour in `named`, uint8 of shape (height, width).

    `notes` are further remarks of the firmware on the picture, such as the white balance that it asks for, a sentence each.
    """

    numbers: NDArray[np.uint8]
    named: tuple[NamedColour, ...]
    notes: tuple[str, ...] = ()

    def share(self, number: int) -> float:
        """Return the share of the picture, 0 to 1, that has a colour."""
        return float((self.numbers == number).mean())
