"""Data of frames, kept outside memory during a run."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping
from typing import Self

from bfsim.errors import ConfigError


class Spool(Mapping[int, bytes]):
    """Bytes by the index of their frame, in a file that has no name and disappears with the process.

    A context manager. Raises ConfigError if there is no room for the file.
    """

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile()  # noqa: SIM115 - closed at the end of the `with` block
        self._places: dict[int, tuple[int, int]] = {}  # offset and bytes

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._file.close()

    def put(self, index: int, content: bytes) -> None:
        """Keep the bytes of a frame. Raises ConfigError if there is no room for them."""
        try:
            self._places[index] = self._file.seek(0, os.SEEK_END), self._file.write(content)
            self._file.flush()
        except OSError as error:
            where = tempfile.gettempdir()
            raise ConfigError(f"{where} must have room for what was seen: {error.strerror}") from error

    def __getitem__(self, index: int) -> bytes:
        offset, nbytes = self._places[index]
        self._file.seek(offset)
        return self._file.read(nbytes)

    def __iter__(self) -> Iterator[int]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)
