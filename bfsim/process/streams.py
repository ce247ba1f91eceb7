"""Standard output and standard error, which firmware may redirect as it runs."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def streams_kept() -> Iterator[None]:
    """Restore both at the end of the `with` block: two main loops that redirect them may not undo it in the right order."""
    streams = sys.stdout, sys.stderr
    try:
        yield
    finally:
        sys.stdout, sys.stderr = streams
