"""The cache of compiled kernels on disk: machine code and counters, shared by every process of a user.

An entry's name is a digest of everything it depends on, so a changed source, profile, bfsim, LLVM or host
processor never meets a stale one. Files are written aside and renamed: two processes may start at once.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

import llvmlite
import llvmlite.binding as llvm
import platformdirs

from bfsim.kernel import tree
from bfsim.kernel.profile import CompilerProfile

CHECKSUM_BYTES = 32


def folder() -> Path:
    """Where compiled kernels are kept: $BFSIM_CACHE_DIR, or the user's cache folder."""
    named = os.environ.get("BFSIM_CACHE_DIR")
    return Path(named) if named else Path(platformdirs.user_cache_dir("bfsim"))


def key(function: tree.Function, profile: CompilerProfile, variant: str) -> str:
    """Digest of all that an entry about `function` depends on; `variant` says what it is."""
    return hashlib.sha256(f"{variant}\0{_source(function, profile)}".encode()).hexdigest()


@cache
def _source(function: tree.Function, profile: CompilerProfile) -> str:
    """Digest of what every entry about a kernel depends on."""
    digest = hashlib.sha256()
    for part in (tools(), repr(profile), repr(function)):
        digest.update(part.encode())
        digest.update(b"\0")
    return digest.hexdigest()


def sources() -> list[Path]:
    """Files that decide what a kernel becomes: all of this package."""
    return sorted(Path(__file__).parent.rglob("*.py"))


@cache
def tools() -> str:
    """The compiler's own sources, LLVM and the host's processor."""
    digest = hashlib.sha256()
    for path in sources():
        digest.update(path.read_bytes())
    host = (
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
        llvmlite.__version__,
        llvm.llvm_version_info,
    )
    return f"{digest.hexdigest()} {host}"


def can_keep() -> bool:
    """Return whether the cache can be written."""
    with suppress(OSError):
        folder().mkdir(parents=True, exist_ok=True)
    return os.access(folder(), os.W_OK | os.X_OK) and folder().is_dir()


def load(name: str) -> bytes | None:
    """Return the entry `name`, or None when there is none or it is damaged."""
    try:
        data = (folder() / name[:2] / name).read_bytes()
    except OSError:
        return None
    checksum, body = data[:CHECKSUM_BYTES], data[CHECKSUM_BYTES:]
    if hashlib.sha256(body).digest() != checksum:
        return None
    return body


def save(name: str, body: bytes) -> None:
    """Keep `body` under `name`. A cache that cannot be written is no error; the next start compiles again."""
    with suppress(OSError):
        place = folder() / name[:2]
        place.mkdir(parents=True, exist_ok=True)
        handle, aside = tempfile.mkstemp(dir=place)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(body).digest() + body)
            Path(aside).replace(place / name)
        except BaseException:
            Path(aside).unlink()
            raise
