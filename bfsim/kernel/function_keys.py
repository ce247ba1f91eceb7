"""Names of a kernel's cache entries: digests of its source, of its callees, and of the tools that make code of them."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterable
from functools import cache
from pathlib import Path, PurePath

from bfsim.kernel.keys import digest, tools
from bfsim.kernel.language.function import Function
from bfsim.kernel.profile import CompilerProfile, Inlines


def key(function: Function, profile: CompilerProfile, variant: str) -> str:
    """Return the digest of all that an entry about `function` depends on; `variant` says what the entry is."""
    return digest(variant, _source(function, profile))


def estimate_key(function: Function) -> str:
    """Return the digest of all that the estimate of `function` alone depends on, whatever the profile and program."""
    return digest("estimate", tools(), *(each.digest for each in (function, *function.callees())))


def program_key(functions: Iterable[Function], entries: Collection[str]) -> str:
    """Return the digest of all that the C of kernels depends on, wherever their files lie.

    `entries`: symbols of kernels that something else calls.
    """
    found = sorted(functions, key=lambda each: (each.file, each.first_line))
    files = {file: number for number, file in enumerate(dict.fromkeys(each.file for each in found))}
    rows = [
        (files[each.file], PurePath(each.file).name, each.symbol, each.source, each.digest) for each in found
    ]
    public = [each.symbol for each in found if each.is_static and each.symbol in entries]
    return digest("C", _writer(), repr(rows), repr(public))


def compiled_with(function: Function, profile: CompilerProfile) -> tuple[Function, ...]:
    """Return the kernels on which the code of `function` depends, callees first: its program and other callers of its parts.

    If a compiler inlines within a file, other kernels of the file may call the same helpers.
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
def _source(function: Function, profile: CompilerProfile) -> str:
    """Return the digest of what every entry about a kernel depends on."""
    program = (function, *compiled_with(function, profile))
    return digest(tools(), repr(profile), *(each.digest for each in program))


@cache
def _writer() -> str:
    """Return the digest of the sources that write C; what the reader makes of kernels is in the kernels' digests."""
    here = Path(__file__).parent
    names = ("constants.py", "function.py", "operators.py", "tree.py")
    found = [here / "types.py", *(here / "language" / each for each in names)]
    found += [each for folder in ("c", "intrinsics") for each in sorted((here / folder).rglob("*.[hp]*"))]
    return hashlib.sha256(b"".join(each.read_bytes() for each in found if each.suffix != ".pyc")).hexdigest()
