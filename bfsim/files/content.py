"""Reading a file whole that somebody names, which may be a device, which never ends; and the lines of a source."""

from __future__ import annotations

import errno
import re
from pathlib import Path

MB = 1 << 20


def read_bounded(path: Path, most_mb: int = 16) -> bytes:
    """Return the content of a file of at most `most_mb` MB. Raises OSError, also for a larger one."""
    with path.open("rb") as stream:
        content = stream.read(most_mb * MB + 1)
    if len(content) > most_mb * MB:
        raise OSError(errno.EFBIG, f"it has more than {most_mb} MB", str(path))
    return content


def lines_of(text: str) -> list[str]:
    """Return the lines of a source as compilers count them: a form feed, which `splitlines` takes for an end, is within one."""
    *lines, last = re.split(r"\r?\n", text)
    return [*lines, last] if last else lines
