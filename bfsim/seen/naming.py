"""What firmware calls the colours of a picture, as plain data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bfsim.seen.in_pictures import Colour


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedColour:
    """A colour that firmware tells from others, and the one to draw it with.

    `hue_deg`: the hues that it stands for, from and to, on the firmware's own colour circle; none where it has no hue.
    """

    name: str
    colour: Colour
    hue_deg: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureColours:
    """The colours of a picture: for each pixel the number of its colour in `named`, uint8 of shape (height, width).

    `notes`: what the firmware says of the picture besides, such as the white balance that it asks for, a sentence each.
    """

    numbers: NDArray[np.uint8]
    named: tuple[NamedColour, ...]
    notes: tuple[str, ...] = ()

    def share(self, number: int) -> float:
        """Return the part of the picture, 0 to 1, that has a colour."""
        return float((self.numbers == number).mean())
