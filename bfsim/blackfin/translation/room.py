"""Room for the counts of native code."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SUMS = 2
"""Words after the counts: the cycles and waits that they added up to when the code was last left (`counting`)."""


def new_counts(counters: int) -> NDArray[np.int64]:
    """Return the counts of code that has counted nothing yet."""
    return np.zeros(counters + SUMS, np.int64)
