"""Memory straight from the operating system: only touched pages take up room."""

from __future__ import annotations

from contextlib import suppress
from mmap import MADV_NOHUGEPAGE, MAP_ANONYMOUS, MAP_PRIVATE, mmap

import numpy as np
from numpy.typing import NDArray


def zeros(count: int) -> NDArray[np.int64]:
    """Return `count` words straight from the operating system, which clears small pages as they are touched.

    np.zeros asks for pages of 2 MB, or clears all words itself if the process has freed as much before. That cost each further board
    of a process 10 ms, and the process 100 MB.
    """
    pages = mmap(-1, 8 * count, MAP_PRIVATE | MAP_ANONYMOUS)
    with suppress(OSError):  # on a system without large pages
        pages.madvise(MADV_NOHUGEPAGE)
    return np.frombuffer(pages, np.int64)
