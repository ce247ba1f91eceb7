"""The names of what the cache keeps of a kernel.

A name is a digest of everything that the entry depends on, so a changed source, profile, bfsim, LLVM or host processor
never meets a stale one.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Collection, Iterable
from functools import cache
from pathlib import Path, PurePath

from bfsim import blackfin, machine_code
from bfsim.kernel.function import Function
from bfsim.kernel.profile import CompilerProfile, Inlines


def key(function: Function, profile: CompilerProfile, variant: str) -> str:
    """Digest of all that an entry about `function` depends on; `variant` says what it is."""
    return _digest(variant, _source(function, profile))


def file_key(text: str) -> str:
    """Digest of all that is found in a file on which the kernels in it depend."""
    return _digest("file", reader(), text)


def reading_key(*parts: str) -> str:
    """Digest of all that decides how a kernel is read."""
    return _digest("kernel", reader(), *parts)


def estimate_key(function: Function) -> str:
    """Digest of all that the estimate of `function` by itself depends on, in whatever profile and program."""
    return _digest("estimate", tools(), *(each.digest for each in (function, *function.callees())))


def program_key(functions: Iterable[Function], entries: Collection[str]) -> str:
    """Digest of all that the C of kernels depends on, wherever their files lie; `entries`: symbols of those that something else calls."""
    found = sorted(functions, key=lambda each: (each.file, each.first_line))
    files = {file: number for number, file in enumerate(dict.fromkeys(each.file for each in found))}
    rows = [
        (files[each.file], PurePath(each.file).parts[-2:], each.symbol, each.source, each.digest)
        for each in found
    ]
    public = [each.symbol for each in found if each.is_static and each.symbol in entries]
    return _digest("C", _writer(), repr(rows), repr(public))


def object_key(image_digest: str, symbol: str, timing: str, variant: str) -> str:
    """Digest of all that an entry about the function `symbol` of object code depends on; `variant` says what it is."""
    return _digest("object code", variant, image_digest, symbol, timing, tools())


@cache
def _source(function: Function, profile: CompilerProfile) -> str:
    """Digest of what every entry about a kernel depends on."""
    program = (function, *compiled_with(function, profile))
    return _digest(tools(), repr(profile), *(each.digest for each in program))


def compiled_with(function: Function, profile: CompilerProfile) -> tuple[Function, ...]:
    """Return the kernels on which the code of `function` depends, callees first: its own program, and what else calls parts of it.

    Where a compiler inlines within a file, other kernels of the file may call the same helpers.
    """
    program = (*function.callees(), function)
    if profile.inlines is not Inlines.FILE:
        return program
    callers = {
        each.symbol: each
        for part in program
        for each in part.siblings()
        if not set(each.callees()).isdisjoint(program)
    }
    more = (callers[symbol] for symbol in sorted(callers))
    return tuple(dict.fromkeys((*program, *(part for each in more for part in (*each.callees(), each)))))


def sources() -> list[Path]:
    """Files that decide what a kernel becomes: all of this package, what instructions do, and what makes its IR machine code and calls it."""
    packages = (Path(__file__), Path(blackfin.__file__), Path(machine_code.__file__))
    return [path for each in packages for path in sorted(each.parent.rglob("*.py"))]


@cache
def compiler() -> str:
    """Digest of the compiler's own sources."""
    return hashlib.sha256(b"".join(each.read_bytes() for each in sources())).hexdigest()


@cache
def _writer() -> str:
    """Digest of the sources that write C: what the reader makes of kernels is in their own digests."""
    here = Path(__file__).parent
    names = ("constants.py", "function.py", "operators.py", "tree.py", "types.py")
    found = [here / each for each in names]
    found += [each for folder in ("c", "intrinsics") for each in sorted((here / folder).rglob("*.[hp]*"))]
    return hashlib.sha256(b"".join(each.read_bytes() for each in found if each.suffix != ".pyc")).hexdigest()


@cache
def tools() -> str:
    """The compiler's own sources, LLVM and the host's processor."""
    return f"{compiler()} {machine_code.host()}"


@cache
def reader() -> str:
    """The compiler's own sources, and the Python whose grammar it reads."""
    return f"{compiler()} {sys.version}"


def _digest(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()
