"""The names of what the cache keeps of a kernel.

A name is a digest of everything that the entry depends on, so a changed source, profile, bfsim, LLVM or host processor
never meets a stale one.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from bfsim import blackfin, machine_code
from bfsim.kernel import tree
from bfsim.kernel.profile import CompilerProfile, Inlines


def key(function: tree.Function, profile: CompilerProfile, variant: str) -> str:
    """Digest of all that an entry about `function` depends on; `variant` says what it is."""
    return hashlib.sha256(f"{variant}\0{_source(function, profile)}".encode()).hexdigest()


def estimate_key(function: tree.Function) -> str:
    """Digest of all that the estimate of `function` by itself depends on, in whatever profile and program."""
    parts = ("estimate", tools(), *map(_text, (function, *function.callees())))
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def program_key(functions: Iterable[tree.Function], entries: Iterable[str]) -> str:
    """Digest of all that the C of kernels depends on; `entries`: symbols of those that something else than kernels calls."""
    rows = sorted((each.file, each.first_line, each.source, each.text) for each in functions)
    parts = ("C", compiler(), repr(rows), repr(sorted(entries)))
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def object_key(image_digest: str, symbol: str, timing: str, variant: str) -> str:
    """Digest of all that an entry about the function `symbol` of object code depends on; `variant` says what it is."""
    parts = ("object code", variant, image_digest, symbol, timing, tools())
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


@cache
def _source(function: tree.Function, profile: CompilerProfile) -> str:
    """Digest of what every entry about a kernel depends on."""
    digest = hashlib.sha256()
    for part in (tools(), repr(profile), *map(_text, (function, *compiled_with(function, profile)))):
        digest.update(part.encode())
        digest.update(b"\0")
    return digest.hexdigest()


def compiled_with(function: tree.Function, profile: CompilerProfile) -> tuple[tree.Function, ...]:
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


@cache
def _text(function: tree.Function) -> str:
    return function.text


def sources() -> list[Path]:
    """Files that decide what a kernel becomes: all of this package, what instructions do, and what makes its IR machine code."""
    packages = (Path(__file__).parent, Path(blackfin.__file__).parent)
    return [*(path for each in packages for path in sorted(each.rglob("*.py"))), Path(machine_code.__file__)]


@cache
def compiler() -> str:
    """Digest of the compiler's own sources."""
    return hashlib.sha256(b"".join(each.read_bytes() for each in sources())).hexdigest()


@cache
def tools() -> str:
    """The compiler's own sources, LLVM and the host's processor."""
    return f"{compiler()} {machine_code.host()}"
