"""LDFs that the cache on disk keeps once they have been read: reading one adds 40 ms to a start, imports included."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

from bfsim.files import store
from bfsim.files.content import digest_of, python_below
from bfsim.linker.expressions import Expression
from bfsim.linker.script import (
    Assignment,
    Block,
    FixedReserve,
    Input,
    InputSections,
    LinkerScript,
    Move,
    OutputSection,
    Reserve,
    Resolve,
    Segment,
)
from bfsim.linker.source import LdfLine, Source

PARTS = (
    Assignment, Block, Expression, FixedReserve, Input, InputSections, LdfLine, Move, OutputSection, Reserve, Resolve, Segment,
)  # fmt: skip
"""What a script is made of, besides tuples, sets, paths, text and numbers."""

KIND, CONTENT = "is", "of"
MAKERS: dict[str, Callable[..., Any]] = {
    **{each.__name__: each for each in PARTS},
    "set": lambda *each: frozenset(each),
    "path": cache(Path),
}


def kept_script(source: Source, made: Callable[[], LinkerScript]) -> LinkerScript:
    """Return the script of a preprocessed LDF as it is kept, or as it is `made` now. Errors are not kept."""

    def parts() -> list[Any]:
        script = made()
        return [_written(getattr(script, each.name)) for each in fields(LinkerScript)[1:]]

    return LinkerScript(source, *map(_read, store.kept(_key(source), parts)))


def _key(source: Source) -> str:
    """Return the digest of all that decides how a preprocessed LDF is read, and where its statements stand."""
    written = {
        id(each.file): (str(each.file.path), each.file.written, str(each.file.included_at))
        for each in source.pieces
    }
    numbers = {each: number for number, each in enumerate(written)}
    pieces = [
        (each.expanded_at, numbers[id(each.file)], each.written_at, each.is_copy) for each in source.pieces
    ]
    parts = repr((_sources(), str(source.path), source.expanded, pieces, list(written.values())))
    return hashlib.sha256(f"LDF\0{parts}".encode("utf-8", "surrogatepass")).hexdigest()


@cache
def _sources() -> str:
    """Return the digest of the files that read LDFs."""
    folder = Path(__file__).parent
    return digest_of([*python_below(folder), str(folder / "ldf.lark")])


def _written(value: Any) -> Any:
    """Return a part of a script for JSON."""
    if is_dataclass(value):
        return {
            KIND: type(value).__name__,
            CONTENT: [_written(getattr(value, each.name)) for each in fields(value)],
        }
    if isinstance(value, frozenset):
        return {KIND: "set", CONTENT: sorted(value)}
    if isinstance(value, Path):
        return {KIND: "path", CONTENT: [str(value)]}
    return [*map(_written, value)] if isinstance(value, tuple) else value


def _read(value: Any) -> Any:
    if isinstance(value, dict):
        return MAKERS[value[KIND]](*map(_read, value[CONTENT]))
    return tuple(map(_read, value)) if isinstance(value, list) else value
