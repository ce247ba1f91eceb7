"""Locks on folders, held as long as a process has them open."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

if sys.platform != "win32":  # elsewhere no folder can be locked
    import fcntl


def lock_folder(folder: Path) -> int | None:
    """Open and lock a folder until the returned handle is closed. Return None if another process holds it or it cannot be locked."""
    if sys.platform == "win32":
        return None
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(handle)
        else:
            return handle
    return None
