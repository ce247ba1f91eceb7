"""Writing a file completely or not at all, and one process at a time."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import IO

from bfsim.errors import ConfigError, legible
from bfsim.files.drafts import growing_draft

if sys.platform != "win32":
    import fcntl

_STDOUT = Path("-")
"""Standard output, as in many other programs."""


def require_place(path: Path) -> None:
    """Raise ConfigError unless a file can be written at `path`: its folder is writable, and nothing but a file is there."""
    require_name(path)
    if not path.parent.is_dir():
        raise ConfigError(f"{path}: the folder {path.parent} must exist to write a file there")
    if path.exists() and not path.is_file():
        raise ConfigError(f"{path} must be an ordinary file, not a folder or a device")
    if not os.access(_resolved(path).parent, os.W_OK):
        raise ConfigError(f"{path}: the folder {path.parent} must be writable to write a file there")


def require_name(path: Path) -> None:
    """Raise ConfigError if a path means standard output."""
    if path == _STDOUT:
        raise ConfigError(
            f"{path} must be the name of a file, not standard output: the file appears only once it is whole"
        )


def require_apart(path: Path, others: Iterable[Path | None]) -> None:
    """Raise ConfigError if one of the `others`, which a command also reads or writes, is the file at `path`."""
    if _resolved(path) in {_resolved(each) for each in others if each}:
        raise ConfigError(
            f"{path} must be a file of its own to be written, not one that is read or written, too"
        )


def write_text(path: Path, text: str | Iterable[str]) -> None:
    """Write `text`, or its parts in sequence, to `path` as `write_bytes` does."""
    parts = [text] if isinstance(text, str) else text
    write_bytes(path, (legible(each).encode() for each in parts))


def write_bytes(path: Path, content: Iterable[bytes]) -> None:
    """Write `content` beside `path` first, and then move it there. Links are followed, and permissions are kept.

    Raises ConfigError if the system refuses.
    """
    with growing_file(path) as stream, writing(path):
        stream.writelines(content)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Make other processes that change a file in `folder` wait until the end of the `with` block, which may read it and write it back.

    If the folder cannot be locked, they do not wait.
    """
    if sys.platform == "win32":
        yield
        return
    with writing(folder):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def growing_file(path: Path) -> AbstractContextManager[IO[bytes]]:
    """Return a context of a stream whose content becomes the file at `path` on a clean exit, as with `write_bytes`."""
    require_place(path)
    return growing_draft(_resolved(path), partial(writing, path))


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn the system's refusal to write into a ConfigError."""
    try:
        yield
    except OSError as error:
        raise ConfigError(f"{path} must be writable: {error.strerror}") from error


def _resolved(path: Path) -> Path:
    """Return where a path leads. Raises ConfigError for links in a circle and for invalid names.

    Raises FileNotFoundError if the current folder was removed, and UnicodeEncodeError for a name that it cannot encode.
    """
    try:
        place = path.resolve()
        is_circle = place.is_symlink()  # since Python 3.13 `resolve` says nothing
    except (FileNotFoundError, UnicodeEncodeError):
        raise
    except (OSError, RuntimeError, ValueError):
        is_circle = True
    if is_circle:
        raise ConfigError(f"{path} must lead to a place, not in a circle of links")
    return place
