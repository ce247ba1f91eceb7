"""Look-up tables that come with the firmware (T §1.3.4, pre-computation)."""

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


def root_table() -> NDArray[np.uint8]:
    """Return the roots of 0..255, then those of 16 k for k = 0..4095, rounded down."""
    squares = np.concatenate((np.arange(256), 16 * np.arange(4096)))
    return np.floor(np.sqrt(squares)).astype(np.uint8)


def reciprocal_table() -> NDArray[np.uint32]:
    """Return 1/n as a fraction of 1 << 28, rounded up, for n = 1..1020, the components of a Sobel gradient; 0 for 0."""
    return np.array([0, *(-(-(1 << 28) // n) for n in range(1, 1021))], np.uint32)
