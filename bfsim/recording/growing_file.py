"""A file that appears under its name when it is complete, or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path
from typing import IO

from bfsim.errors import RecordingError
from bfsim.files.drafts import growing_draft


def require_free(path: Path, *, force: bool) -> None:
    """Raise RecordingError unless `path` may be written: it is free, or a *.mcap that `force` overwrites."""
    if not path.exists():
        return
    if not force:
        raise RecordingError(f"{path}: recording must not exist yet; `--force` overwrites it")
    if path.suffix.lower() != ".mcap":
        raise RecordingError(
            f"{path}: recording must not exist yet, or be called *.mcap: `--force` overwrites nothing else, as a source by a slip"
        )


def growing_file(path: Path) -> AbstractContextManager[IO[bytes]]:
    """Yield a stream to a file beside `path` that replaces it on a clean exit of the `with` block.

    Raises RecordingError if the system refuses.
    """
    return growing_draft(path, partial(writing, path))


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn the system's errors of writing into RecordingError."""
    try:
        yield
    except OSError as error:
        raise RecordingError(f"{path}: recording must be writable: {error.strerror}") from None
