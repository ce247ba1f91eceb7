"""The files that commands write besides their reports, recognised by how they begin: the user's own files are never replaced."""

from __future__ import annotations

import re
from pathlib import Path

from bfsim.errors import ConfigError

JSON = re.compile(rb'\{\s*"schema":\s*"bfsim\.')
PAGE = re.compile(rb"<!doctype html>.*? \xe2\x80\x93 bfsim</title>", re.DOTALL)
JUNIT = re.compile(rb"<\?xml [^>]*>\s*<testsuites>\s*<testsuite name=\"bfsim check\"")
MARKDOWN = re.compile(rb"\*\*(\xe2\x9c\x85|\xe2\x9d\x8c) ")
BENCHMARK = re.compile(rb'\[\s*(\]|\{\s*"name":)')
TRACE = re.compile(rb"\n[\x80-\xff]*[\x00-\x7f]\x92\x03", re.DOTALL)
"""A first packet of Perfetto that holds others, compressed: its length, and the number of that field."""
FLAME = re.compile(rb'\{"\$schema":\s*"https://www\.speedscope\.app/')
WORK = re.compile(rb"PK\x03\x04.{26}run\.json", re.DOTALL)
"""A ZIP with that file first."""
_READ_BYTES = 4096


def require_own(path: Path, output: re.Pattern[bytes]) -> None:
    """Raise ConfigError if a file at `path` does not begin like an `output`: a user who forgets a FILE names another file."""
    if not path.exists():
        return
    try:
        with path.open("rb") as stream:
            beginning = stream.read(_READ_BYTES)
    except OSError as error:
        raise ConfigError(f"{path} must be readable to be replaced: {error.strerror}") from error
    if beginning and not output.match(beginning):
        raise ConfigError(
            f"{path} must not be there yet: it holds something else than what is written there, and is not replaced; name "
            "another FILE, or remove it; is a FILE missing behind the option?"
        )
