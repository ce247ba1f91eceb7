"""The cache on disk: compiled kernels, their costs and other things that take long to make, shared by all processes of a user.

An entry's name is a digest of everything that it depends on. Files are written aside and renamed, since two processes may
start at once.

Entries are executed as they are, so nobody else may write them: the folder and each entry belong to the user alone, and an
entry's checksum covers its name and its contents.

Some of these things come with bfsim, also under such names.
"""

from __future__ import annotations

import hashlib
import json
import os
import stat
import tempfile
import warnings
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.resources import files
from io import FileIO
from pathlib import Path
from typing import Any

import platformdirs

from bfsim.errors import BfsimWarning, shown
from bfsim.files.locks import lock_folder

CHECKSUM_BYTES = 32
PRIVATE = 0o700
KEPT = "kept"
"""Folder of a package with entries that come with bfsim."""


def folder() -> Path:
    """Return where compiled kernels are kept: $BFSIM_CACHE_DIR, or the user's cache folder."""
    return _path(os.environ.get("BFSIM_CACHE_DIR") or platformdirs.user_cache_dir("bfsim"))


@cache
def _path(name: str) -> Path:
    """Return a folder by its name, with `~` expanded as a shell would. Starting up calls this hundreds of times."""
    return Path(os.path.expanduser(name))  # noqa: PTH111  # `Path` raises for a user who does not exist


def can_keep() -> bool:
    """Return whether the cache can be written and read again."""
    place = _trusted(folder())
    return place is not None and _is_writable(place)


def load(name: str) -> bytes | None:
    """Return the entry `name`, or None if there is none, it is damaged, or another user may have written it."""
    place = _trusted(folder())
    if place is None:
        return None
    try:
        with FileIO(f"{place}/{name[:2]}/{name}") as file:  # starting up loads hundreds of them
            if _stranger(os.fstat(file.fileno())):
                return None
            data = file.readall()
    except OSError:
        return None
    checksum, body = data[:CHECKSUM_BYTES], data[CHECKSUM_BYTES:]
    return body if checksum == _checksum(name, body) else None


def save(name: str, body: bytes) -> None:
    """Keep `body` under `name`. A cache that cannot be written is no error: a warning says that the next start compiles again."""
    place = _trusted(folder())
    if place is None or not _is_writable(place):
        return
    try:
        _write(place / name[:2], name, _checksum(name, body) + body)
    except FileNotFoundError:  # another process is emptying the cache
        pass
    except OSError as error:
        _tell_refusal(place, str(error.strerror))


def _write(place: Path, name: str, data: bytes) -> None:
    """Write a file completely or not at all."""
    place.mkdir(mode=PRIVATE, exist_ok=True)
    handle, aside = tempfile.mkstemp(dir=place)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(aside).replace(place / name)
    except BaseException:
        Path(aside).unlink()
        raise


@contextmanager
def claimed() -> Iterator[bool]:
    """Yield whether this process fills the cache ahead: only one does, until the `with` block and all processes forked in it end."""
    place = _trusted(folder())
    lock = lock_folder(place) if place is not None and _is_writable(place) else None
    try:
        yield lock is not None
    finally:
        if lock is not None:
            os.close(lock)


def kept(name: str, made: Callable[[], Any]) -> Any:
    """Return the data kept under `name`, or `made` and kept now, as JSON returns them: tuples as lists."""
    found = load(name)
    if found is None:
        found = json.dumps(made(), separators=(",", ":")).encode()
        save(name, found)
    return json.loads(found)


def shipped(package: str, name: str) -> bytes | None:
    """Return what comes with bfsim in a package under a digest of its source, None if there is nothing for that source."""
    file = files(package) / KEPT / name
    return zlib.decompress(file.read_bytes()) if file.is_file() else None


def _checksum(name: str, body: bytes) -> bytes:
    """Return the checksum of an entry, which is valid only under its own name."""
    return hashlib.sha256(f"{name}\0".encode() + body).digest()


@cache
def _trusted(place: Path) -> Path | None:
    """Return the cache's folder, creating it if necessary. Return None, after a warning, if there is none or others can write in it.

    The folders above are not checked: whoever can replace the folder by another cannot make the user its owner.
    """
    try:
        place.mkdir(mode=PRIVATE, parents=True, exist_ok=True)
        stranger = _stranger(place.stat())
        must = f"private, for what is in it is run, but {stranger}" if stranger else ""
        advice = "`chmod 700` makes a folder of your own private, and "
    except OSError as error:
        must, advice = f"a folder, and there is none and none can be made: {error.strerror}", ""
    if must:
        every = f"it is not used, and every start compiles all kernels; {advice}"
        _warn(place, f"be {must}: {every}")
        return None
    return place


@cache
def _is_writable(place: Path) -> bool:
    """Return whether the user can write to the cache's folder. Warn if not."""
    if os.access(place, os.W_OK | os.X_OK):
        return True
    _warn(place, "be writable: every start compiles what is not in it; `chmod u+w` makes it so, and ")
    return False


@cache
def _tell_refusal(place: Path, why: str) -> None:
    """Warn, once, that nothing more can be kept."""
    _warn(place, f"take more, and does not ({why}): every start compiles what is not in it; ")


def _warn(place: Path, must: str) -> None:
    """Warn about what the cache's folder must be."""
    warnings.warn(
        f"the kernel cache {shown(str(place))} must {must}BFSIM_CACHE_DIR names another one",
        BfsimWarning,
        stacklevel=3,
    )


def _stranger(found: os.stat_result) -> str:
    """Say who else can write to a file or folder, or nothing if only this user can."""
    if os.name != "posix":  # elsewhere, modes say nothing about that
        return ""
    if found.st_uid != os.geteuid():
        return f"it belongs to the user with the number {found.st_uid}"
    if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return f"others may write to it (mode {stat.S_IMODE(found.st_mode):o})"
    return ""
