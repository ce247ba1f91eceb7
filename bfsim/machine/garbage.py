"""Python's search for garbage: a run makes next to none that it is needed for."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

OBJECTS = 100_000
"""[ours] After so many new ones Python looks, in place of 700, which takes it 5 % of a run. As many take some 10 MB at most."""


@contextmanager
def rarely_collected() -> Iterator[None]:
    """Have Python look for garbage rarely."""
    before = gc.get_threshold()
    gc.set_threshold(OBJECTS, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
