"""Names of cache entries.

A name is a digest of everything that the entry depends on. So no entry goes stale when a source, the profile, bfsim,
LLVM or the host processor changes.
"""

from __future__ import annotations

import hashlib
import sys
from functools import cache
from pathlib import Path

from bfsim import blackfin, machine_code
from bfsim.files.content import digest_of, python_below


def file_key(text: str) -> str:
    """Return the name of what is found in a file, on which the kernels in it depend."""
    return digest("file", reader(), text)


def reading_key(*parts: str) -> str:
    """Return the digest of all that decides how a kernel is read."""
    return digest("kernel", reader(), *parts)


def object_key(image_digest: str, symbol: str, timing: str, variant: str) -> str:
    """Return the digest of all that an entry about the object code of `symbol` depends on; `variant` says what it is."""
    return digest("object code", variant, image_digest, symbol, timing, tools())


def sources() -> list[str]:
    """Return the paths of the files that decide what a kernel becomes.

    These are this package, the instructions of the Blackfin, and what makes machine code of IR and calls it.
    """
    packages = (Path(__file__), Path(blackfin.__file__), Path(machine_code.__file__))
    return [path for each in packages for path in python_below(each.parent)]


@cache
def compiler() -> str:
    """Return the digest of the compiler's own sources."""
    return digest_of(sources())


@cache
def tools() -> str:
    """Return the identity of the compiler's own sources, of LLVM and of the host's processor."""
    return f"{compiler()} {machine_code.host()}"


@cache
def reader() -> str:
    """Return the identity of the compiler's own sources, and of the Python whose grammar it reads."""
    return f"{compiler()} {sys.version}"


def digest(*parts: str) -> str:
    """Return the digest of texts, one after the other."""
    return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()
