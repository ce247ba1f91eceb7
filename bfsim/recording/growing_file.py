"""A file that appears under its name when it is complete, or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO

from bfsim.drafts import draft_folder
from bfsim.errors import RecordingError


@contextmanager
def growing_file(path: Path) -> Iterator[IO[bytes]]:
    """Yield a stream beside `path` that takes its place on a clean exit of the `with` block.

    After an error or Ctrl-C nothing is left of it, and a file that was at `path` before is untouched. Raises
    RecordingError where the system refuses.
    """
    with ExitStack() as stack:
        with writing(path):
            draft = stack.enter_context(draft_folder(path.parent)) / path.name
            stream = draft.open("xb")
        try:
            yield stream
            with writing(path):
                stream.close()
                draft.replace(path)
        finally:
            with suppress(
                OSError
            ):  # a full disk refuses what is still buffered; the file goes away all the same
                stream.close()


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn what the system says against writing into a RecordingError."""
    try:
        yield
    except OSError as error:
        raise RecordingError(f"{path}: recording must be writable: {error.strerror}") from None
