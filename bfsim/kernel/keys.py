"""The names of what the cache keeps.

A name is a digest of everything that the entry depends on, so a changed source, profile, bfsim, LLVM or host processor
never meets a stale one.
"""

from __future__ import annotations

import hashlib
import sys
from functools import cache
from pathlib import Path

from bfsim import blackfin, machine_code
from bfsim.files.content import digest_of, python_below


def file_key(text: str) -> str:
    """Digest of all that is found in a file on which the kernels in it depend."""
    return digest("file", reader(), text)


def reading_key(*parts: str) -> str:
    """Digest of all that decides how a kernel is read."""
    return digest("kernel", reader(), *parts)


def object_key(image_digest: str, symbol: str, timing: str, variant: str) -> str:
    """Digest of all that an entry about the function `symbol` of object code depends on; `variant` says what it is."""
    return digest("object code", variant, image_digest, symbol, timing, tools())


def sources() -> list[str]:
    """Paths of the files that decide what a kernel becomes: all of this package, what instructions do, and what makes its IR machine code and calls it."""
    packages = (Path(__file__), Path(blackfin.__file__), Path(machine_code.__file__))
    return [path for each in packages for path in python_below(each.parent)]


@cache
def compiler() -> str:
    """Digest of the compiler's own sources."""
    return digest_of(sources())


@cache
def tools() -> str:
    """The compiler's own sources, LLVM and the host's processor."""
    return f"{compiler()} {machine_code.host()}"


@cache
def reader() -> str:
    """The compiler's own sources, and the Python whose grammar it reads."""
    return f"{compiler()} {sys.version}"


def digest(*parts: str) -> str:
    """Digest of texts, one after the other."""
    return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()
