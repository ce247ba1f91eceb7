"""Python's search for garbage: nearly all that a command or a run makes lives as long as that."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

COLLECT_AFTER = 500_000
"""So many new objects make Python look for garbage, in place of 700: it took a seventh of a command's time, and a twentieth of a run's.

More than a command makes until its run begins: looking through these took 80 ms each time.
"""


def collect_rarely() -> None:
    """Have Python look for garbage rarely from now on."""
    gc.set_threshold(COLLECT_AFTER)


def collect_no_more() -> None:
    """Have Python look at nothing that there is any more: a process that ends gives all back at once.

    Python would look through all of it twice while it ends, which takes a fifth of a second.
    """
    gc.freeze()


@contextmanager
def rarely_collected() -> Iterator[None]:
    """Have Python look for garbage rarely inside."""
    before = gc.get_threshold()
    collect_rarely()
    try:
        yield
    finally:
        gc.set_threshold(*before)
