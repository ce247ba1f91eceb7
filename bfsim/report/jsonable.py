"""Records as JSON. Pydantic does it, which takes 50 ms to import: a report on the screen needs none of this."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from bfsim.errors import legible
from bfsim.trace import Later


def jsonable(records: object, fallback: Callable[[Any], object] | None = None) -> Any:
    """Return records as dicts, lists, numbers and text; `fallback` converts anything else."""
    from pydantic_core import to_jsonable_python

    def plain(value: Any) -> object:
        if isinstance(value, Later):
            return list(value)
        return fallback(value) if fallback else value

    return to_jsonable_python(records, fallback=plain)


def json_text(plain: object) -> str:
    """Return what commands write as JSON: indented text that ends in a line feed."""
    return f"{indented(plain)}\n"


def indented(plain: object) -> str:
    """Return dicts, lists, numbers and text as indented JSON, in a seventh of the time of `json.dumps`."""
    from pydantic_core import PydanticSerializationError, to_json

    try:
        return to_json(plain, indent=2).decode()
    except PydanticSerializationError:  # bytes in a file's name that are not UTF-8
        return to_json(json.loads(legible(json.dumps(plain, ensure_ascii=False))), indent=2).decode()
