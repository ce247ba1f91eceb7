"""Numbers of a board and macros of an LDF as people write them in TOML: tables or paths, numbers or text."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any


def leaves(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the values of nested tables, with their paths."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from ((f"{key}.{path}", each) for path, each in leaves(value))
        else:
            yield key, value


def text_of(value: object) -> str | None:
    """Return a number of the board, or a macro, as `--set` and `-D` have it; None for anything else."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return written(value) if isinstance(value, int | float | str) else None


def written(value: object) -> str:
    """Return a value in words: numbers and text as they are, everything else as JSON."""
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value) if isinstance(value, int | float | str) else json.dumps(value, default=str)
