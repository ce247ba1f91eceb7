"""A file that appears under its name when it is complete, or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from bfsim.errors import RecordingError


@contextmanager
def growing_file(path: Path) -> Iterator[IO[bytes]]:
    """Yield a stream beside `path` that takes its place on a clean exit of the `with` block.

    After an error or Ctrl-C nothing is left of it, and a file that was at `path` before is untouched. Raises
    RecordingError where the system refuses.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    with writing(path):
        stream = temporary.open("xb")
    try:
        yield stream
        with writing(path):
            stream.close()
            temporary.replace(path)
    finally:
        with suppress(OSError):  # a full disk refuses what is still buffered; the file goes away all the same
            stream.close()
        temporary.unlink(missing_ok=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn what the system says against writing into a RecordingError."""
    try:
        yield
    except OSError as error:
        raise RecordingError(f"{path}: recording must be writable: {error.strerror}") from None
