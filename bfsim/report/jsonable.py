"""Records as JSON has them: pydantic makes it of them, which takes 50 ms to import, and a report on the screen needs none."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bfsim.trace import Later


def jsonable(records: object, fallback: Callable[[Any], object] | None = None) -> Any:
    """Return records as dicts, lists, numbers and text; `fallback` makes of others something of the kind."""
    from pydantic_core import to_jsonable_python

    def plain(value: Any) -> object:
        if isinstance(value, Later):
            return list(value)
        return fallback(value) if fallback else value

    return to_jsonable_python(records, fallback=plain)
