"""Look-up tables that travel with the firmware (T §1.3.4, pre-computation)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def arctangent_table() -> NDArray[np.uint8]:
    """Return the angles of the slopes q/256 for q = 0..256, in 1/256ths of a full turn: 0..32, rounded.

    No entry lies closer than 0.003 to a tie, so every host computes the same table.
    """
    slopes = np.arange(257) / 256
    return np.floor(np.arctan(slopes) * 128 / np.pi + 0.5).astype(np.uint8)
