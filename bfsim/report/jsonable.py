"""Records as JSON has them, and its text. Pydantic makes it of them, which takes 50 ms to import: a report on the screen needs none."""

from __future__ import annotations

import json
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


def json_text(plain: object) -> str:
    """Return what commands write as JSON: indented text that ends in a line feed."""
    return json.dumps(plain, indent=2, ensure_ascii=False) + "\n"
