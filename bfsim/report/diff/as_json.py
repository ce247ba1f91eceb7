"""The difference of two runs as JSON."""

from __future__ import annotations

from typing import Any

from bfsim.report.diff.difference import Difference
from bfsim.report.jsonable import json_text, jsonable

SCHEMA = "bfsim.diff/2"
"""Name and version of the layout; the version rises when the meaning of a key changes or a key goes away."""


def diff_json(difference: Difference) -> str:
    """Return all of a difference as text."""
    return json_text(plain_difference(difference))


def plain_difference(difference: Difference) -> dict[str, Any]:
    """Return all of a difference as dicts and lists. Keys are the field names of `difference`, so each carries its unit."""
    return {"schema": SCHEMA, "cclk": difference.cclk, **jsonable(difference)}
