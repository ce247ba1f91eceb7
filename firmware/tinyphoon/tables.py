"""Look-up tables that travel with the firmware (T §1.3.4, pre-computation)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

TANGENT_BITS = 12


def arctangent_table() -> NDArray[np.uint8]:
    """Return the angles of the slopes q/256 for q = 0..256, in 1/256ths of a full turn: 0..32, rounded.

    No entry lies closer than 0.003 to a tie, so every host computes the same table.
    """
    slopes = np.arange(257) / 256
    return np.floor(np.arctan(slopes) * 128 / np.pi + 0.5).astype(np.uint8)


def tangent_table() -> NDArray[np.uint16]:
    """Return the tangents of 0..32 256ths of a full turn, 0 to 45 degrees, as fractions of 1 << TANGENT_BITS, rounded.

    No entry lies closer than 0.0003 to a tie, so every host computes the same table.
    """
    angles = np.arange(33) * np.pi / 128
    return np.floor(np.tan(angles) * (1 << TANGENT_BITS) + 0.5).astype(np.uint16)
