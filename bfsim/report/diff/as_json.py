"""The difference of two runs as JSON."""

from __future__ import annotations

import json

from bfsim.report.diff.difference import Difference
from bfsim.report.jsonable import jsonable

SCHEMA = "bfsim.diff/1"
"""Name and version of the layout; the version rises when a key changes its meaning or goes away."""


def diff_json(difference: Difference) -> str:
    """Return all of a difference as indented text. Keys are the field names of `difference`, so each carries its unit."""
    plain = {"schema": SCHEMA, "cclk": difference.cclk, **jsonable(difference)}
    return f"{json.dumps(plain, indent=2, ensure_ascii=False)}\n"
