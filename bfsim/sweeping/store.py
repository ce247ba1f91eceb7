"""The results of sweeps: a folder with a file for each point that was run, named by all that its result depends on.

A file is written whole or not at all, and read as data. Several sweeps may use a folder at the same time.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from bfsim.errors import ConfigError
from bfsim.files.drafts import draft_folder
from bfsim.files.save import writing
from bfsim.report.jsonable import jsonable
from bfsim.report.what_ran.digest import identity_digest
from bfsim.sweeping.running import Outcome
from bfsim.trace import Identity

if sys.platform != "win32":  # elsewhere two sweeps may do the same work twice
    import fcntl

SCHEMA = "bfsim.point/2"
"""Name and version of the layout of a file."""
CHECK = "sha256"
"""The key of a file's digest: disks forget, and people edit."""

LOCK = "lock"
CLAIM_DIGITS = 15
"""Hex digits of a key that give the position of its claim in the lock file: positions have 63 bits."""


def key_of(identity: Identity, code: str) -> str:
    """Return the name of a result: a digest of the identity of its run and of bfsim's `code`."""
    return hashlib.sha256(f"{SCHEMA} {identity_digest(identity)} {code}".encode()).hexdigest()


class Store:
    """The folder of results. Folders in it are made when they are needed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.scripts = folder / "scripts"
        self._points = folder / "points"
        self._recordings = folder / "recordings"
        self._lock = -1

    def open(self) -> None:
        """Make the folder. Raises ConfigError if that fails."""
        try:
            with writing(self.folder):
                self.folder.mkdir(parents=True, exist_ok=True)
                self._lock = os.open(self.folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        except ConfigError as error:
            raise ConfigError(f"{error}; --store DIR keeps results elsewhere") from error

    def claim(self, key: str) -> bool:
        """Claim a point for this process; False if another process has it. A process that dies loses its claims."""
        if sys.platform != "win32":
            try:
                fcntl.lockf(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, int(key[:CLAIM_DIGITS], 16))
            except BlockingIOError:
                return False
        return True

    def release(self, key: str) -> None:
        """Give up a claim."""
        if sys.platform != "win32":
            fcntl.lockf(self._lock, fcntl.LOCK_UN, 1, int(key[:CLAIM_DIGITS], 16))

    def outcome(self, key: str) -> Outcome | None:
        """Return the outcome of a point; None if there is none, or if the file is damaged."""
        plain = _read(self._file(self._points, key))
        if plain.get("schema") != SCHEMA or plain.get("key") != key:
            return None
        with suppress(ValidationError):
            return _outcomes().validate_python(plain.get("outcome"))
        return None

    def keep(self, key: str, outcome: Outcome) -> None:
        """Keep the outcome of a point, even through a loss of power."""
        self._write(self._points, key, {"schema": SCHEMA, "key": key, "outcome": jsonable(outcome)})

    def recording_digest(self, recording: Path, frames: int) -> str:
        """Return the digest of a recording that was read before and has not changed since; else ""."""
        with suppress(OSError):
            return str(_read(self._file(self._recordings, _file_key(recording, frames))).get("digest", ""))
        return ""

    def keep_recording_digest(self, recording: Path, frames: int, digest: str) -> None:
        """Keep the digest of a recording."""
        with suppress(OSError):
            self._write(self._recordings, _file_key(recording, frames), {"digest": digest})

    @staticmethod
    def _file(folder: Path, key: str) -> Path:
        return folder / key[:2] / f"{key}.json"

    def _write(self, folder: Path, key: str, plain: Mapping[str, Any]) -> None:
        path = self._file(folder, key)
        with writing(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            with draft_folder(path.parent) as drafts:
                draft = drafts / path.name
                with draft.open("w", encoding="utf-8") as stream:
                    json.dump({**plain, CHECK: _digest(plain)}, stream, ensure_ascii=False, indent=1)
                    stream.flush()
                    os.fsync(stream.fileno())
                draft.replace(path)


def _read(path: Path) -> dict[str, Any]:
    """Return the content of a file of this store; nothing if it is missing, not one, or not as written."""
    try:
        plain = json.loads(path.read_text(encoding="utf-8"))
        is_whole = isinstance(plain, dict) and plain.pop(CHECK, None) == _digest(plain)
    except FileNotFoundError:
        return {}
    except (ValueError, RecursionError):
        return {}
    except OSError as error:
        raise ConfigError(f"{path} must be a readable file: {error.strerror}") from error
    return plain if is_whole else {}


def _digest(plain: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()


def _file_key(path: Path, frames: int) -> str:
    """Return a digest of which file it is and when it was last written."""
    found = path.stat()
    parts = (str(path.resolve()), found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns, frames)
    return hashlib.sha256(repr(parts).encode(errors="surrogateescape")).hexdigest()


@cache
def _outcomes() -> TypeAdapter[Outcome]:
    return TypeAdapter(Outcome)
