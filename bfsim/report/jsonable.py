"""Records as JSON has them: pydantic makes it of them, which takes 50 ms to import, and a report on the screen needs none."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def jsonable(records: object, fallback: Callable[[Any], object] | None = None) -> Any:
    """Return records as dicts, lists, numbers and text; `fallback` makes of others something of the kind."""
    from pydantic_core import to_jsonable_python

    return to_jsonable_python(records, fallback=fallback)
